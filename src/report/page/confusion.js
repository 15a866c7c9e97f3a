// What was taken for what, in an order that the reader chooses.

class ConfusionTable {
  constructor(host) {
    const { names, cells: known } = study.confusion;
    this.names = names;
    this.known = known;
    this.matrix = this.read(0);
    this.order = 0;
    const orders = [[0, "as in the study"], [1, "by name"], [2, "hardest first"], [3, "confused together"]];
    const sorted = choice("Order", orders, 0, (order) => this.sort(order));
    this.orders = sorted.select;
    const titles = known.map(({ cell, why }, number) => [number, `${why ? why + ": " : ""}cell ${cells.cell[cell]}, accuracy ${cells.accuracy[cell].toFixed(3)}, ${place(cell)}`]);
    const which = choice("Cell", titles, 0, (number) => {
      this.matrix = this.read(number);
      this.show();
    });
    this.grid = make("table", { class: "confusion", role: "grid", "aria-label": "Confusion matrix: rows were touched, columns are what they were taken for" });
    // As wide as there is room beside the names, at least as a number needs.
    this.grid.style.setProperty("--n", names.length);
    const room = Math.min(host.clientWidth, 1080) - 150;
    this.grid.style.setProperty("--side", `${Math.max(16, Math.min(44, Math.floor(room / names.length) - 1))}px`);
    fit(this.grid, { pointerover: (event) => this.ask(event.target, false), pointerleave: hideTip, focusin: (event) => this.ask(event.target, true), focusout: hideTip, keydown: (event) => this.move(event) }, []);
    const controls = make("div", { class: "controls" }, sorted.element, ...(known.length > 1 ? [which.element] : []));
    const frame = make("div", { class: "wide whole", role: "region", "aria-label": "Confusion matrix" }, this.grid);
    host.append(controls, frame);
    this.show();
  }

  /** Counts as rows, from the few that are not zero. */
  read(number) {
    const n = this.names.length;
    const counts = Array.from({ length: n }, () => new Array(n).fill(0));
    const { entries } = this.known[number];
    for (let place = 0; place < entries.length; place += 3) counts[entries[place]][entries[place + 1]] += entries[place + 2];
    return { counts, totals: counts.map((row) => row.reduce((sum, count) => sum + count, 0)) };
  }

  share(row, column) {
    return this.matrix.counts[row][column] / Math.max(1, this.matrix.totals[row]);
  }

  sort(order, focus) {
    this.order = order;
    if (order < 4) this.orders.value = order;
    this.show(focus);
  }

  /** The numbers of the objects in the chosen order: 0 to 3, or 4 + the object whose confusions come first. */
  sequence() {
    const all = this.names.map((_, number) => number);
    if (this.order === 1) return all.sort((a, b) => this.names[a].localeCompare(this.names[b]));
    if (this.order === 2) return all.sort((a, b) => this.share(a, a) - this.share(b, b));
    if (this.order === 3) return this.together();
    if (this.order < 4) return all;
    const first = this.order - 4;
    const near = (other) => (other === first ? 2 : this.share(first, other) + this.share(other, first));
    return all.sort((a, b) => near(b) - near(a));
  }

  /** Groups that are confused most join first, so that what is confused stands together. */
  together() {
    const groups = this.names.map((_, number) => [number]);
    const tie = (a, b) => {
      let sum = 0;
      for (const i of a) for (const j of b) sum += this.share(i, j) + this.share(j, i);
      return sum / (a.length * b.length);
    };
    while (groups.length > 1) {
      let [first, second, most] = [0, 1, -1];
      for (let i = 0; i < groups.length; i++) {
        for (let j = i + 1; j < groups.length; j++) {
          const strength = tie(groups[i], groups[j]);
          if (strength > most) [first, second, most] = [i, j, strength];
        }
      }
      groups[first] = groups[first].concat(groups[second]);
      groups.splice(second, 1);
    }
    return groups[0];
  }

  show(focus) {
    hideTip();
    const order = this.sequence();
    const name = (number) => this.names[number].replaceAll("_", " ");
    const columns = order.map((number) => make("th", { scope: "col", title: name(number) }, make("span", {}, name(number))));
    const head = make("thead", {}, make("tr", {}, make("td", { class: "corner" }, make("span", {}, "touched ↓ taken for →")), ...columns));
    const rows = order.map((row, place) => {
      const sorter = make("button", { type: "button", title: `Put what is confused with ${name(row)} first`, click: () => this.sort(4 + row, row) }, name(row));
      const cells = order.map((column, along) => this.cell(row, column, place === 0 && along === 0));
      return make("tr", { "data-row": row }, make("th", { scope: "row" }, sorter), ...cells);
    });
    this.grid.replaceChildren(head, make("tbody", {}, ...rows));
    if (focus !== undefined) this.grid.querySelector(`tr[data-row="${focus}"] button`).focus();
  }

  cell(row, column, first) {
    const count = this.matrix.counts[row][column];
    const share = this.share(row, column);
    const cell = make("td", { tabindex: first ? 0 : -1, "data-at": `${row},${column}`, class: row === column ? "right" : null }, count ? String(count) : "");
    // The square root, so that rare confusions are seen.
    if (count) cell.style.setProperty("--share-of", `${Math.round(100 * Math.sqrt(share))}%`);
    // Letters of the ground's colour stand out from the darkest fields alone.
    if (share > 0.25) cell.classList.add("deep");
    if (share > 0.5) cell.classList.add("deeper");
    return cell;
  }

  ask(target, aloud) {
    const at = target.closest("td[data-at]")?.dataset.at;
    if (!at) return hideTip();
    const [row, column] = at.split(",").map(Number);
    const name = (number) => this.names[number].replaceAll("_", " ");
    const { counts, totals } = this.matrix;
    const said = {
      title: row === column ? `${name(row)}: recognised` : `${name(row)} taken for ${name(column)}`,
      lines: [`${counts[row][column]} of ${totals[row]} test decisions, ${(100 * this.share(row, column)).toFixed(1)} %`],
    };
    const box = target.getBoundingClientRect();
    showTip(said, box.left + box.width / 2, box.top);
    if (aloud) speak(said);
  }

  move(event) {
    const cell = event.target.closest("td[data-at]");
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (!cell || !step) return;
    event.preventDefault();
    const row = this.grid.tBodies[0].rows[cell.parentNode.sectionRowIndex + step[0]];
    const next = row?.cells[cell.cellIndex + step[1]];
    if (!next?.dataset.at) return;
    cell.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  }
}
