// Legends with values at the cursors, the tool bar of a card, keys, and what can be saved.

class Legend {
  constructor(chart) {
    this.chart = chart;
    this.list = node("div", { class: "legend" });
    chart.host.after(this.list);
    this.fill();
  }

  fill() {
    const { chart } = this;
    this.cells = chart.lines.map((line, index) => {
      const value = node("span", { class: "value" });
      const toggle = node("button", { type: "button", "aria-pressed": String(line.shown), class: "line" },
        node("span", { class: "swatch", "aria-hidden": "true" }), chart.robustness && index === 0 ? "robustness" : line.name);
      toggle.style.setProperty("--color", `var(--${chart.color(index)})`);
      toggle.addEventListener("click", () => {
        line.shown = !line.shown;
        toggle.setAttribute("aria-pressed", String(line.shown));
        chart.draw();
      });
      return { toggle, value };
    });
    this.remark = node("span", { class: "quiet" });
    this.list.replaceChildren(...this.cells.flatMap(({ toggle, value }) => [toggle, value]), this.adder(), this.remark);
  }

  adder() {
    const select = node("select", { "aria-label": "add a signal to this chart" }, node("option", { value: "" }, "add signal…"));
    const offer = () => {
      const present = new Set(this.chart.lines.map(({ name }) => name));
      this.offered = this.chart.card.choices();
      const names = [...this.offered.keys()].filter((name) => !present.has(name));
      select.replaceChildren(select.firstChild, ...names.map((name) => node("option", { value: name }, name)));
    };
    select.addEventListener("pointerdown", offer, { once: true });
    select.addEventListener("focus", offer, { once: true });
    select.addEventListener("change", () => { if (select.value) this.add(new Line(this.offered.get(select.value))); });
    return select;
  }

  async add(line) {
    const { chart } = this;
    await line.prepare();
    chart.lines = [...chart.lines, line];
    chart.drop();
    this.fill();
    chart.draw();
    await chart.card.prepare();
  }

  // The values at the cursor and at the marks, and the difference of the marks.
  values() {
    const { chart } = this, { timeline } = chart, dense = chart.card.data.dense;
    const [a, b] = timeline.marks;
    this.cells.forEach(({ value }, i) => {
      const line = chart.lines[i], at = (position) => line.valueAt(position, dense), texts = [];
      if (timeline.cursor !== null) texts.push(at(timeline.cursor));
      if (a !== null) texts.push(`A ${at(a)}`);
      if (b !== null) texts.push(`B ${at(b)}`);
      if (a !== null && b !== null && line.loaded && !line.data.names) {
        const [from, to] = [a, b].map((position) => line.y[line.nearest(position, dense)]);
        if (Number.isFinite(to - from)) texts.push(`B−A ${number(to - from)}`);
      }
      value.textContent = texts.join("  ");
    });
  }

  // What is drawn if it is not every sample.
  note(seen) {
    const kinds = new Set(seen.map(({ kind }) => kind)), most = Math.max(...seen.map(({ per }) => per || 0));
    const bands = this.chart.lines.every(({ data }) => data.band);
    this.remark.textContent = bands ? "" : kinds.has("ranges") ? "boxes: range of the samples, which this file does not hold"
      : kinds.has("extremes") ? `${number(Math.round(most * devicePixelRatio))} samples a pixel: lowest and highest drawn` : "";
  }
}

class Tools {
  constructor(card) {
    this.card = card;
    const { timeline } = card;
    const bar = node("div", { class: "tools", role: "toolbar", "aria-label": "charts" });
    bar.title = "drag: zoom time or values; double-click: all; click: mark A, Shift and click: mark B; Ctrl and the wheel zoom; keys: arrows step, + - 0 zoom, a b marks, v violation, f fit values";
    const actions = [
      ["−", "zoom out", () => timeline.zoom(2)],
      ["+", "zoom in", () => timeline.zoom(0.5)],
      ["←", "earlier", () => timeline.pan(-0.4)],
      ["→", "later", () => timeline.pan(0.4)],
      ["all", "all of the time", () => this.all()],
      ["violation", "zoom to the first violation", () => this.violation()],
      ["fit values", "fit the values to what is seen", () => this.fit()],
      ["A", "mark A at the cursor", () => this.mark(0)],
      ["B", "mark B at the cursor", () => this.mark(1)],
      ["clear", "remove the marks", () => { timeline.mark(0, null); timeline.mark(1, null); }],
      ["unfold", "unfold all parts of the formula", () => card.fold(true)],
      ["fold", "fold all parts of the formula", () => card.fold(false)],
      ["PNG", "save the charts as an image", () => this.picture()],
      ["CSV", "save the samples that are seen", () => this.table()],
      ["link", "copy the address of this view", () => this.address()],
    ];
    this.buttons = {};
    for (const [name, label, action] of actions) {
      if (name === "violation" && !card.section.classList.contains("violated")) continue;
      const button = node("button", { type: "button", "aria-label": label, title: label }, name);
      button.addEventListener("click", action);
      this.buttons[name] = button;
      bar.append(button);
    }
    this.buttons["fit values"].setAttribute("aria-pressed", "false");
    this.output = node("output", { "aria-live": "polite" });
    bar.append(this.output);
    card.body.append(bar);
    this.keys();
  }

  keys() {
    const { card } = this, { timeline } = card;
    const keys = {
      ArrowLeft: () => card.step(-1), ArrowRight: () => card.step(1), "+": () => timeline.zoom(0.5), "-": () => timeline.zoom(2),
      0: () => this.all(), a: () => this.mark(0), b: () => this.mark(1), v: () => this.violation(), f: () => this.fit(),
    };
    card.body.tabIndex = 0;
    card.body.setAttribute("role", "group");
    card.body.setAttribute("aria-label", "charts; arrow keys move the cursor");
    card.body.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.target instanceof HTMLSelectElement) return;
      const action = keys[event.key];
      if (action) { event.preventDefault(); action(); }
    });
  }

  all() {
    this.card.charts.forEach((chart) => { chart.values = null; });
    this.card.timeline.everything();
  }

  violation() {
    const line = this.card.section.querySelector(".go[data-go^='0 ']");
    if (line) this.card.go(...line.dataset.go.split(" ").map(Number));
  }

  fit() {
    this.card.fitted = !this.card.fitted;
    this.buttons["fit values"].setAttribute("aria-pressed", String(this.card.fitted));
    this.card.draw();
  }

  mark(which) { this.card.timeline.mark(which, this.card.timeline.cursor ?? this.card.data.at); }

  // The time that is seen or pointed at, and the time between the marks.
  status() {
    const { timeline } = this.card, { times, cursor, marks: [a, b] } = timeline;
    const [low, high] = timeline.view;
    const texts = [cursor === null ? `${times.text(Math.max(low, timeline.start))} to ${times.text(Math.min(high, timeline.end))}` : times.text(cursor)];
    if (a !== null) texts.push(`A ${times.text(a)}`);
    if (b !== null) texts.push(`B ${times.text(b)}`);
    if (a !== null && b !== null) texts.push(`B−A ${number(b - a)} s`);
    this.output.textContent = texts.join(" · ");
  }

  name(suffix) {
    const words = `${this.card.section.querySelector("summary b").textContent} ${this.card.data.trace}`;
    return `${words.replace(/[^\p{L}\p{N}.-]+/gu, "_").slice(-80)}.${suffix}`;
  }

  save(blob, suffix) {
    const link = node("a", { download: this.name(suffix), href: URL.createObjectURL(blob) });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }

  drawn() { return this.card.charts.filter((chart) => chart.visible && chart.plot); }

  canvas() {
    const ratio = devicePixelRatio, head = 20 * ratio, color = palette();
    const parts = this.drawn().map((chart) => ({ chart, canvas: chart.plot.ctx.canvas }));
    const sheet = node("canvas");
    sheet.width = Math.max(...parts.map(({ canvas }) => canvas.width));
    sheet.height = parts.reduce((sum, { canvas }) => sum + canvas.height + head, head);
    const ctx = sheet.getContext("2d");
    ctx.fillStyle = color("paper");
    ctx.fillRect(0, 0, sheet.width, sheet.height);
    ctx.font = `${12 * ratio}px system-ui, sans-serif`;
    ctx.fillStyle = color("ink");
    ctx.fillText(this.card.section.querySelector("summary").textContent, 8 * ratio, 14 * ratio);
    let y = head;
    for (const { chart, canvas } of parts) {
      let x = 8 * ratio;
      chart.lines.forEach((line, i) => {
        if (!line.shown) return;
        ctx.fillStyle = color(chart.color(i));
        ctx.fillText(line.name, x, y + 14 * ratio);
        x += ctx.measureText(line.name).width + 16 * ratio;
      });
      ctx.drawImage(canvas, 0, y + head);
      y += canvas.height + head;
    }
    return sheet;
  }

  picture() { this.canvas().toBlob((blob) => this.save(blob, "png")); }

  // The samples that are seen, one row for each instant that any shown line has.
  csv() {
    const { timeline, data } = this.card, [low, high] = timeline.view;
    const lines = [...new Set(this.drawn().flatMap((chart) => chart.lines))].filter((line) => line.shown && line.loaded);
    const names = [...new Set(lines.map((line) => line.name))].map((name) => lines.find((line) => line.name === name));
    const columns = names.map((line) => {
      const first = before(line.x, low) + (line.x[before(line.x, low)] === low ? 0 : 1), last = before(line.x, high);
      return { line, at: first, last };
    });
    const quoted = (text) => (/[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const since = data.dated ? ` after ${new Date(data.origin).toISOString()}` : data.origin ? ` after ${data.origin} s` : "";
    const rows = [[`time [s]${since}`, ...names.map((line) => quoted(line.name))].join(",")];
    for (;;) {
      let next = Infinity;
      for (const { line, at, last } of columns) if (at <= last && line.x[at] < next) next = line.x[at];
      if (next === Infinity) break;
      rows.push([next, ...columns.map((column) => (column.at <= column.last && column.line.x[column.at] === next ? column.line.written(column.at++) : ""))].join(","));
    }
    return `${rows.join("\n")}\n`;
  }

  table() {
    this.save(new Blob([this.csv()], { type: "text/csv" }), "csv");
    if (this.drawn().some((chart) => chart.lines.some((line) => !line.embedded))) {
      this.output.textContent = "this file does not hold every sample of some lines: they are left out";
    }
  }

  address() {
    const [from, to] = this.card.timeline.view.map((position) => Number(position.toPrecision(12)));
    history.replaceState(null, "", `#${this.card.section.id}@${from}..${to}`);
    this.output.textContent = "the address is in the address bar";
    if (navigator.clipboard) navigator.clipboard.writeText(location.href).then(() => { this.output.textContent = "address copied"; }, () => {});
  }
}
