// Shows the cards of the gallery that have all chosen properties; each property is a class name such as dim-2.
document.addEventListener("DOMContentLoaded", () => {
  const filter = document.querySelector(".filter");
  if (!filter) return;
  const selects = [...filter.querySelectorAll("select")];
  const cards = [...document.querySelectorAll(".cases .case")];
  const update = () => {
    const wanted = selects.filter((one) => one.value).map((one) => `${one.dataset.key}-${one.value}`);
    const shown = cards.filter((card) => {
      const fits = wanted.every((name) => card.classList.contains(name));
      card.classList.toggle("hidden", !fits);
      return fits;
    });
    filter.querySelector("output").textContent = `${shown.length} of ${cards.length} cases`;
  };
  filter.addEventListener("change", update);
  update();
});
