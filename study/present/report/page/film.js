// A case in motion: its data, and the slider that chooses the time.

const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** The data of a case, with what is drawn at every time: the outline of the mesh, the room that is needed. */
function read(section) {
  // The overview shows a case whose data stand in its own section.
  const held = section.dataset.from ? document.querySelector(`.film[data-case="${CSS.escape(section.dataset.from)}"]`) : section;
  const film = JSON.parse(held.querySelector("script").textContent);
  film.displacement = new Int16Array(bytes(film.displacement).buffer);
  film.shades = bytes(film.shades);
  film.size = Math.max(...film.vertices.map((values) => Math.max(...values) - Math.min(...values)));
  film.rest = project(film, film.vertices);
  film.outline = outlineOf(film);
  film.room = roomOf(film);
  film.highest = largest(...film.faces.map((face) => face.pressure));
  film.widest = largest(...film.faces.map((face) => face.gap));
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
