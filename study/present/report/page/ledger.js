// The rows of the ledger that match every filter; the address keeps the filters.

{
  const form = document.getElementById("filters");
  const status = document.getElementById("count");
  const filters = ["text", "verdict", "statement", "case"];
  const plain = (text) => text.toLowerCase().replace(/[\^_{}]/g, "").replace(/\s+/g, " ").trim();
  const groups = [...document.querySelectorAll("#rows tbody")].map((body) => {
    const [head, ...rows] = body.rows;
    return {
      body,
      rows: rows.map((row) => ({
        row,
        statement: body.dataset.statement,
        case: row.dataset.case,
        verdict: row.dataset.verdict,
        text: plain(`${head.textContent} ${[...row.cells].map((cell) => cell.textContent).join(" ")}`),
      })),
    };
  });
  const total = groups.reduce((sum, group) => sum + group.rows.length, 0);

  function apply() {
    const wanted = Object.fromEntries(filters.map((name) => [name, form.elements[name].value]));
    const words = plain(wanted.text).split(" ");
    const counts = new Map();
    let shown = 0;
    for (const { body, rows } of groups) {
      let some = false;
      for (const one of rows) {
        const matches =
          ["verdict", "statement", "case"].every((name) => !wanted[name] || one[name] === wanted[name]) &&
          words.every((word) => one.text.includes(word));
        one.row.hidden = !matches;
        some ||= matches;
        if (matches) counts.set(one.verdict, (counts.get(one.verdict) ?? 0) + 1);
        shown += matches;
      }
      body.hidden = !some;
    }
    const parts = [...counts].map(([verdict, count]) => `${count} ${verdict}`).join(", ");
    status.textContent = `${shown} of ${total} rows${parts && `: ${parts}`}`;
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
