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
