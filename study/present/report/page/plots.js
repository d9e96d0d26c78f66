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
