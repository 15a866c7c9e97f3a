// Everything in its place.

const parts = { accuracy: AccuracyChart, pareto: ParetoChart, cells: CellTable, confusion: ConfusionTable };
const shown = {};
for (const [name, Part] of Object.entries(parts)) {
  const host = document.getElementById(`${name}-live`);
  if (host) shown[name] = new Part(host);
}
// Charts follow the width of the window; the height of a phone's window changes at every scroll.
let width = innerWidth;
function redraw() {
  shown.accuracy?.show();
  shown.pareto?.show();
}
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth;
  redraw();
});
for (const [event, size] of [["beforeprint", 690], ["afterprint", null]]) {
  addEventListener(event, () => {
    paper = size;
    redraw();
  });
}
