// A signal that is drawn: its points are dragged, added and removed, by pointer and by keys.

import { Chart, number, valueRange, svg } from "./chart.js";

const HANDLES = 80; // more points have no handles
const NEAR = 14; // pixels

const tidy = (value, digits = 4) => Number(Number(value).toPrecision(digits));

// Points of a shape over a time from 0 to `end`, between two values.
export const SHAPES = {
  step: (end, low, high) => ({ hold: true, points: [[0, low], [end / 3, high], [(2 * end) / 3, low]] }),
  ramp: (end, low, high) => ({ hold: false, points: [[0, low], [end, high]] }),
  sine: (end, low, high) => ({
    hold: false,
    points: Array.from({ length: 33 }, (_, k) => [(end * k) / 32, tidy((low + high) / 2 + ((high - low) / 2) * Math.sin((k / 32) * 4 * Math.PI))]),
  }),
};

export class Signal {
  // `page`: duration, period, times, cursor(), model(name), change(name, model, final) and view.
  constructor(name, host, page) {
    Object.assign(this, { name, host, page, chosen: 0, levels: [], because: [], drag: null });
    this.build();
  }

  build() {
    const head = document.createElement("div"), title = document.createElement("h3"), space = document.createElement("span");
    head.className = "signal-head";
    title.textContent = this.name;
    space.className = "spacer";
    head.append(title, space);
    for (const shape of Object.keys(SHAPES)) head.append(this.button(shape, `${shape}: replace ${this.name} by a ${shape}`, () => this.reshape(shape)));
    this.holding = this.button("", "", () => this.toggle());
    head.append(this.holding);
    this.place = document.createElement("div");
    this.host.append(head, this.place);
    this.chart = new Chart(this.place, { height: 96, label: `Signal ${this.name}` });
    const { svg: root } = this.chart;
    root.classList.add("drawn");
    root.setAttribute("tabindex", -1);
    this.page.view.listen(this.chart, () => this.cancel());
    root.addEventListener("pointerdown", (event) => this.down(event));
    root.addEventListener("pointermove", (event) => this.move(event));
    root.addEventListener("pointerup", () => this.up());
    root.addEventListener("pointercancel", () => this.up());
    root.addEventListener("keydown", (event) => this.key(event));
  }

  button(text, label, action) {
    const made = document.createElement("button");
    made.type = "button";
    made.className = "small";
    made.textContent = text;
    made.setAttribute("aria-label", label);
    made.addEventListener("click", action);
    return made;
  }

  get model() { return this.page.model(this.name); }

  get grain() { return this.page.period; }

  // ---- drawing

  draw() {
    const { points, hold } = this.model, end = this.page.duration, { chart } = this;
    const focused = chart.svg.contains(document.activeElement);
    this.holding.textContent = hold ? "held" : "lines";
    this.holding.setAttribute("aria-label", `${this.holding.textContent}: how values of ${this.name} continue between points`);
    if (!this.drag) this.range = valueRange([...points.map((point) => point[1]), ...this.levels, ...(points.length === 1 ? [0] : [])]);
    chart.frame(this.page.times, this.range);
    for (const [from, to] of this.because) chart.band(from, to, "because");
    for (const level of this.levels) chart.level(level);
    const first = points[0], last = points[points.length - 1];
    const shown = [...(first[0] > 0 ? [[0, first[1]]] : []), ...points.filter(([time]) => time <= end), ...(last[0] < end ? [[end, last[1]]] : [])];
    chart.line(shown.map(([time]) => time), shown.map(([, value]) => value), { held: hold });
    chart.point(this.page.cursor());
    this.handles(points);
    if (focused) this.focus();
  }

  // Whether points are few enough in view to be dragged.
  get few() { return this.model.points.filter(([time]) => this.chart.has(time)).length <= HANDLES; }

  handles(points) {
    this.chosen = Math.min(this.chosen, points.length - 1);
    if (!this.few) return;
    const shown = points.map((_, index) => index).filter((index) => points[index][0] <= this.page.duration && this.chart.has(points[index][0]));
    if (!shown.includes(this.chosen)) this.chosen = shown[0] ?? this.chosen; // what keys change is in view
    shown.forEach((index) => {
      const [time, value] = points[index];
      const handle = svg("circle", {
        cx: this.chart.x(time), cy: this.chart.y(value), r: 5, class: "handle", "data-index": index,
        tabindex: index === this.chosen ? 0 : -1, role: "slider",
        "aria-label": `${this.name}, point ${index + 1} of ${points.length}`,
        "aria-valuenow": value, "aria-valuetext": `${number(value)} at ${number(time, 6)} s`,
      });
      this.chart.layers.handles.append(handle);
    });
  }

  // Without a point in view, the chart itself keeps the focus and so the keys that zoom.
  focus() {
    const { svg: root, layers } = this.chart;
    (layers.handles.querySelector(`[data-index="${this.chosen}"]`) ?? root).focus({ preventScroll: true });
  }

  // ---- changes

  change(points, { hold = this.model.hold, final = true } = {}) {
    this.page.change(this.name, { points, hold }, final);
    this.draw();
  }

  snapped(time) {
    const grain = this.grain || this.page.duration / 200;
    return tidy(Math.min(Math.max(Math.round(time / grain) * grain, 0), this.page.duration), 12);
  }

  // A value rounded to visible steps.
  rounded(value) {
    const step = 10 ** Math.floor(Math.log10((this.range[1] - this.range[0]) / 100));
    return tidy(Math.round(value / step) * step, 10);
  }

  moved(index, time, value, final) {
    const points = this.model.points.map((point) => [...point]);
    const lowest = index > 0 ? points[index - 1][0] : -Infinity, highest = index + 1 < points.length ? points[index + 1][0] : Infinity;
    if (index === 0 && points[0][0] === 0) time = 0; // where the signal begins
    if (time > lowest && time < highest) points[index][0] = time;
    points[index][1] = value;
    this.change(points, { final });
  }

  // Set a point at a time; return its number.
  put(time, value, final) {
    const points = this.model.points.map((point) => [...point]);
    let index = points.findIndex((point) => point[0] >= time - 1e-12);
    if (index < 0) index = points.length;
    if (index < points.length && Math.abs(points[index][0] - time) < 1e-9) points[index][1] = value;
    else points.splice(index, 0, [time, value]);
    this.chosen = index;
    this.change(points, { final });
    return index;
  }

  remove(index) {
    const { points } = this.model;
    if (points.length === 1) return;
    this.chosen = Math.max(index - 1, 0);
    this.change(points.filter((_, each) => each !== index));
    this.focus();
  }

  reshape(shape) {
    const values = this.model.points.map((point) => point[1]).concat(this.levels);
    let low = Math.min(...values), high = Math.max(...values);
    if (this.levels.length) { low = Math.min(low, this.levels[0] - 2); high = Math.max(high, this.levels[0] + 2); }
    if (low === high) high = low + 1;
    const made = SHAPES[shape](this.page.duration, tidy(low), tidy(high));
    const points = made.points.map(([time, value]) => [this.snapped(time), value]);
    this.chosen = 0;
    this.change(points.filter((point, k) => k === 0 || point[0] > points[k - 1][0]), { hold: made.hold });
  }

  toggle() { this.change(this.model.points, { hold: !this.model.hold }); }

  // ---- the pointer

  down(event) {
    if (event.button !== 0) return;
    const box = this.chart.svg.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    const { points } = this.model;
    let near = -1, least = NEAR;
    if (this.few) {
      points.forEach(([time, value], index) => {
        if (!this.chart.has(time)) return;
        const distance = Math.hypot(this.chart.x(time) - x, this.chart.y(value) - y);
        if (distance < least) { near = index; least = distance; }
      });
    }
    if (near < 0 && x < this.chart.plot.left - NEAR) return;
    event.preventDefault();
    this.chart.svg.setPointerCapture(event.pointerId);
    this.drag = { index: near, last: null, before: this.model };
    if (near < 0) this.pencil(event);
    else this.chosen = near;
    this.focus();
  }

  move(event) {
    if (!this.drag) return;
    if (this.drag.index < 0) { this.pencil(event); return; }
    this.moved(this.drag.index, this.snapped(this.chart.timeAt(event.clientX)), this.rounded(this.chart.valueAt(event.clientY)), false);
    this.focus();
  }

  // Draw over the chart: what lies between the last place and this one is replaced.
  pencil(event) {
    const time = this.snapped(this.chart.timeAt(event.clientX)), value = this.rounded(this.chart.valueAt(event.clientY));
    const { last } = this.drag;
    if (last !== null && last !== time) {
      const [from, to] = [Math.min(last, time), Math.max(last, time)];
      const kept = this.model.points.filter(([each]) => each <= from || each >= to || each === 0);
      if (kept.length < this.model.points.length) this.change(kept, { final: false });
    }
    this.put(time, value, false);
    this.drag.last = time;
  }

  up() {
    if (!this.drag) return;
    this.drag = null;
    this.change(this.model.points);
    this.focus();
  }

  // What a first finger has drawn is undone when a second one comes.
  cancel() {
    if (!this.drag) return;
    const { before } = this.drag;
    this.drag = null;
    this.change(before.points, { hold: before.hold });
  }

  // ---- keys

  key(event) {
    const { points } = this.model, index = this.chosen, [time, value] = points[index];
    const step = this.rounded((this.range[1] - this.range[0]) / 40) || 0.01, grain = this.grain || this.page.duration / 100;
    const act = {
      ArrowUp: () => this.moved(index, time, this.rounded(value + step), true),
      ArrowDown: () => this.moved(index, time, this.rounded(value - step), true),
      ArrowLeft: () => (event.shiftKey ? this.moved(index, this.snapped(time - grain), value, true) : this.choose(index - 1)),
      ArrowRight: () => (event.shiftKey ? this.moved(index, this.snapped(time + grain), value, true) : this.choose(index + 1)),
      Home: () => this.choose(0),
      End: () => this.choose(points.length - 1),
      Insert: () => this.between(index),
      Delete: () => this.remove(index),
      Backspace: () => this.remove(index),
    }[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target === this.chart.svg && !/^(Arrow(Left|Right)|Home|End)$/.test(event.key)) return; // no point is in view
    event.preventDefault();
    act();
    this.focus();
  }

  choose(index) {
    this.chosen = Math.min(Math.max(index, 0), this.model.points.length - 1);
    this.page.view.reveal(this.model.points[this.chosen][0]);
    this.draw();
  }

  between(index) {
    const { points } = this.model, [time, value] = points[index];
    const next = index + 1 < points.length ? points[index + 1][0] : this.page.duration;
    const middle = this.snapped((time + next) / 2);
    if (middle > time && middle < next) this.put(middle, value, true);
  }
}
