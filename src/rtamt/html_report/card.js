// One card: what it holds is read when it is opened for the first time.

const node = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && typeof value !== "string") made[key] = value; else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};

const settled = () => new Promise((done) => { requestAnimationFrame(() => setTimeout(done)); });

// The data of a card, without its arrays.
const contents = new Map();
const contentOf = (number) => {
  if (!contents.has(number)) {
    const holder = document.getElementById(`data-${number}`);
    contents.set(number, holder ? JSON.parse(holder.textContent) : null);
  }
  return contents.get(number);
};

class Card {
  constructor(section) {
    this.section = section;
    this.number = section.dataset.number;
    this.data = contentOf(this.number);
    this.ready = this.data === null ? Promise.resolve() : this.build();
  }

  async build() {
    const { data } = this;
    this.timeline = Timeline.of(data);
    this.fitted = false;
    this.charts = [];
    this.nodes = data.nodes.map(({ line }) => new Line(line));
    this.panels = data.panels.map(({ lines }) => lines.map((line) => new Line(line)));
    this.body = node("div", { class: "body" });
    this.section.append(this.body);
    this.tools = new Tools(this);
    for (const [i, panel] of data.panels.entries()) {
      const host = this.host(Math.max(150, 34 + 17 * panel.lines.length), panel.lines.map(({ name }) => name).join(", "));
      this.body.append(host.frame);
      this.charts.push(new Chart(this, host.plot, {
        lines: this.panels[i], height: host.height, levels: panel.thresholds, fails: new Float64Array(), because: await intervalsOf(panel.because),
      }));
    }
    this.body.append(node("h3", {}, `Robustness of the formula and its parts; values of the parts at ${data.valuesAt}`));
    await this.tree();
    if (data.bounds) this.band(data.bounds);
    this.timeline.join(this);
    this.section.querySelectorAll(".go").forEach((line) => this.link(line));
    this.section.addEventListener("toggle", () => { if (this.section.open) this.draw(); });
    new ResizeObserver(() => this.draw()).observe(this.body);
    await this.prepare();
  }

  host(height, title) {
    const plot = node("div", { class: "plot", role: "img" });
    plot.style.minHeight = `${height}px`;
    const frame = node("div", { class: "chart" }, plot);
    if (title) frame.prepend(node("h4", {}, title));
    return { frame, plot, height };
  }

  // The formula as lines that fold, each with its chart; a part that stands in several places is in the first.
  async tree() {
    const { data } = this, open = new Set(data.open), shown = new Set();
    const stack = [[0, 0]];
    while (stack.length) {
      const [number_, depth] = stack.pop();
      if (shown.has(number_)) continue;
      shown.add(number_);
      const part = data.nodes[number_];
      const value = part.value === "inf" ? Infinity : part.value === "-inf" ? -Infinity : part.value;
      const kind = part.failing ? "violated" : "satisfied";
      const name = part.name ? [node("i", {}, part.name), " = "] : [];
      const fold = node("details", { class: "part", open: open.has(number_), "data-node": String(number_) },
        node("summary", {}, node("code", {}, ...name, part.text), " ", node("b", { class: kind }, `${part.failing ? "✗" : "✓"} ${number(value)}`)));
      fold.style.setProperty("--depth", depth);
      const host = this.host(104);
      fold.append(host.frame);
      if (part.hidden) fold.append(node("p", { class: "quiet" }, "The parts below are not shown."));
      this.body.append(fold);
      this.charts.push(new Chart(this, host.plot, {
        lines: [this.nodes[number_]], height: 104, levels: [0], node: number_, fails: await intervalsOf(part.fails), because: await intervalsOf(part.because),
      }));
      fold.addEventListener("toggle", () => this.prepare());
      for (const child of [...part.children].reverse()) stack.push([child, depth + 1]);
    }
  }

  // What was known of the robustness at the start after each sample.
  band({ decided, robustness, line }) {
    this.body.append(node("h3", {}, `Bounds of the robustness at the start, after each sample; decided ${decided === null ? "at the end" : `at ${decided}`}`));
    const host = this.host(104);
    this.body.append(host.frame);
    const levels = typeof robustness === "number" && robustness !== 0 ? [0, robustness] : [0];
    this.charts.push(new Chart(this, host.plot, {
      lines: [new Line(line)], height: 104, levels, fails: new Float64Array(), because: new Float64Array(),
    }));
  }

  // Draw what is small at once, then load every sample of what is seen.
  async prepare() {
    const seen = this.charts.filter((chart) => chart.visible);
    await Promise.all(seen.flatMap((chart) => chart.lines.map((line) => line.at || line.loaded ? null : line.prepare())));
    this.draw();
    for (const line of new Set(seen.flatMap((chart) => chart.lines))) {
      if (line.embedded && !line.loaded) {
        await settled();
        await line.load();
        this.draw();
      }
    }
  }

  draw() {
    if (!this.section.open || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.paint());
  }

  paint() {
    this.waiting = false;
    for (const chart of this.charts) {
      if (chart.visible && chart.lines.every((line) => line.loaded || line.at)) chart.draw();
    }
    this.tools.status();
  }

  point() {
    if (!this.section.open) return;
    for (const chart of this.charts) if (chart.visible) chart.point();
    this.tools.status();
  }

  // Discrete time has values at samples only.
  snapped(position) {
    const { start, end } = this.timeline, inside = Math.min(Math.max(position, start), end);
    const line = this.nodes[0];
    return this.data.dense || !line.loaded ? inside : line.x[line.nearest(inside, false)];
  }

  // The next or the last sample, in dense time the next or the last change of any line.
  step(direction) {
    const from = this.timeline.cursor ?? this.data.at;
    const lines = this.data.dense ? this.charts.filter((chart) => chart.visible).flatMap((chart) => chart.lines) : [this.nodes[0]];
    const places = lines.filter((line) => line.loaded).map((line) => {
      const i = before(line.x, from);
      return direction > 0 ? line.x[i + 1] : line.x[i] < from ? line.x[i] : line.x[i - 1];
    }).filter((x) => x !== undefined);
    if (!places.length) return;
    const next = direction > 0 ? Math.min(...places) : Math.max(...places);
    const [low, high] = this.timeline.view;
    if (next < low || next > high) this.timeline.pan(direction / 2);
    this.timeline.point(next);
  }

  go(number_, from, to) {
    const span = this.timeline.end - this.timeline.start;
    const samples = this.data.dense ? 0 : (30 * span) / Math.max(this.nodes[0].points - 1, 1); // some beside one sample
    const margin = Math.max((to - from) * 0.5, samples, this.data.dense ? span * 0.04 : 0);
    const fold = this.section.querySelector(`[data-node="${number_}"]`);
    fold.open = true;
    this.timeline.cursor = this.snapped(from);
    this.timeline.look(from - margin, to + margin);
    fold.classList.add("flash");
    setTimeout(() => fold.classList.remove("flash"), 1500);
    fold.scrollIntoView({ block: "nearest" });
  }

  // A sentence about an instant is a button to it.
  link(line) {
    const button = node("button", { type: "button", class: "link" }, ...line.childNodes);
    line.append(button);
    button.addEventListener("click", () => this.go(...line.dataset.go.split(" ").map(Number)));
  }

  fold(open) { this.section.querySelectorAll("details.part").forEach((fold, i) => { fold.open = open || i === 0; }); }

  // The signals of the trace that any card shows, the robustness of the parts of this formula, and all other signals.
  choices() {
    const found = new Map();
    for (const holder of document.querySelectorAll("script[id^=data-]")) {
      const data = contentOf(holder.id.slice(5));
      if (data.trace !== this.data.trace) continue;
      for (const panel of data.panels) for (const line of panel.lines) if (!found.has(line.name)) found.set(line.name, line);
    }
    this.data.nodes.forEach(({ text, line }) => found.set(`robustness of ${text}`, { ...line, name: `robustness of ${text}` }));
    for (const holder of document.querySelectorAll("script[id^=signals-]")) {
      const { trace, lines } = JSON.parse(holder.textContent);
      if (trace === this.data.trace) lines.forEach((line) => { if (!found.has(line.name)) found.set(line.name, line); });
    }
    return found;
  }

  redrawn() {
    this.charts.forEach((chart) => chart.drop());
    this.draw();
  }
}
