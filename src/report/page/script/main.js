// Everything in its place.

const explorers = [];
const waiting = new Map();
function begin(host) {
  if (!waiting.has(host)) return;
  waiting.delete(host);
  explorers.push(new Explorer(host, study.charts[Number(host.dataset.chart)]));
}
// Charts are drawn when they come near: thirty of ten thousand points at once are slow.
const near = new IntersectionObserver((entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => begin(entry.target)), { rootMargin: "800px" });
for (const host of document.querySelectorAll("[data-chart]")) {
  waiting.set(host, true);
  near.observe(host);
}
for (const host of document.querySelectorAll("[data-table]")) new TableView(host, tableOf(host.dataset.table));
for (const host of document.querySelectorAll("[data-advice]")) {
  const table = tableOf(host.dataset.advice);
  if (Adviser.canAdvise(table)) new Adviser(host, table);
  else host.closest("section").remove();
}

// Charts follow the width of the window; the height of a phone's window changes at every scroll.
let width = innerWidth;
function redraw() {
  explorers.forEach((explorer) => explorer.show());
}
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth;
  redraw();
});
for (const [event, size] of [["beforeprint", 690], ["afterprint", null]]) {
  addEventListener(event, () => {
    paper = size;
    [...waiting.keys()].forEach(begin);
    redraw();
  });
}
