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

// Colours of quantities, from study/present/palette.py.

const channels = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
/** 256 colours between some, which are #rrggbb. */
const ramp = (stops) => Array.from({ length: 256 }, (_, shade) => {
  const at = (shade / 255) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  const [from, to] = [stops[i], stops[i + 1]].map(channels);
  return `rgb(${from.map((c, k) => Math.round(c + (at - i) * (to[k] - c))).join(" ")})`;
});
const colours = Object.fromEntries(Object.entries({{ ramps|tojson }}).map(([name, stops]) => [name, ramp(stops)]));
for (const [name, shades] of Object.entries(colours)) {
  document.documentElement.style.setProperty(`--${name}`, shades.filter((_, i) => i % 51 === 0).join(","));
}
/** The colour of a value between 0 and the largest one. */
const colourOf = (name, value, largest) => colours[name][Math.round(255 * Math.min(Math.max(value / (largest || 1), 0), 1))];
const theme = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
// The deforming body on a canvas: in the plane on its foundation, in space seen through it.

/** Points, given by their coordinates, as drawn: to the right, upwards and, in space, towards the eye. */
const project = (film, x) => film.view.map((axis) => x[0].map((_, j) => axis.reduce((sum, a, i) => sum + a * x[i][j], 0)));

/** The vertices at a time, as drawn. */
function deformed(film, n) {
  const dim = film.vertices.length, count = film.vertices[0].length, factor = film.magnification * film.unit;
  return project(film, film.vertices.map((rest, i) => rest.map((x, j) => x + factor * film.displacement[(dim * n + i) * count + j])));
}

/** Edges of one triangle only, and those at which a surface bends: the two ends and the triangles of each. */
function outlineOf(film) {
  const edges = new Map(), corners = (c) => film.cells.slice(3 * c, 3 * c + 3);
  for (let c = 0; c < film.cells.length / 3; c++) {
    const [a, b, d] = corners(c);
    for (const pair of [[a, b], [b, d], [d, a]]) {
      const ends = pair.sort((p, q) => p - q), edge = edges.get(ends.join()) ?? { ends, cells: [] };
      edge.cells.push(c);
      edges.set(ends.join(), edge);
    }
  }
  const flat = ([c, d]) => Math.abs(normal(film.vertices, corners(c)).reduce((sum, x, i) => sum + x * normal(film.vertices, corners(d))[i], 0)) > 0.99;
  return [...edges.values()].filter(({ cells }) => cells.length === 1 || (film.vertices.length === 3 && !flat(cells)));
}

/** The unit normal of a triangle in space. */
function normal(x, [a, b, c]) {
  const [p, q] = [b, c].map((end) => x.map((values) => values[end] - values[a]));
  const product = [0, 1, 2].map((i) => p[(i + 1) % 3] * q[(i + 2) % 3] - p[(i + 2) % 3] * q[(i + 1) % 3]);
  return product.map((value) => value / Math.hypot(...product));
}

function drawBody(canvas, film, n) {
  const [[x0, x1], [y0, y1]] = film.room;
  const width = canvas.clientWidth, scale = width / (x1 - x0), height = scale * (y1 - y0), fine = devicePixelRatio;
  canvas.width = Math.round(width * fine);
  canvas.height = Math.round(height * fine);
  const pen = canvas.getContext("2d");
  pen.scale(fine, fine);
  const at = (x, y) => [scale * (x - x0), scale * (y1 - y)];
  const line = (...points) => { pen.beginPath(); points.forEach((p) => pen.lineTo(...p)); };
  const points = (x) => x[0].map((_, v) => at(x[0][v], x[1][v]));
  const moved = deformed(film, n);
  const brush = { pen, at, line, rest: points(film.rest), now: points(moved), height: moved[2] };
  (brush.height ? drawSolid : drawPlane)(brush, film, n);
  canvas.setAttribute("aria-label", `the deformed body at t = ${film.times[n]}, displacement times ${film.magnification}`);
}

/** A triangle, with a thin edge of its own colour against gaps between neighbours. */
function drawCell({ pen, line, now }, film, c, colour) {
  line(...film.cells.slice(3 * c, 3 * c + 3).map((v) => now[v]));
  pen.closePath();
  pen.fillStyle = pen.strokeStyle = colour;
  pen.lineWidth = 0.6;
  pen.fill();
  pen.stroke();
}

function drawEdges({ pen, line }, points, edges, colour) {
  pen.strokeStyle = theme(colour);
  pen.lineWidth = 0.8;
  for (const { ends: [a, b] } of edges) { line(points[a], points[b]); pen.stroke(); }
}

function drawPlane(brush, film, n) {
  for (const face of film.faces) {
    drawGround(brush, face, film);
    drawGap(brush, face, film, n);
  }
  for (let c = 0, cells = film.cells.length / 3; c < cells; c++) drawCell(brush, film, c, colours.stress[film.shades[n * cells + c]]);
  drawEdges(brush, brush.rest, film.outline, "--soft");
  for (const face of film.faces) {
    drawZone(brush, face, film, n);
    drawArrows(brush, face, film, n);
  }
}

/** The point of a face in the plane at a position. */
function on(face, s) {
  const last = face.s.length - 1, share = (s - face.s[0]) / (face.s[last] - face.s[0]);
  return face.x.map((values) => values[0] + share * (values[last] - values[0]));
}

function drawGround({ pen, at, line }, face, film) {
  const ends = face.range.map((s) => on(face, s));
  const deep = ends.map((end) => at(...end.map((x, i) => x + film.foundation * film.size * face.normal[i])));
  line(at(...ends[0]), at(...ends[1]), deep[1], deep[0]);
  pen.fillStyle = theme("--ground");
  pen.fill();
}

/** The computed gap, hanging below the foundation's surface to a scale of its own: the largest is as long as an arrow. */
function drawGap({ pen, at, line }, face, film, n) {
  if (film.widest < 1e-9) return;
  const below = (depth) => face.s.map((_, i) => at(...face.x.map((x, k) => x[i] + depth(i) * face.normal[k])));
  line(...below(() => 0), ...below((i) => (film.arrow * film.size * Math.max(face.gap[n][i], 0)) / film.widest).reverse());
  pen.closePath();
  pen.fillStyle = pen.strokeStyle = theme("--blue");
  pen.lineWidth = 0.8;
  pen.stroke();
  pen.globalAlpha = 0.3;
  pen.fill();
  pen.globalAlpha = 1;
}

/** The exact zone under the foundation's surface. */
function drawZone({ pen, at, line }, face, film, n) {
  const under = (s) => on(face, s).map((x, i) => x + 0.7 * film.foundation * film.size * face.normal[i]);
  pen.strokeStyle = theme("--blue");
  pen.lineWidth = 4;
  for (const [a, b] of zoneAt(face, film.times[n])) { line(at(...under(a)), at(...under(b))); pen.stroke(); }
}

/** The exact zone at the instant nearest to a time. */
function zoneAt(face, time) {
  const nearest = face.zone.times.reduce((best, t, i, all) => (Math.abs(t - time) < Math.abs(all[best] - time) ? i : best), 0);
  return face.zone.intervals[nearest];
}

/** Arrows that end on the foundation where it presses, from outside the body. */
function drawArrows({ pen, at, line }, face, film, n) {
  pen.strokeStyle = pen.fillStyle = theme("--vermillion");
  pen.lineWidth = 1.5;
  face.pressure[n].forEach((pressure, i) => {
    if (pressure <= face.touches) return;
    const tip = [face.x[0][i], face.x[1][i]];
    const length = (film.arrow * film.size * pressure) / film.highest;
    const [tx, ty] = at(...tip);
    const [fx, fy] = at(...tip.map((x, k) => x + length * face.normal[k]));
    line([fx, fy], [tx, ty]);
    pen.stroke();
    const head = Math.min(6, Math.hypot(tx - fx, ty - fy)), angle = Math.atan2(ty - fy, tx - fx);
    line([tx, ty], ...[2.7, -2.7].map((turn) => [tx + head * Math.cos(angle + turn), ty + head * Math.sin(angle + turn)]));
    pen.fill();
  });
}

/** The surface from far to near, the contact faces in the colours of the pressure, with their exact fronts. */
function drawSolid(brush, film, n) {
  const cells = film.cells.length / 3, corners = (c) => film.cells.slice(3 * c, 3 * c + 3);
  const shown = new Set(Array.from({ length: cells }, (_, c) => c).filter((c) => faces(brush.now, corners(c))));
  const depth = (c) => corners(c).reduce((sum, v) => sum + brush.height[v], 0);
  const pressed = new Map(film.faces.flatMap((face) => face.cells.map((c, k) => [c, mean(face.pressure[n], face.facets, k)])));
  drawEdges(brush, brush.rest, film.outline, "--soft");
  for (const c of [...shown].sort((c, d) => depth(c) - depth(d))) {
    drawCell(brush, film, c, pressed.has(c) ? colourOf("pressure", pressed.get(c), film.highest) : colours.stress[film.shades[n * cells + c]]);
  }
  drawEdges(brush, brush.now, film.outline.filter((edge) => edge.cells.some((c) => shown.has(c))), "--ink");
  for (const face of film.faces) drawFront(brush, face, n, shown);
  if (film.faces.length > 1) for (const face of film.faces) drawName(brush, face, shown);
}

/** Which face it is, in the middle of it. */
function drawName({ pen, now }, face, shown) {
  if (!face.cells.some((c) => shown.has(c))) return;
  const middle = [0, 1].map((i) => face.nodes.reduce((sum, v) => sum + now[v][i], 0) / face.nodes.length);
  pen.font = `0.9rem ${getComputedStyle(document.body).fontFamily}`;
  pen.textAlign = "center";
  pen.fillStyle = theme("--text");
  pen.strokeStyle = theme("--halo");
  pen.lineWidth = 3;
  pen.strokeText(`Γ3,${face.face}`, ...middle);
  pen.fillText(`Γ3,${face.face}`, ...middle);
}

/** Whether a triangle, counter-clockwise from outside, shows its outer side; on the canvas y points down. */
const faces = (points, [a, b, c]) => (points[b][0] - points[a][0]) * (points[c][1] - points[a][1]) < (points[b][1] - points[a][1]) * (points[c][0] - points[a][0]);

/** The mean of the values at the corners of a facet. */
const mean = (values, facets, k) => (values[facets[3 * k]] + values[facets[3 * k + 1]] + values[facets[3 * k + 2]]) / 3;

/** Where ψ vanishes on the facets of a face that are seen; its quarters come in four parts of equal length. */
function drawFront({ pen, line, now }, face, n, shown) {
  const points = refined(face, (node) => now[face.nodes[node]]), count = face.cells.length;
  pen.strokeStyle = theme("--blue");
  pen.lineWidth = 2.5;
  pen.lineCap = "round";
  for (const { quarter, ends } of frontOf(face, n, points)) {
    if (shown.has(face.cells[quarter % count])) { line(...ends); pen.stroke(); }
  }
}

/** The points at which ψ is known: nodes, then midpoints of edges. */
function refined(face, at) {
  const found = face.s[0].map((_, node) => at(node));
  for (let e = 0; e < face.edges.length; e += 2) {
    const [a, b] = [found[face.edges[e]], found[face.edges[e + 1]]];
    found.push(a.map((x, i) => (x + b[i]) / 2));
  }
  return found;
}

/** The pieces of {ψ = 0} between points on the edges of quarters. */
function frontOf(face, n, points) {
  const level = face.level[n], found = [];
  for (let quarter = 0; quarter < face.quarters.length / 3; quarter++) {
    const [a, b, c] = face.quarters.slice(3 * quarter, 3 * quarter + 3);
    const ends = [[a, b], [b, c], [c, a]].filter(([p, q]) => (level[p] < 0) !== (level[q] < 0)).map(([p, q]) => {
      const share = level[p] / (level[p] - level[q]);
      return points[p].map((x, i) => x + share * (points[q][i] - x));
    });
    if (ends.length) found.push({ quarter, ends });
  }
  return found;
}
// Gap, pressure and contact zone on a face: along it in the plane, as maps in space.

const digits = (value) => String(Number(value.toPrecision(3)));
const path = (points) => `M${points.map((p) => p.join()).join("L")}`;

function element(svg, tag, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  svg.append(made);
  return made;
}

/** Axes of a plot, 140 high and 278 wide unless said; (x, y) ↦ its coordinates. */
function axes(svg, [x0, x1], [y0, y1], xLabel, yLabel, wide = 278, high = 140) {
  const X = (x) => 58 + (wide * (x - x0)) / (x1 - x0 || 1), Y = (y) => 10 + high - (high * (y - y0)) / (y1 - y0 || 1);
  const middle = { "text-anchor": "middle" };
  for (const share of [0, 0.5, 1]) {
    const x = x0 + share * (x1 - x0), y = y0 + share * (y1 - y0);
    element(svg, "path", { class: "grid", d: `M58,${Y(y)}H${58 + wide}M${X(x)},10V${10 + high}` });
    element(svg, "text", { x: X(x), y: high + 26, ...middle }, digits(x));
    element(svg, "text", { x: 53, y: Y(y) + 4, "text-anchor": "end" }, digits(y));
  }
  element(svg, "path", { class: "axis", d: `M58,10V${10 + high}H${58 + wide}` });
  element(svg, "text", { x: 58 + wide / 2, y: high + 44, ...middle }, xLabel);
  element(svg, "text", { transform: `translate(10 ${10 + high / 2}) rotate(-90)`, ...middle }, yLabel);
  return (x, y) => [X(x).toFixed(2), Y(y).toFixed(2)];
}

const largest = (...series) => Math.max(0, ...series.flat(2));

/** Gap or pressure along a face in the plane: exact line, computed dots. */
function drawAlong(svg, face, kind, n) {
  const { s: points, [kind]: exact } = face.line;
  // What is smaller is round-off around zero.
  const top = largest(exact, face[kind]);
  const at = axes(svg, face.range, [0, top > 1e-9 ? top : 1], "s", kind);
  element(svg, "path", { class: "exact-line", d: path(points.map((s, i) => at(s, exact[n][i]))) });
  face.s.forEach((s, i) => {
    const [cx, cy] = at(s, face[kind][n][i]);
    element(svg, "circle", { class: "computed", r: 2.8, cx, cy });
  });
}

/** The contact zone in space and time: exact as a surface, computed vertices as dots, now as a line. */
function drawHistory(svg, face, film, n) {
  const end = film.times.at(-1), { times, intervals } = face.zone;
  const at = axes(svg, face.range, [0, end], "s", "t");
  const d = times.flatMap((t, j) => intervals[j].map(([a, b]) => path([at(a, t), at(b, t)]))).join("");
  const widest = Math.max(...times.slice(1).map((t, j) => t - times[j]));
  if (d) element(svg, "path", { class: "exact-zone", d, "stroke-width": ((145 * widest) / end).toFixed(2) });
  film.times.forEach((t, j) => face.pressure[j].forEach((pressure, i) => {
    if (pressure <= face.touches) return;
    const [cx, cy] = at(face.s[i], t);
    element(svg, "circle", { class: "computed", r: 1.8, cx, cy });
  }));
  element(svg, "path", { class: "now", d: path(face.range.map((s) => at(s, film.times[n]))) });
}

/** Gap or pressure on a face in space: exact around the nodes, computed as dots in the same colours, the exact front. */
function drawMap(svg, face, kind, film, n) {
  const exact = face[`${kind}_exact`][n], computed = face[kind][n], top = largest(face[`${kind}_exact`], face[kind]);
  const ranges = face.s.map((values) => [Math.min(...values), Math.max(...values)]);
  const sizes = ranges.map(([low, high]) => high - low), scale = Math.min(210 / sizes[0], 300 / sizes[1]);
  const [wide, high] = sizes.map((size) => scale * size);
  svg.setAttribute("viewBox", `0 0 360 ${(high + 50).toFixed(0)}`);
  const at = axes(svg, ...ranges, "s₁", "s₂", wide, high), point = (i) => at(face.s[0][i], face.s[1][i]).map(Number);
  tiles(face, point).forEach((d, i) => {
    if (d) element(svg, "path", { class: "tile", d, ...painted(kind, exact[i], top) });
  });
  const front = frontOf(face, n, refined(face, point)).map(({ ends }) => path(ends)).join("");
  if (front) element(svg, "path", { class: "front", d: front });
  const r = Math.min(6, 0.2 * Math.sqrt((wide * high) / exact.length)).toFixed(2);
  computed.forEach((value, i) => {
    const [cx, cy] = point(i), dot = element(svg, "circle", { class: "node", r, cx, cy, fill: colourOf(kind, value, top) });
    element(dot, "title", {}, `computed ${digits(value)}, exact ${digits(exact[i])}`);
  });
  drawBar(svg, kind, top, 58 + wide + 24, high);
  const said = `At t = ${film.times[n]} it is at most ${digits(Math.max(...computed))} computed, ${digits(Math.max(...exact))} exact.`;
  svg.parentElement.querySelector("output").textContent = said;
}

/** A surface of the colour of a value, up to its edges. */
function painted(kind, value, top) {
  const colour = colourOf(kind, value, top);
  return { fill: colour, stroke: colour };
}

/** For each node the part of the face that is nearer to it than to other nodes of its facets, as paths. */
function tiles(face, point) {
  const found = face.s[0].map(() => "");
  const between = (...nodes) => [0, 1].map((i) => (nodes.reduce((sum, node) => sum + point(node)[i], 0) / nodes.length).toFixed(2));
  for (let k = 0; k < face.facets.length; k += 3) {
    const [a, b, c] = face.facets.slice(k, k + 3);
    for (const [p, q, r] of [[a, b, c], [b, c, a], [c, a, b]]) found[p] += `${path([point(p), between(p, q), between(p, q, r), between(p, r)])}Z`;
  }
  return found;
}

/** The colours of a map, from 0 at the bottom. */
function drawBar(svg, kind, top, x, high) {
  const count = 24, step = high / count;
  for (let i = 0; i < count; i++) {
    const y = 10 + high - (i + 1) * step;
    element(svg, "rect", { class: "tile", x, y, width: 12, height: step, ...painted(kind, i, count - 1) });
  }
  for (const share of [0, 0.5, 1]) element(svg, "text", { x: x + 17, y: 14 + high * (1 - share) }, digits(share * top));
}

/** How many nodes of a face in space are in the exact zone (line) and in computed contact (dots); now as a line. */
function drawCounts(svg, face, film, n) {
  const end = film.times.at(-1), nodes = face.s[0].length;
  const at = axes(svg, [0, end], [0, nodes], "t", "nodes");
  const exact = face.level.map((level) => level.slice(0, nodes).filter((psi) => psi >= 0).length);
  element(svg, "path", { class: "exact-line", d: path(film.times.map((t, j) => at(t, exact[j]))) });
  film.times.forEach((t, j) => {
    if (j === 0) return; // nothing has been solved there
    const [cx, cy] = at(t, touching(face, j));
    element(svg, "circle", { class: "computed", r: 2.8, cx, cy });
  });
  element(svg, "path", { class: "now", d: path([0, nodes].map((y) => at(film.times[n], y))) });
}

/** How many nodes of a face are in contact. */
const touching = (face, n) => face.pressure[n].filter((pressure) => pressure > face.touches).length;
// A case in motion: its data, and the slider that chooses the time.

const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** The data of a case, with the outline of the mesh, which is drawn at every time. */
function read(section) {
  // The overview shows a case whose data stand in its own section.
  const held = section.dataset.from ? document.querySelector(`.film[data-case="${CSS.escape(section.dataset.from)}"]`) : section;
  const film = JSON.parse(held.querySelector("script").textContent);
  film.displacement = new Int8Array(bytes(film.displacement).buffer);
  film.shades = bytes(film.shades);
  film.rest = project(film, film.vertices);
  film.outline = outlineOf(film);
  for (const face of film.faces.filter(({ zone }) => zone)) {
    // Vertices on the clamped part are no contact vertices: the zone may reach farther than they do.
    const ends = face.zone.intervals.flat(2).concat(face.s);
    face.range = [Math.min(...ends), Math.max(...ends)];
  }
  return film;
}

function drawPlot(svg, film, n) {
  const face = film.faces[svg.dataset.face], kind = svg.dataset.plot;
  svg.replaceChildren();
  if (kind === "zone") (face.zone ? drawHistory : drawCounts)(svg, face, film, n);
  else if (face.zone) drawAlong(svg, face, kind, n);
  else drawMap(svg, face, kind, film, n);
}

function start(section) {
  const film = read(section);
  const slider = section.querySelector("input"), output = section.querySelector("output");
  const button = section.querySelector("button"), canvas = section.querySelector("canvas");
  let timer = null;

  function draw() {
    const n = Number(slider.value);
    drawBody(canvas, film, n);
    for (const svg of section.querySelectorAll("[data-plot]")) drawPlot(svg, film, n);
    const vertices = film.faces.reduce((sum, face) => sum + touching(face, n), 0);
    output.textContent = `t = ${film.times[n]}`;
    slider.setAttribute("aria-valuetext", `t = ${film.times[n]}, ${vertices} vertices in contact`);
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
      if (slider.value === slider.max || section.closest(".page").hidden) stop();
    }, 250);
    button.textContent = "Pause";
    button.setAttribute("aria-pressed", "true");
  });
  slider.addEventListener("input", draw);
  new ResizeObserver(draw).observe(canvas.parentElement);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
}

for (const section of document.querySelectorAll(".film")) {
  // Read when the case is first shown: there are many.
  section.closest(".page").addEventListener("shown", () => start(section), { once: true });
}
