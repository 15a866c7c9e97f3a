// Charts: tooltips of marks for mouse, finger and arrow keys, and legend entries that hide and show their series.

const tip = make("div", { class: "tip", hidden: "", "aria-hidden": "true" });
const spoken = make("div", { class: "unseen", "aria-live": "polite" });
document.body.append(tip, spoken);
addEventListener("scroll", () => { tip.hidden = true; }, { passive: true, capture: true });

/** Lines of a tooltip: settings and values of the mark's row in the table of the page; without that row, what the mark itself holds. */
function describe(figure, mark) {
  const table = document.querySelector(`table[data-table="${figure.dataset.table}"]`);
  const row = table?.querySelector(`tr[data-row="${mark.dataset.row}"]`);
  if (!row) {
    const { panel, x, y, interval, fill } = mark.dataset;
    const series = mark.closest("[data-series]")?.dataset.series;
    const lines = [`${figure.dataset.x} ${x}`, `${figure.dataset.y} ${y}${interval ? ` [${interval}]` : ""}`, fill];
    return { title: [panel, series].filter(Boolean).join(" · "), lines: lines.filter(Boolean) };
  }
  const heads = [...table.querySelectorAll("th")];
  const said = (name) => heads.map((head, place) => [head.dataset[name], row.cells[place]?.textContent ?? ""]).filter(([words, text]) => words !== undefined && text !== "").map((parts) => parts.join(""));
  return { title: said("setting").join(" · "), lines: said("found") };
}

function showTip({ title, lines }, { left, right, top, bottom }) {
  tip.replaceChildren(...(title ? [make("strong", {}, title)] : []), ...lines.map((line) => make("span", {}, line)));
  tip.hidden = false;
  const { width, height } = tip.getBoundingClientRect();
  tip.style.left = `${Math.max(8, Math.min((left + right) / 2 + 14, innerWidth - width - 8))}px`;
  tip.style.top = `${top - height - 8 > 8 ? top - height - 8 : bottom + 10}px`;
}

function chart(figure) {
  const svg = figure.querySelector("svg");
  const marks = [...svg.querySelectorAll("[data-row]")];
  const centres = new Map();
  const ring = svg.appendChild(document.createElementNS(svg.namespaceURI, "circle"));
  fit(ring, { r: 9, class: "ring", visibility: "hidden" }, []);
  const shown = () => marks.filter((mark) => !mark.closest("[display=none]"));
  let current = null;

  function centre(mark) {
    if (!centres.has(mark)) {
      const { x, y, width, height } = mark.getBBox();
      centres.set(mark, [x + width / 2, y + height / 2]);
    }
    return centres.get(mark);
  }

  function hide() {
    ring.setAttribute("visibility", "hidden");
    tip.hidden = true;
  }

  function ask(mark, isAloud) {
    if (!mark) return hide();
    current = mark;
    const [cx, cy] = centre(mark);
    fit(ring, { cx, cy, visibility: "visible" }, []);
    const said = describe(figure, mark);
    showTip(said, mark.getBoundingClientRect());
    if (isAloud) spoken.textContent = [said.title, ...said.lines].filter(Boolean).join(". ");
  }

  function nearest(among, [x, y], within) {
    const away = (mark) => Math.hypot(centre(mark)[0] - x, centre(mark)[1] - y);
    const best = among.reduce((a, b) => (a && away(a) <= away(b) ? a : b), null);
    return best && away(best) < within ? best : null;
  }

  function onPointer(event) {
    const own = event.target.closest?.("[data-row]");
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    ask(own ?? nearest(shown(), [place.x, place.y], event.pointerType === "mouse" ? 30 : 45));
  }

  /** The mark of another series, or of another row of tiles, that is nearest. */
  function across(step) {
    const group = (mark) => mark.parentNode === svg ? centre(mark)[1] : mark.parentNode;
    const groups = [...new Set(shown().map(group))];
    const next = groups[(groups.indexOf(group(current)) + step + groups.length) % groups.length];
    return nearest(shown().filter((mark) => group(mark) === next), centre(current), Infinity);
  }

  function onKey(event) {
    if (event.target !== svg) return;
    if (event.key === "Escape") return hide();
    const all = shown();
    const place = all.indexOf(current);
    const steps = {
      ArrowRight: () => all[Math.min(place + 1, all.length - 1)], ArrowLeft: () => all[Math.max(place - 1, 0)],
      ArrowUp: () => across(-1), ArrowDown: () => across(1), Home: () => all[0], End: () => all.at(-1),
    };
    if (!steps[event.key] || all.length === 0) return;
    event.preventDefault();
    ask(place < 0 ? all[0] : steps[event.key](), true);
  }

  for (const entry of svg.querySelectorAll("[data-toggle]")) {
    const name = entry.dataset.toggle;
    const parts = [...svg.querySelectorAll("[data-series]")].filter((part) => part.dataset.series === name);
    const press = () => {
      const isShown = entry.getAttribute("aria-pressed") !== "true";
      entry.setAttribute("aria-pressed", isShown);
      parts.forEach((part) => (isShown ? part.removeAttribute("display") : part.setAttribute("display", "none")));
      hide();
    };
    const { x, y, width, height } = entry.getBBox();
    const ground = document.createElementNS(svg.namespaceURI, "rect");
    entry.prepend(fit(ground, { x: x - 3, y: y - 3, width: width + 6, height: height + 6, fill: "transparent" }, []));
    const onEnter = (event) => { if ([" ", "Enter"].includes(event.key)) { event.preventDefault(); press(); } };
    fit(entry, { role: "button", tabindex: 0, "aria-pressed": "true", "aria-label": `Show ${name}`, click: press, keydown: onEnter }, []);
  }
  const label = `${svg.getAttribute("aria-label")}. ${marks.length} points. The arrow keys go from point to point; the tables hold the same numbers.`;
  fit(svg, { role: "group", "aria-roledescription": "chart", "aria-label": label, tabindex: 0, pointermove: onPointer, pointerdown: onPointer, pointerleave: hide, keydown: onKey, blur: hide }, []);
  figure.removeAttribute("tabindex");
}

document.querySelectorAll("figure.chart").forEach(chart);
