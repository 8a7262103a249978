"use strict";
// Draws the charts of every card: signals, and the robustness of each sub-formula when it is unfolded.
// All charts of a card share the time that is seen (view) and the instant that is pointed at (cursor).
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const AXIS = 56, RIGHT = 96, TOP = 6, BOTTOM = 20, DOTS = 150;

  const element = (name, attributes, parent, text) => {
    const made = document.createElementNS(SVG, name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
  };

  const number = (value) => {
    if (Math.abs(value) === Infinity) return value > 0 ? "+∞" : "−∞";
    return String(Number(value.toPrecision(5))).replace("-", "−");
  };

  // Of a long name what there is room for beside a chart: its last field, as the heading has all of it.
  const shortened = (name) => {
    const tail = name.length > 12 ? name.split(".").pop() : name;
    return tail.length > 12 ? `${tail.slice(0, 11)}…` : tail;
  };

  // 1, 2 or 5 times a power of ten, so that about `count` of them fit.
  const niceStep = (span, count) => {
    const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
    return power * ([1, 2, 5].find((factor) => factor * power >= raw) || 10);
  };

  const ticks = (low, high, step) => {
    const found = [];
    for (let i = Math.ceil(low / step); i * step <= high + step * 1e-9; i++) found.push(i * step);
    return found;
  };

  const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400];

  class Times {
    constructor(data) { this.data = data; }

    text(x, step) {
      if (this.data.dated) {
        const iso = new Date(this.data.origin + x * 1000).toISOString();
        if (step === undefined) return iso.replace("T", " ").replace(/\.?0*Z$/, "");
        if (step >= 86400) return iso.slice(0, 10);
        return step >= 60 ? iso.slice(11, 16) : step >= 1 ? iso.slice(11, 19) : iso.slice(11, 23).replace(/0+$/, "");
      }
      const digits = step === undefined ? 9 : Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
      const text = String(Number(x.toFixed(Math.min(digits, 12)))).replace("-", "−");
      if (step !== undefined) return text;
      return this.data.origin ? `${this.data.origin} + ${text} s` : `${text} s`;
    }

    ticks(low, high, count) {
      let step = niceStep(high - low, count);
      if (!this.data.dated || step < 1) return [ticks(low, high, step), step];
      step = SECONDS.find((s) => s >= (high - low) / count) || Math.ceil((high - low) / count / 86400) * 86400;
      const offset = (this.data.origin / 1000) % step;
      return [ticks(low + offset, high + offset, step).map((t) => t - offset), step];
    }
  }

  // The index of the last point at or before x, -1 if there is none.
  const before = (line, x) => {
    let low = 0, high = line.x.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (line.x[middle] <= x) low = middle + 1; else high = middle;
    }
    return low - 1;
  };

  class Chart {
    constructor(card, host, lines, options) {
      Object.assign(this, { card, host, lines, ...options });
      this.lines.forEach((line) => { line.y = line.y.map(Number.isFinite).every(Boolean) ? line.y
        : line.y.map((y) => (y === "inf" ? Infinity : y === "-inf" ? -Infinity : y)); });
      const finite = lines.flatMap((line) => line.y.filter(Number.isFinite)).concat(this.levels);
      let low = finite.reduce((a, b) => Math.min(a, b), Infinity);
      let high = finite.reduce((a, b) => Math.max(a, b), -Infinity);
      if (!(low < high)) { const middle = Number.isFinite(low) ? low : 0; low = middle - 1; high = middle + 1; }
      const pad = (high - low) * 0.09;
      this.finite = [low, high];
      this.ends = [low - 3 * pad, high + 3 * pad];
      this.infinite = [-Infinity, Infinity].map((end) => lines.some((line) => line.y.includes(end)));
      this.range = [low - (this.infinite[0] ? 4 : 1) * pad, high + (this.infinite[1] ? 4 : 1) * pad];
    }

    get shown() { return this.host.closest("details:not([open])") === null; }

    get indent() { return this.host.getBoundingClientRect().left - this.card.section.getBoundingClientRect().left; }

    x(position) { const [a, b] = this.card.view; return this.left + ((position - a) / (b - a)) * (this.width - this.left - RIGHT); }

    y(value) {
      const [low, high] = this.range, clipped = Math.min(Math.max(value, this.ends[0]), this.ends[1]);
      return TOP + ((high - clipped) / (high - low)) * (this.height - TOP - BOTTOM);
    }

    position(clientX) {
      const [a, b] = this.card.view, box = this.svg.getBoundingClientRect();
      return a + ((clientX - box.left - this.left) / (this.width - this.left - RIGHT)) * (b - a);
    }

    draw() {
      if (!this.shown) return;
      this.width = Math.max(this.host.clientWidth, 320);
      this.left = this.card.left - this.indent; // so that an instant is at one place in all charts
      if (this.svg) this.svg.remove();
      const svg = this.svg = element("svg", {
        viewBox: `0 0 ${this.width} ${this.height}`, height: this.height, role: "img", "aria-label": this.summary(),
      }, this.host);
      const clip = `clip-${this.card.id}-${this.id}`;
      const inside = { x: this.left, y: 0, width: this.width - this.left - RIGHT, height: this.height - BOTTOM };
      element("rect", inside, element("clipPath", { id: clip }, svg));
      this.axes(svg);
      const plane = element("g", { "clip-path": `url(#${clip})` }, svg);
      this.stretches(plane, this.fails, "fails");
      this.stretches(plane, this.because, "because");
      this.levels.forEach((level) => this.level(plane, level, this.limits ? "limit" : "zero"));
      this.lines.forEach((line, i) => this.curve(plane, svg, line, i));
      this.marks(plane);
      this.hover = element("g", { "pointer-events": "none" }, svg);
      this.point();
    }

    summary() {
      const told = this.lines.map((line) => `${line.name} from ${number(Math.min(...line.y))} to ${number(Math.max(...line.y))}`);
      const times = this.card.times;
      const failing = this.fails.slice(0, 5).map(([a, b]) => `${times.text(Math.max(a, this.card.data.start))} to ${times.text(b)}`);
      return told.join("; ") + (failing.length ? `; does not hold from ${failing.join(", ")}` : "");
    }

    stretches(plane, list, kind) {
      let path = ""; // one for all, so that nothing is shaded twice
      for (const [start, end] of list) {
        const a = this.x(start), b = Math.max(this.x(end), a + 1.5);
        if (b < this.left || a > this.width - RIGHT) continue;
        path += `M${a} ${TOP - 4}H${b}V${this.height - BOTTOM}H${a}Z`;
      }
      if (path) element("path", { class: kind, d: path }, plane);
    }

    axes(svg) {
      const [low, high] = this.card.view, bottom = this.height - BOTTOM;
      const [places, step] = this.card.times.ticks(low, high, Math.max((this.width - this.left - RIGHT) / 110, 2));
      for (const place of places) {
        element("line", { class: "grid", x1: this.x(place), x2: this.x(place), y1: TOP, y2: bottom }, svg);
        element("text", { x: this.x(place), y: bottom + 14, "text-anchor": "middle" }, svg, this.card.times.text(place, step));
      }
      for (const tick of ticks(...this.finite, niceStep(this.finite[1] - this.finite[0], 3))) {
        element("text", { x: this.left - 8, y: this.y(tick) + 4, "text-anchor": "end" }, svg, number(tick));
      }
      this.infinite.forEach((there, above) => {
        if (!there) return;
        this.level(svg, this.ends[above], "edge");
        element("text", { x: this.left - 8, y: this.y(this.ends[above]) + 4, "text-anchor": "end" }, svg, above ? "+∞" : "−∞");
      });
    }

    level(svg, value, kind) {
      element("line", { class: kind, x1: this.left, x2: this.width - RIGHT, y1: this.y(value), y2: this.y(value) }, svg);
    }

    // Only what is seen, and one point on either side.
    curve(plane, svg, line, index) {
      const [low, high] = this.card.view;
      const first = Math.max(before(line, low), 0), last = Math.min(before(line, high) + 1, line.x.length - 1);
      const dense = this.card.data.dense;
      let path = "";
      for (let i = first; i <= last; i++) {
        const x = this.x(line.x[i]).toFixed(2), y = this.y(line.y[i]).toFixed(2);
        path += i === first ? `M${x} ${y}` : dense ? `H${x}V${y}` : `L${x} ${y}`;
      }
      if (!this.limits) {
        const zero = this.y(0), ends = [this.x(line.x[first]), this.x(line.x[last])];
        const area = `${path}L${ends[1]} ${zero}L${ends[0]} ${zero}Z`;
        for (const [kind, y, height] of [["above", 0, zero], ["below", zero, this.height]]) {
          const id = `half-${this.card.id}-${this.id}-${kind}`;
          element("rect", { x: 0, y, width: this.width, height }, element("clipPath", { id }, svg));
          element("path", { d: area, class: kind, "clip-path": `url(#${id})` }, plane);
        }
      }
      const color = this.limits ? `var(--s${index % 6})` : "var(--ink)";
      element("path", { d: path, class: "line", style: `stroke:${color}` }, plane);
      if (last - first < DOTS) {
        for (let i = first; i <= last; i++) {
          element("circle", { class: "dot", style: `fill:${color}`, cx: this.x(line.x[i]), cy: this.y(line.y[i]), r: 2.2 }, plane);
        }
      }
      if (this.limits) {
        element("text", { class: "name", style: `fill:${color}`, x: this.width - RIGHT + 8, y: TOP + 12 + index * 15 }, svg,
          shortened(line.name));
      }
    }

    marks(plane) {
      const critical = this.card.data.critical;
      if (!critical) return;
      const x = this.x(critical.x);
      element("line", { class: "critical", x1: x, x2: x, y1: 0, y2: this.height - BOTTOM }, plane);
      if (this.node !== critical.node) return;
      const line = this.lines[0], y = this.y(line.y[Math.max(before(line, critical.x), 0)]);
      element("path", { class: "diamond", d: `M${x} ${y - 6}L${x + 6} ${y}L${x} ${y + 6}L${x - 6} ${y}Z` }, plane);
    }

    // The cursor, with the values there.
    point() {
      if (!this.hover) return;
      this.hover.replaceChildren();
      const { cursor, drag } = this.card;
      if (drag) {
        const [a, b] = [this.x(Math.min(...drag)), this.x(Math.max(...drag))];
        element("rect", { class: "drag", x: a, width: b - a, y: 0, height: this.height - BOTTOM }, this.hover);
      }
      if (cursor === null || cursor < this.card.view[0] || cursor > this.card.view[1]) return;
      element("line", { class: "cursor", x1: this.x(cursor), x2: this.x(cursor), y1: 0, y2: this.height - BOTTOM }, this.hover);
      this.lines.forEach((line, i) => {
        const at = this.card.nearest(line, cursor);
        const y = this.limits ? TOP + 12 + (this.lines.length + i) * 15 : TOP + 12;
        element("text", { class: "told", x: this.width - RIGHT + 8, y, style: this.limits ? `fill:var(--s${i % 6})` : "" },
          this.hover, number(line.y[at]));
        element("circle", { class: "dot", cx: this.x(this.card.data.dense ? cursor : line.x[at]), cy: this.y(line.y[at]), r: 4 }, this.hover);
      });
    }

    listen() {
      const { host, card } = this;
      host.addEventListener("pointermove", (event) => {
        card.cursor = card.snapped(this.position(event.clientX));
        if (card.drag) card.drag[1] = this.position(event.clientX);
        card.point();
      });
      host.addEventListener("pointerleave", () => { if (!card.drag) { card.cursor = null; card.point(); } });
      host.addEventListener("pointerdown", (event) => {
        if (event.button !== 0 || event.pointerType === "touch") return;
        const start = this.position(event.clientX);
        card.drag = [start, start];
        host.setPointerCapture(event.pointerId);
      });
      host.addEventListener("pointerup", () => {
        const drag = card.drag;
        card.drag = null;
        if (drag && Math.abs(this.x(drag[1]) - this.x(drag[0])) > 4) card.look(Math.min(...drag), Math.max(...drag));
        else card.point();
      });
      host.addEventListener("dblclick", () => card.all());
      host.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
        event.preventDefault();
        card.zoom(event.deltaY > 0 ? 1.25 : 0.8, this.position(event.clientX));
      }, { passive: false });
    }
  }

  class Card {
    constructor(section, id) {
      this.section = section;
      this.id = id;
      this.data = JSON.parse(section.querySelector("script").textContent);
      this.times = new Times(this.data);
      const margin = 0.01 * (this.data.end - this.data.start) || 0.5;
      this.limits = [this.data.start - margin, this.data.end + margin];
      this.view = [...this.limits];
      this.cursor = null;
      this.drag = null;
      this.charts = [...section.querySelectorAll(".chart")].map((host, i) => this.chart(host, i));
      this.charts.forEach((chart) => chart.listen());
      this.tools();
      section.querySelectorAll("details").forEach((fold) => fold.addEventListener("toggle", () => this.draw()));
      section.querySelectorAll("a.go").forEach((link) => this.link(link));
      new ResizeObserver(() => this.draw()).observe(section);
      this.draw();
    }

    chart(host, id) {
      if (host.dataset.panel !== undefined) {
        const panel = this.data.panels[host.dataset.panel];
        const height = Math.max(130, 40 + 30 * panel.lines.length);
        return new Chart(this, host, panel.lines, { id, height, limits: true, levels: panel.thresholds, because: panel.because, fails: [] });
      }
      const node = this.data.nodes[host.dataset.node];
      return new Chart(this, host, [node.line], {
        id, height: 96, limits: false, levels: [0], because: node.because, fails: node.fails, node: Number(host.dataset.node),
      });
    }

    draw() {
      this.left = AXIS + Math.max(...this.charts.filter((chart) => chart.shown).map((chart) => chart.indent));
      this.charts.forEach((chart) => chart.draw());
      this.told();
    }

    point() { this.charts.forEach((chart) => { if (chart.shown) chart.point(); }); this.told(); }

    told() {
      const [low, high] = this.view;
      this.output.textContent = this.cursor === null
        ? `${this.times.text(Math.max(low, this.data.start))} to ${this.times.text(Math.min(high, this.data.end))}`
        : this.times.text(this.cursor);
    }

    nearest(line, x) {
      const i = Math.max(before(line, x), 0);
      const next = Math.min(i + 1, line.x.length - 1);
      return !this.data.dense && line.x[next] - x < x - line.x[i] ? next : i;
    }

    // Discrete time has values at samples only.
    snapped(x) {
      const line = this.data.nodes[0].line, inside = Math.min(Math.max(x, this.data.start), this.data.end);
      return this.data.dense ? inside : line.x[this.nearest(line, inside)];
    }

    look(low, high) {
      const least = (this.limits[1] - this.limits[0]) * 1e-7;
      const width = Math.min(Math.max(high - low, least), this.limits[1] - this.limits[0]);
      const start = Math.min(Math.max(low, this.limits[0]), this.limits[1] - width);
      this.view = [start, start + width];
      this.draw();
    }

    all() { this.look(...this.limits); }

    zoom(factor, around) {
      const [low, high] = this.view, middle = around === undefined ? this.cursor ?? (low + high) / 2 : around;
      this.look(middle - (middle - low) * factor, middle + (high - middle) * factor);
    }

    pan(part) { const step = (this.view[1] - this.view[0]) * part; this.look(this.view[0] + step, this.view[1] + step); }

    // The next or the last sample, in dense time the next or the last change of any signal.
    step(direction) {
      const from = this.cursor ?? this.data.at;
      const places = (this.data.dense ? this.data.panels.flatMap((panel) => panel.lines) : [this.data.nodes[0].line])
        .flatMap((line) => line.x).filter((x) => (x - from) * direction > 0 && x >= this.data.start);
      if (places.length) this.cursor = places.reduce((a, b) => (Math.abs(a - from) < Math.abs(b - from) ? a : b));
      if (this.cursor !== null && (this.cursor < this.view[0] || this.cursor > this.view[1])) this.pan(direction / 2);
      this.point();
    }

    tools() {
      const bar = this.section.querySelector(".tools");
      bar.hidden = false;
      bar.setAttribute("role", "toolbar");
      bar.setAttribute("aria-label", "time");
      const actions = {
        "zoom in": () => this.zoom(0.5), "zoom out": () => this.zoom(2), "←": () => this.pan(-0.4), "→": () => this.pan(0.4),
        all: () => this.all(), "unfold all": () => this.fold(true), "fold all": () => this.fold(false),
      };
      const names = { "←": "earlier", "→": "later", all: "all of the time" };
      for (const [name, action] of Object.entries(actions)) {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = name;
        button.setAttribute("aria-label", names[name] || name);
        button.addEventListener("click", action);
        bar.append(button);
      }
      this.output = document.createElement("output");
      this.output.setAttribute("aria-live", "polite");
      bar.append(this.output);
      bar.title = "drag over a chart to zoom in, double-click for all; Ctrl and the wheel zoom; arrow keys step, + - 0 zoom";
      const keys = {
        ArrowLeft: () => this.step(-1), ArrowRight: () => this.step(1), "+": () => this.zoom(0.5), "-": () => this.zoom(2), 0: () => this.all(),
      };
      this.section.tabIndex = 0;
      this.section.addEventListener("keydown", (event) => {
        const action = event.ctrlKey || event.metaKey || event.altKey ? undefined : keys[event.key];
        if (action) { event.preventDefault(); action(); }
      });
    }

    fold(open) { this.section.querySelectorAll("details").forEach((fold, i) => { fold.open = open || i === 0; }); }

    link(link) {
      const { node, from, to } = link.dataset;
      link.href = `#card-${this.id}`;
      link.addEventListener("click", (event) => {
        event.preventDefault();
        const [low, high] = [Number(from), Number(to)];
        const line = this.data.nodes[0].line, span = this.data.end - this.data.start;
        const samples = this.data.dense ? 0 : (4 * span) / Math.max(line.points - 1, 1); // some beside one sample
        const margin = Math.max((high - low) * 0.5, samples, this.data.dense ? span * 0.04 : 0);
        let fold = this.section.querySelector(`details[data-node="${node}"]`);
        const target = fold;
        for (; fold; fold = fold.parentElement.closest("details")) fold.open = true;
        this.cursor = this.snapped(low);
        this.look(low - margin, high + margin);
        target.classList.add("flash");
        setTimeout(() => target.classList.remove("flash"), 1500);
        target.scrollIntoView({ block: "nearest" });
      });
    }
  }

  document.querySelectorAll(".card").forEach((section, i) => new Card(section, i + 1));
})();
