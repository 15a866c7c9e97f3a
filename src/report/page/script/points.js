// Points of a chart that can be asked: with the pointer, a finger, or the arrow keys.

const tip = make("div", { class: "tip", hidden: "", "aria-hidden": "true" });
const spoken = make("div", { class: "unseen", "aria-live": "polite" });
document.body.append(tip, spoken);

function hideTip() {
  tip.hidden = true;
}
addEventListener("scroll", hideTip, { passive: true, capture: true });

/** Shows what is known of something beside a place in the window. */
function showTip({ title, lines }, x, y) {
  tip.replaceChildren(make("strong", {}, title), ...lines.map((line) => make("span", {}, line)));
  tip.hidden = false;
  const { width, height } = tip.getBoundingClientRect();
  const left = Math.min(Math.max(8, x + 14), innerWidth - width - 8);
  const above = y - height - 14;
  tip.style.left = `${Math.max(8, left)}px`;
  tip.style.top = `${above > 8 ? above : y + 18}px`;
}

function speak({ title, lines }) {
  spoken.textContent = [title, ...lines].join(". ");
}

/**
 * Lets readers ask the points of a picture. Each has a place (`x`, `y`, in the picture's units), a `cell`, a `line` that it belongs to,
 * and they come line by line, from left to right.
 */
function letAsk(svg, points, describe) {
  const ring = draw("circle", { r: 8, class: "ring", visibility: "hidden" });
  svg.append(ring);
  let current = -1;
  const scale = () => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;

  function hide() {
    ring.setAttribute("visibility", "hidden");
    hideTip();
  }

  function ask(number, aloud) {
    current = number;
    const point = points[number];
    fit(ring, { cx: point.x, cy: point.y, visibility: "visible" }, []);
    const box = svg.getBoundingClientRect();
    const said = describe(point.cell);
    showTip(said, box.left + point.x * scale(), box.top + point.y * scale());
    if (aloud) speak(said);
  }

  function pointAt(event) {
    const box = svg.getBoundingClientRect();
    const [x, y] = [(event.clientX - box.left) / scale(), (event.clientY - box.top) / scale()];
    let [best, distance] = [-1, (event.pointerType === "mouse" ? 30 : 45) ** 2];
    points.forEach((point, number) => {
      const away = (point.x - x) ** 2 + (point.y - y) ** 2;
      if (away < distance) [best, distance] = [number, away];
    });
    best < 0 ? hide() : ask(best, false);
  }

  /** The point of another line that is nearest along x. */
  function onLine(step) {
    const lines = [...new Set(points.map((point) => point.line))];
    const line = lines[(lines.indexOf(points[current].line) + step + lines.length) % lines.length];
    const there = points.map((point, number) => ({ away: Math.abs(point.x - points[current].x), line: point.line, number }));
    return there.filter((point) => point.line === line).reduce((a, b) => (b.away < a.away ? b : a)).number;
  }

  function onKey(event) {
    if (event.key === "Escape") return hide();
    const steps = {
      ArrowRight: () => Math.min(current + 1, points.length - 1),
      ArrowLeft: () => Math.max(current - 1, 0),
      ArrowUp: () => onLine(-1),
      ArrowDown: () => onLine(1),
      Home: () => 0,
      End: () => points.length - 1,
    };
    if (!steps[event.key] || points.length === 0) return;
    event.preventDefault();
    ask(current < 0 ? 0 : steps[event.key](), true);
  }

  fit(svg, { pointermove: pointAt, pointerdown: pointAt, pointerleave: hide, keydown: onKey, blur: hide }, []);
}
