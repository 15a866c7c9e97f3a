// Pictures whose points can be asked: what each says lies beside it.

function describe(point) {
  return point;
}

for (const data of document.querySelectorAll("script.asked")) {
  const figure = data.closest("figure");
  const svg = figure.querySelector("svg");
  const points = JSON.parse(data.textContent).map((point) => ({ ...point, cell: point }));
  points.sort((a, b) => a.line - b.line || a.x - b.x);
  figure.removeAttribute("tabindex");
  fit(svg, { tabindex: 0, role: "application" }, []);
  letAsk(svg, points);
}
