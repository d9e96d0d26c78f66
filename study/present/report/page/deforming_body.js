// The deforming body on a canvas: in the plane on its foundation, in space seen through it.

/** Points, given by their coordinates, as drawn: to the right, upwards and, in space, towards the eye. */
const project = (film, x) => film.view.map((axis) => x[0].map((_, j) => axis.reduce((sum, a, i) => sum + a * x[i][j], 0)));

/** The vertices at a time, as drawn. */
function deformed(film, n) {
  const dim = film.vertices.length, count = film.vertices[0].length, factor = film.magnification * film.unit;
  return project(film, film.vertices.map((rest, i) => rest.map((x, j) => x + factor * film.displacement[(dim * n + i) * count + j])));
}

/** Room for every time and, in the plane, for arrows of full length. */
function roomOf(film) {
  const room = [[Infinity, -Infinity], [Infinity, -Infinity]];
  const widen = (points) => room.forEach((ends, i) => {
    ends[0] = Math.min(ends[0], ...points[i]);
    ends[1] = Math.max(ends[1], ...points[i]);
  });
  widen(film.rest);
  film.times.forEach((_, n) => widen(deformed(film, n)));
  for (const face of film.faces.filter(({ zone }) => zone)) {
    widen(project(film, face.x.map((values, i) => values.map((x) => x + film.arrow * film.size * face.normal[i]))));
  }
  return room.map(([low, high]) => [low - 0.02 * film.size, high + 0.02 * film.size]);
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
  const line = (...points) => { pen.beginPath(); points.forEach((p, i) => (i ? pen.lineTo(...p) : pen.moveTo(...p))); };
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
  pen.fillStyle = "#1a1a1a";
  pen.strokeStyle = "#fff";
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
  pen.strokeStyle = theme("--front");
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
