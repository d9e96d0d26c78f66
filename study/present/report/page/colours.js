// Colours that grow lighter or darker throughout, so that they read without colours, too.

/** 256 colours between some. */
const ramp = (...stops) => Array.from({ length: 256 }, (_, shade) => {
  const at = (shade / 255) * (stops.length - 1);
  const i = Math.min(Math.floor(at), stops.length - 2);
  return `rgb(${stops[i].map((c, k) => Math.round(c + (at - i) * (stops[i + 1][k] - c))).join(" ")})`;
});
const colours = {
  stress: ramp([0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]), // cividis
  pressure: ramp([255, 247, 236], [253, 212, 158], [252, 141, 89], [215, 48, 31], [127, 0, 0]),
  gap: ramp([250, 248, 253], [208, 209, 230], [116, 169, 207], [5, 112, 176], [2, 56, 88]),
};
for (const [name, shades] of Object.entries(colours)) {
  document.documentElement.style.setProperty(`--${name}`, shades.filter((_, i) => i % 51 === 0).join(","));
}
/** The colour of a value between 0 and the largest one. */
const colourOf = (name, value, largest) => colours[name][Math.round(255 * Math.min(Math.max(value / (largest || 1), 0), 1))];
const theme = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
