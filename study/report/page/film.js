// A case over time: the deforming body on a canvas, gap, pressure and contact zone along its faces.

{
  // From dark to light like cividis, so that it reads without colours, too.
  const ramp = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];
  const colours = Array.from({ length: 256 }, (_, shade) => {
    const at = (shade / 255) * (ramp.length - 1);
    const i = Math.min(Math.floor(at), ramp.length - 2);
    return `rgb(${ramp[i].map((c, k) => Math.round(c + (at - i) * (ramp[i + 1][k] - c))).join(" ")})`;
  });
  document.documentElement.style.setProperty("--ramp", ramp.map((c) => `rgb(${c.join(" ")})`).join(","));
  const ARROW = 0.2; // length of the largest pressure, and
  const BAND = 0.05; // thickness of the foundation, in sizes of the body
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const digits = (value) => String(Number(value.toPrecision(3)));
  const theme = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);

  /** What the page says in base64, as numbers; the outline of the mesh. */
  function read(section) {
    const film = JSON.parse(section.querySelector("script").textContent);
    film.displacement = new Int16Array(bytes(film.displacement).buffer);
    film.shades = bytes(film.shades);
    const edges = new Map();
    for (let c = 0; c < film.cells.length; c += 3) {
      for (const [a, b] of [[0, 1], [1, 2], [2, 0]]) {
        const ends = [film.cells[c + a], film.cells[c + b]].sort((p, q) => p - q);
        edges.set(ends.join(), edges.has(ends.join()) ? null : ends);
      }
    }
    film.outline = [...edges.values()].filter(Boolean);
    for (const face of film.faces) {
      // Vertices on the clamped part are no contact vertices: the zone may reach farther than they do.
      const ends = face.zone.intervals.flat(2).concat(face.s);
      face.range = [Math.min(...ends), Math.max(...ends)];
    }
    film.highest = Math.max(...film.faces.flatMap((face) => face.pressure.flat()), 0);
    return film;
  }

  /** The vertices at a time, as drawn: [x, y]. */
  function deformed(film, n) {
    const count = film.vertices[0].length;
    const factor = film.magnification * film.unit;
    return film.vertices.map((rest, i) => rest.map((x, j) => x + factor * film.displacement[(2 * n + i) * count + j]));
  }

  /** Room for every time and for arrows of full length. */
  function frame(film) {
    const rest = film.vertices.map((values) => [Math.min(...values), Math.max(...values)]);
    film.size = Math.max(...rest.map(([low, high]) => high - low));
    const room = rest.map((ends) => [...ends]);
    const widen = (i, values) => { room[i] = [Math.min(room[i][0], ...values), Math.max(room[i][1], ...values)]; };
    film.times.forEach((_, n) => deformed(film, n).forEach((values, i) => widen(i, values)));
    for (const face of film.faces) face.x.forEach((values, i) => widen(i, values.map((x) => x + ARROW * film.size * face.normal[i])));
    return room.map(([low, high]) => [low - 0.02 * film.size, high + 0.02 * film.size]);
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
    const [xs, ys] = deformed(film, n);
    const [rx, ry] = film.vertices;

    for (const face of film.faces) {
      const ends = face.range.map((s) => on(face, s));
      const deep = ends.map(([x, y]) => at(x + BAND * film.size * face.normal[0], y + BAND * film.size * face.normal[1]));
      line(at(...ends[0]), at(...ends[1]), deep[1], deep[0]);
      pen.fillStyle = theme("--ground");
      pen.fill();
    }
    for (let c = 0, cells = film.cells.length / 3; c < cells; c++) {
      line(...[0, 1, 2].map((i) => film.cells[3 * c + i]).map((v) => at(xs[v], ys[v])));
      pen.closePath();
      pen.fillStyle = pen.strokeStyle = colours[film.shades[n * cells + c]];
      pen.lineWidth = 0.6;
      pen.fill();
      pen.stroke();
    }
    pen.strokeStyle = theme("--soft");
    pen.lineWidth = 0.8;
    for (const [a, b] of film.outline) { line(at(rx[a], ry[a]), at(rx[b], ry[b])); pen.stroke(); }
    for (const face of film.faces) {
      drawZone(pen, face, at, line, film, n);
      drawArrows(pen, face, at, line, film, n);
    }
    canvas.setAttribute("aria-label", `the deformed body at t = ${film.times[n]}, displacement times ${film.magnification}`);
  }

  /** The point of a face at a position. */
  function on(face, s) {
    const last = face.s.length - 1, share = (s - face.s[0]) / (face.s[last] - face.s[0]);
    return face.x.map((values) => values[0] + share * (values[last] - values[0]));
  }

  /** The exact zone under the foundation's surface. */
  function drawZone(pen, face, at, line, film, n) {
    const under = (s) => on(face, s).map((x, i) => x + 0.7 * BAND * film.size * face.normal[i]);
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
  function drawArrows(pen, face, at, line, film, n) {
    pen.strokeStyle = pen.fillStyle = theme("--vermillion");
    pen.lineWidth = 1.5;
    face.pressure[n].forEach((pressure, i) => {
      if (pressure <= face.touches) return;
      const tip = [face.x[0][i], face.x[1][i]];
      const length = (ARROW * film.size * pressure) / film.highest;
      const [tx, ty] = at(...tip);
      const [fx, fy] = at(...tip.map((x, k) => x + length * face.normal[k]));
      line([fx, fy], [tx, ty]);
      pen.stroke();
      const head = Math.min(6, Math.hypot(tx - fx, ty - fy)), angle = Math.atan2(ty - fy, tx - fx);
      line([tx, ty], ...[2.7, -2.7].map((turn) => [tx + head * Math.cos(angle + turn), ty + head * Math.sin(angle + turn)]));
      pen.fill();
    });
  }

  function element(svg, tag, attributes, text = "") {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.textContent = text;
    svg.append(made);
    return made;
  }

  /** Axes of a plot; (x, y) ↦ its coordinates. */
  function axes(svg, [x0, x1], [y0, y1], xLabel, yLabel) {
    const X = (x) => 58 + (278 * (x - x0)) / (x1 - x0 || 1), Y = (y) => 150 - (140 * (y - y0)) / (y1 - y0 || 1);
    const middle = { "text-anchor": "middle" };
    for (const share of [0, 0.5, 1]) {
      const x = x0 + share * (x1 - x0), y = y0 + share * (y1 - y0);
      element(svg, "path", { class: "grid", d: `M58,${Y(y)}H336M${X(x)},10V150` });
      element(svg, "text", { x: X(x), y: 166, ...middle }, digits(x));
      element(svg, "text", { x: 53, y: Y(y) + 4, "text-anchor": "end" }, digits(y));
    }
    element(svg, "path", { class: "axis", d: "M58,10V150H336" });
    element(svg, "text", { x: 197, y: 184, ...middle }, xLabel);
    element(svg, "text", { transform: "translate(10 80) rotate(-90)", ...middle }, yLabel);
    return (x, y) => [X(x).toFixed(2), Y(y).toFixed(2)];
  }

  const path = (points) => `M${points.map((p) => p.join()).join("L")}`;

  /** Gap or pressure along a face: exact line, computed dots. */
  function drawAlong(svg, face, kind, n) {
    const exact = face[`${kind}_exact`], high = Math.max(...exact.flat(), ...face[kind].flat()) || 1;
    const at = axes(svg, face.range, [0, high], "s", kind);
    element(svg, "path", { class: "exact-line", d: path(face.s.map((s, i) => at(s, exact[n][i]))) });
    face.s.forEach((s, i) => {
      const [cx, cy] = at(s, face[kind][n][i]);
      element(svg, "circle", { class: "computed", r: 2.8, cx, cy });
    });
  }

  /** The contact zone in space and time: exact as a surface, computed vertices as dots, now as a line. */
  function drawHistory(svg, face, film, n) {
    const end = film.times.at(-1);
    const at = axes(svg, face.range, [0, end], "s", "t");
    const d = face.zone.times.flatMap((t, j) => face.zone.intervals[j].map(([a, b]) => path([at(a, t), at(b, t)]))).join("");
    if (d) element(svg, "path", { class: "exact-zone", d, "stroke-width": (145 / (face.zone.times.length - 1)).toFixed(2) });
    film.times.forEach((t, j) => face.pressure[j].forEach((pressure, i) => {
      if (pressure <= face.touches) return;
      const [cx, cy] = at(face.s[i], t);
      element(svg, "circle", { class: "computed", r: 1.8, cx, cy });
    }));
    element(svg, "path", { class: "now", d: path(face.range.map((s) => at(s, film.times[n]))) });
  }

  function start(section) {
    const film = read(section);
    const slider = section.querySelector("input"), output = section.querySelector("output");
    const button = section.querySelector("button"), canvas = section.querySelector("canvas");
    film.room = frame(film);
    let timer = null;

    function draw() {
      const n = Number(slider.value);
      drawBody(canvas, film, n);
      for (const svg of section.querySelectorAll("[data-plot]")) {
        const face = film.faces[svg.dataset.face];
        svg.replaceChildren();
        if (svg.dataset.plot === "zone") drawHistory(svg, face, film, n);
        else drawAlong(svg, face, svg.dataset.plot, n);
      }
      const touching = film.faces.reduce((sum, face) => sum + face.pressure[n].filter((p) => p > face.touches).length, 0);
      output.textContent = `t = ${film.times[n]}`;
      slider.setAttribute("aria-valuetext", `t = ${film.times[n]}, ${touching} vertices in contact`);
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
    // Read only when it is first looked at: there are many.
    section.closest(".page").addEventListener("shown", () => start(section), { once: true });
  }
}
