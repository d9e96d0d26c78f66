"use strict";
// One section is shown at a time, named by the hash of the address; after a question mark follows its query.

const pages = [...document.querySelectorAll(".page")];

/** The section that the address names, or the first, and its query. */
function place() {
  const [name, query = ""] = location.hash.slice(1).split("?");
  const page = pages.find(({ id }) => id === name || encodeURI(id) === name) ?? pages[0];
  return { page, query: new URLSearchParams(query) };
}

function show() {
  const { page, query } = place();
  for (const other of pages) other.hidden = other !== page;
  const heading = page.querySelector("h2");
  document.title = `${heading.textContent} – Signorini study`;
  // The overview borrows the film of a case.
  const opening = document.querySelector("[data-film]"), name = opening.dataset.film;
  const home = page.contains(opening) ? opening : document.getElementById(`case/${name}`).querySelector(".charts");
  home.prepend(document.getElementById(`time-${name}`).closest(".film"));
  for (const link of document.querySelectorAll("nav a")) {
    const here = link.hash === `#${page.id}` || (link.hash === "#cases" && page.id.startsWith("case/"));
    if (here) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  page.dispatchEvent(new CustomEvent("shown", { detail: query }));
  return heading;
}

addEventListener("hashchange", () => {
  const target = document.getElementById(location.hash.slice(1));
  if (target && !target.matches(".page")) return; // a link within the page
  const heading = show();
  scrollTo(0, 0);
  heading.focus({ preventScroll: true });
});
addEventListener("DOMContentLoaded", show);

// On a phone a row of a table with class "cards" is a card, whose cells need their headings.
document.documentElement.classList.add("scripted");
for (const table of document.querySelectorAll("table.cards")) {
  const headings = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
  for (const row of table.querySelectorAll("tbody tr:not(.group)")) {
    [...row.cells].forEach((cell, i) => { cell.dataset.head = headings[i]; });
  }
}

// The ledger shows the rows that match every filter; the address keeps the filters.
{
  const form = document.getElementById("filters");
  const status = document.getElementById("count");
  const filters = ["text", "verdict", "statement", "case"];
  const plain = (text) => text.toLowerCase().replace(/[\^_{}]/g, "").replace(/\s+/g, " ").trim();
  const groups = [...document.querySelectorAll("#rows tbody")].map((body) => {
    const [head, ...rows] = body.rows, statement = body.dataset.statement;
    const texts = rows.map((row) => plain(`${head.textContent} ${[...row.cells].map((cell) => cell.textContent).join(" ")}`));
    return { body, rows: rows.map((row, i) => ({ row, statement, text: texts[i], case: row.dataset.case, verdict: row.dataset.verdict })) };
  });
  const total = groups.reduce((sum, group) => sum + group.rows.length, 0);

  function apply() {
    const wanted = Object.fromEntries(filters.map((name) => [name, form.elements[name].value]));
    const words = plain(wanted.text).split(" ");
    const counts = new Map();
    for (const { body, rows } of groups) {
      for (const one of rows) {
        const matches = ["verdict", "statement", "case"].every((name) => !wanted[name] || one[name] === wanted[name]) && words.every((word) => one.text.includes(word));
        one.row.hidden = !matches;
        if (matches) counts.set(one.verdict, (counts.get(one.verdict) ?? 0) + 1);
      }
      body.hidden = rows.every(({ row }) => row.hidden);
    }
    const shown = [...counts.values()].reduce((sum, count) => sum + count, 0);
    const parts = [...counts].map(([verdict, count]) => `${count} ${verdict}`).join(", ");
    status.textContent = `${shown} of ${total} ${total === 1 ? "row" : "rows"}${parts && `: ${parts}`}`;
  }

  function remember() {
    const query = new URLSearchParams(filters.map((name) => [name, form.elements[name].value]).filter(([, value]) => value));
    history.replaceState(null, "", `#ledger${query.size ? `?${query}` : ""}`);
  }

  // A choice from a list may come as a change only, typing comes as input.
  for (const kind of ["input", "change"]) form.addEventListener(kind, () => { apply(); remember(); });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(() => { apply(); remember(); }));
  document.getElementById("ledger").addEventListener("shown", ({ detail }) => {
    for (const name of filters) form.elements[name].value = detail.get(name) ?? "";
    apply();
  });
}

// A case in motion: one image for each time, and a slider that chooses the image.
for (const film of document.querySelectorAll(".film")) {
  const images = [...film.querySelectorAll("img")];
  const slider = film.querySelector("input"), output = film.querySelector("output"), button = film.querySelector("button");
  let timer = null;

  function draw() {
    images.forEach((image, i) => { image.hidden = i !== Number(slider.value); });
    output.textContent = images[slider.value].alt;
    slider.setAttribute("aria-valuetext", images[slider.value].alt);
  }

  function stop() {
    clearInterval(timer);
    timer = null;
    button.textContent = "Play";
    button.setAttribute("aria-pressed", "false");
  }

  button.addEventListener("click", () => {
    if (timer) return stop();
    if (slider.value === slider.max) slider.value = 0;
    timer = setInterval(() => {
      slider.stepUp();
      draw();
      if (slider.value === slider.max || film.closest(".page").hidden) stop();
    }, 500);
    button.textContent = "Pause";
    button.setAttribute("aria-pressed", "true");
  });
  slider.addEventListener("input", draw);
  draw();
}
