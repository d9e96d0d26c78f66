// The colours of quantities, from study/present/charts/palette.py.

const channels = (colour) => [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
/** 256 colours between some, which are #rrggbb. */
const ramp = (stops) => Array.from({ length: 256 }, (_, shade) => {
  const at = (shade / 255) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  const [from, to] = [stops[i], stops[i + 1]].map(channels);
  return `rgb(${from.map((c, k) => Math.round(c + (at - i) * (to[k] - c))).join(" ")})`;
});
const colours = Object.fromEntries(Object.entries({{ palette.RAMPS|tojson }}).map(([name, stops]) => [name, ramp(stops)]));
for (const [name, shades] of Object.entries(colours)) {
  document.documentElement.style.setProperty(`--${name}`, shades.filter((_, i) => i % 51 === 0).join(","));
}
/** The colour of a value between 0 and the largest one. */
const colourOf = (name, value, largest) => colours[name][Math.round(255 * Math.min(Math.max(value / (largest || 1), 0), 1))];
const theme = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
