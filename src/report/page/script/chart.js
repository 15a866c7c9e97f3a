// Draws a view: panels as SVG, the legend above them.

const SHAPES = [
  "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0", "M-3.6,-3.6h7.2v7.2h-7.2z", "M0,-4.8L4.6,3.6H-4.6z", "M0,-5L5,0L0,5L-5,0z", "M0,4.8L4.6,-3.6H-4.6z",
  "M-4.6,-1.5h3.1v-3.1h3v3.1h3.1v3h-3.1v3.1h-3v-3.1h-3.1z", "M-4.8,0L-1.5,-4.2h3L4.8,0L1.5,4.2h-3z",
  "M-4.2,-4.2h2.2L0,-2L2,-4.2h2.2v2.2L2,0L4.2,2v2.2H2L0,2L-2,4.2h-2.2V2L-2,0L-4.2,-2z",
];
const RULES = ["5 4", "2 3", "9 3", "1 2"];
/** Colours of outcomes in the order in which the table first has them. */
const OUTCOMES = ["#56b4e9", "#e69f00", "#d55e00", "#6a3d9a", "#1f2328", "#009e73", "#cc79a7", "#0072b2"];
/** Blues: the least is not yet white, which is none. */
const TINTS = ["#ffffff", "#c6dbef", "#9ecae1", "#4d97c9", "#1f65ae", "#08306b"];
const MANY = 1500;

/** Beyond the palette, shapes come again in other colours. */
const colour = (line) => `var(--c${(line + 3 * Math.floor(line / 8)) % 8})`;
const at1 = (number) => number.toFixed(1);

function marker(line, x, y, more = {}) {
  return draw("path", { d: SHAPES[line % 8], transform: `translate(${at1(x)},${at1(y)})`, fill: colour(line), ...more });
}

function tint(part) {
  const place = (0.12 + 0.88 * Math.min(Math.max(part, 0), 1)) * (TINTS.length - 1);
  const below = Math.min(Math.floor(place), TINTS.length - 2);
  return `color-mix(in srgb, ${TINTS[below + 1]} ${Math.round(100 * (place - below))}%, ${TINTS[below]})`;
}

/** How the tiles of a view are filled and signed. */
function lookOf(view) {
  const { fill, sign } = view.spec.mark.tiles;
  const [column, signs] = [view.table.column(fill), sign ? view.table.column(sign) : null];
  const spaced = (value) => (column.scale === "log" ? Math.log10(Math.max(value, 1e-300)) : value);
  const shown = column.isNumber ? view.places.map((place) => column.value(place.row)).filter((value) => value !== null && (column.scale !== "log" || value > 0)) : [];
  let [low, high] = [shown.reduce((a, b) => Math.min(a, b), Infinity), shown.reduce((a, b) => Math.max(a, b), -Infinity)];
  if (column.scale === "share" && column.role !== "condition") [low, high] = [Math.min(low, 0), Math.max(high, 1)];
  const part = (value) => (spaced(high) > spaced(low) ? (spaced(value) - spaced(low)) / (spaced(high) - spaced(low)) : 0.5);
  const letter = (code) => {
    const start = (other, n) => column.levels.labels[other].slice(0, n).toLowerCase();
    const before = Array.from({ length: code }, (_, other) => other);
    return start(code, [1, 2, 3].find((n) => before.every((other) => start(other, n) !== start(code, n))) ?? 3);
  };
  return {
    column, signs, ends: [low, high],
    fill: (row) => (column.isNumber ? tint(part(column.value(row))) : OUTCOMES[column.levels.codes[row] % 8]),
    isDark: (row) => (column.isNumber ? part(column.value(row)) > 0.55 : [2, 3, 4, 7].includes(column.levels.codes[row] % 8)),
    sign: (row) => {
      if (signs && !signs.isAbsent(row)) return signs.isNumber ? signs.tick(signs.value(row)) : signs.say(signs.value(row));
      if (column.isAbsent(row)) return "";
      return column.isNumber ? column.tick(column.value(row)) : letter(column.levels.codes[row]);
    },
  };
}

/** An entry of a legend: a small picture and what it stands for. */
function legendEntry(text, ...shapes) {
  return make("span", { class: "entry" }, draw("svg", { viewBox: "-14 -8 28 16", width: 28, height: 16, "aria-hidden": "true" }, ...shapes), text);
}

function legendOf(view, look) {
  const { spec, lines, table } = view;
  const entries = [];
  if (look) {
    entries.push(make("span", { class: "name" }, `${look.column.title}:`));
    if (look.column.isNumber) entries.push(make("span", { class: "entry" }, look.column.tick(look.ends[0]), make("span", { class: "bar", style: `background: linear-gradient(to right, ${[0, 0.5, 1].map(tint).join()})` }), look.column.tick(look.ends[1])));
    else look.column.levels.labels.forEach((label, code) => entries.push(legendEntry(label, draw("rect", { x: -12, y: -7, width: 24, height: 14, fill: OUTCOMES[code % 8] }))));
    if (look.signs) entries.push(make("span", { class: "name" }, `written: ${look.signs.title}`));
  } else if (spec.lines.length) {
    entries.push(make("span", { class: "name" }, `${lines.heading}:`));
    lines.names.forEach((name, line) => {
      const stroke = draw("path", { d: "M-13,0H13", class: "line", style: `stroke: ${colour(line)}` });
      entries.push(legendEntry(name, ...(view.isJoined ? [stroke] : []), marker(line, 0, 0)));
    });
  }
  if (view.hasBands || view.hasWhiskers) {
    const [low, high] = table.column(spec.y).interval.map((name) => table.column(name).words);
    const same = low.split(", ")[0];
    const words = low.includes(", ") && same === high.split(", ")[0] ? same : `${low} to ${high}`;
    entries.push(legendEntry(words, view.hasBands ? draw("rect", { x: -13, y: -6, width: 26, height: 12, fill: "var(--quiet)", class: "band" }) : draw("path", { d: "M0,-7V7", class: "whisker", stroke: "var(--quiet)" })));
  }
  if (spec.front) entries.push(legendEntry(`Pareto front: nothing is both ${table.column(spec.x).seconds ? "faster" : "cheaper"} and as good`, draw("path", { d: "M-13,5H0V-5H13", class: "front" })));
  spec.rules.forEach((rule, number) => {
    const first = spec.rules.findIndex((other) => other.words === rule.words);
    if (first === number) entries.push(legendEntry(rule.words, draw("path", { d: "M-13,0H13", class: "rule", "stroke-dasharray": RULES[number % 4] })));
  });
  return entries;
}

/** Draws a view below its legend; `width` pixels are there. */
function drawView(view, legend, host, width) {
  const look = view.kind === "tiles" ? lookOf(view) : null;
  legend.replaceChildren(...legendOf(view, look));
  const rowsOfPanels = look ? view.lines.names.map((_, line) => line) : [0];
  const n = view.panels.names.length;
  const labels = Math.min(220, 7 * Math.max(...view.y.ticks.map((tick) => tick.label.length)));
  const most = Math.max(1, Math.min(n, 3, Math.floor(width / 300)));
  const longest = look ? Math.max(1, ...view.places.map((place) => look.sign(place.row).length)) : 0;
  // Tiles shrink with their signs before a panel is wider than the page.
  const fitting = (room) => (room - 48 - labels) / view.x.n;
  const tile = Math.max(12, 4.2 * longest + 2, Math.min(64, fitting(width / n)), Math.min(22, fitting(width)), Math.min(7.2 * longest, fitting(width)));
  if (look) look.fontSize = Math.min(11, (tile - 2) / (0.6 * longest));
  const size = look ? 34 + labels + tile * view.x.n + 12 : Math.floor(width / most);
  host.style.setProperty("--width", `${Math.min(size, look ? Infinity : width)}px`);
  const panels = [];
  for (const row of rowsOfPanels) {
    for (let panel = 0; panel < n; panel++) panels.push(drawPanel(view, { panel, row: look ? row : null }, look, size, labels));
  }
  host.classList.toggle("tiles", Boolean(look));
  host.replaceChildren(...panels);
}

function drawPanel(view, { panel, row }, look, width, labels) {
  const { spec, x, y } = view;
  const title = [view.panels.titles[panel], row === null ? "" : view.lines.titles[row]].filter(Boolean).join(" · ");
  const turned = x.isWords && x.ticks.some((tick) => 7 * tick.label.length > (width - labels - 60) / x.n);
  const below = turned ? Math.min(250, 7 * Math.max(...x.ticks.map((tick) => tick.label.length)) + 30) : 46;
  const high = look || y.isWords ? 22 * y.n : Math.round(Math.min(400, Math.max(230, 0.55 * width)));
  const box = { left: 34 + labels, right: width - 12, top: title ? 30 : 10 };
  box.bottom = box.top + high;
  const px = (part) => box.left + part * (box.right - box.left);
  const py = (part) => box.bottom - part * (box.bottom - box.top);
  const inPanel = (place) => place.panel === panel && (row === null || place.line === row);
  const places = view.places.filter(inPanel);
  const svg = draw("svg", {
    viewBox: `0 0 ${Math.round(width)} ${box.bottom + below}`, tabindex: 0, role: "group", "aria-roledescription": "chart",
    "aria-label": `${spec.title}${title ? `: ${title}` : ""}. ${places.length} points. The arrow keys go from point to point; the tables below hold the same numbers.`,
  });
  if (title) svg.append(draw("text", { x: box.left, y: 18, class: "panel-title" }, title));
  drawAxes(svg, view, { box, px, py, turned, below, hasGrid: !look });
  const markers = look ? tilesOf(view, places, look, { px, py, box }) : marksOf(view, places, { px, py });
  const front = view.fronts.filter((one) => one.panel === panel).map((one) => frontOf(one, { px, py, box }));
  const rules = spec.rules.flatMap((rule) => {
    const number = spec.rules.findIndex((other) => other.words === rule.words);
    return view.ruleLines(rule, inPanel).map((line) => draw("path", { d: pathOf(line, px, py), class: look ? "rule over" : "rule", "stroke-dasharray": RULES[number % 4] }));
  });
  svg.append(...(look ? [...markers, ...rules] : [...rules, ...front, ...markers]));
  letAsk(svg, places.map((place) => ({ x: px(place.x), y: py(place.y), line: place.line, cell: place.row })), (cell) => view.table.describe(cell));
  return svg;
}

function pathOf(points, px, py) {
  return `M${points.map(([x, y]) => `${at1(px(x))},${at1(py(y))}`).join("L")}`;
}

function drawAxes(svg, view, { box, px, py, turned, below, hasGrid }) {
  const { left, right, top, bottom } = box;
  const xTicks = view.x.isWords ? view.x.ticks : thin(view.x.ticks, (tick) => (3.6 * tick.label.length + 4) / (right - left));
  for (const tick of xTicks) {
    const x = px(tick.at);
    if (hasGrid) svg.append(draw("line", { x1: x, x2: x, y1: top, y2: bottom + 5, class: "grid" }));
    const place = turned ? { x: x + 4, y: bottom + 10, transform: `rotate(-90 ${x + 4} ${bottom + 10})`, class: "tick end" } : { x, y: bottom + 19, class: "tick middle" };
    svg.append(draw("text", place, tick.label));
  }
  for (const tick of view.y.isWords ? view.y.ticks : thin(view.y.ticks, () => 7 / (bottom - top))) {
    const y = py(tick.at);
    if (hasGrid) svg.append(draw("line", { x1: left, x2: right, y1: y, y2: y, class: "grid" }));
    svg.append(draw("text", { x: left - 8, y: y + 4, class: "tick end" }, tick.label));
  }
  if (view.x.shelf) svg.append(draw("path", { d: `M${px(view.x.shelf)},${top}V${bottom}`, class: "rule", "stroke-dasharray": "5 4" }));
  if (view.y.shelf) svg.append(draw("path", { d: `M${left},${py(view.y.shelf)}H${right}`, class: "rule", "stroke-dasharray": "5 4" }));
  svg.append(draw("path", { d: hasGrid ? `M${left},${top}V${bottom}H${right}` : `M${left},${top}V${bottom}H${right}V${top}z`, class: "frame" }));
  svg.append(draw("text", { x: (left + right) / 2, y: bottom + below - 6, class: "axis-title middle" }, view.x.title));
  const middle = (top + bottom) / 2;
  svg.append(draw("text", { x: 13, y: middle, transform: `rotate(-90 13 ${middle})`, class: "axis-title middle" }, view.y.title));
}

/** Bands, whiskers, lines and markers of a panel. */
function marksOf(view, places, { px, py }) {
  const [under, lines, over] = [[], [], []];
  const isMany = places.length > MANY;
  view.lines.names.forEach((_, line) => {
    const own = places.filter((place) => place.line === line);
    if (own.length === 0) return;
    const bounded = own.filter((place) => place.ends);
    if (view.hasBands && bounded.length > 1) {
      const edge = bounded.map((place) => [place.x, place.ends[0]]).concat(bounded.map((place) => [place.x, place.ends[1]]).reverse());
      under.push(draw("path", { d: `${pathOf(edge, px, py)}z`, fill: colour(line), class: "band" }));
    } else if (view.hasBands || view.hasWhiskers) {
      const d = bounded.map((place) => `M${at1(px(place.x))},${at1(py(place.ends[0]))}V${at1(py(place.ends[1]))}`).join("");
      under.push(draw("path", { d, stroke: colour(line), class: "whisker" }));
    }
    if (view.isJoined && own.length > 1) {
      const path = own.map((place) => [place.x, place.y]);
      lines.push(draw("path", { d: pathOf(path, px, py), class: "line", style: `stroke: ${colour(line)}` }));
    }
    const [ahead, behind] = [own.filter((place) => view.onFront.has(place.row)), own.filter((place) => !view.onFront.has(place.row))];
    if (isMany) {
      const d = behind.map((place) => `M${at1(px(place.x) - 3)},${at1(py(place.y))}a3,3 0 1,0 6,0a3,3 0 1,0 -6,0`).join("");
      under.push(draw("path", { d, fill: colour(line), class: "cloud" }));
    } else over.push(...behind.map((place) => marker(line, px(place.x), py(place.y), pointAttributes(place, view.spec.front ? "cloud" : null))));
    over.push(...ahead.map((place) => marker(line, px(place.x), py(place.y), pointAttributes(place, "on-front"))));
  });
  return [...under, ...lines, ...over];
}

function pointAttributes(place, looks) {
  return { class: looks, "data-row": place.row, "data-panel": place.panel, "data-line": place.line, "data-x": place.x.toFixed(6), "data-y": place.y.toFixed(6) };
}

/** What a budget buys: level until the next point of the front. */
function frontOf({ places }, { px, py, box }) {
  const d = places.map((place, k) => (k ? `H${at1(px(place.x))}V${at1(py(place.y))}` : `M${at1(px(place.x))},${at1(py(place.y))}`)).join("");
  return draw("path", { d: `${d}H${box.right}`, class: "front", "data-rows": places.map((place) => place.row).join() });
}

function tilesOf(view, places, look, { px, py, box }) {
  const [width, height] = [(box.right - box.left) / view.x.n, (box.bottom - box.top) / view.y.n];
  return places.filter((place) => !look.column.isAbsent(place.row)).flatMap((place) => {
    const [x, y] = [px(place.x), py(place.y)];
    const tile = draw("rect", { x: x - width / 2, y: y - height / 2, width, height, fill: look.fill(place.row), class: "tile", ...pointAttributes(place, "tile") });
    return [tile, draw("text", { x, y: y + 4, style: `font-size: ${at1(look.fontSize)}px`, class: look.isDark(place.row) ? "sign light" : "sign" }, look.sign(place.row))];
  });
}
