// One chart as SVG: lines, levels, intervals and the cursor over a common axis of time.

export const GUTTER = 56;
const RIGHT = 12, TOP = 8, BOTTOM = 6, AXIS = 20;
const SVG = "http://www.w3.org/2000/svg";

export const svg = (name, attributes = {}, text = null) => {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== null) made.textContent = text;
  return made;
};

// A number as short text, with a true minus.
export const number = (value, digits = 4) => {
  const known = Number(value);
  if (known === Infinity) return "∞";
  if (known === -Infinity) return "−∞";
  return String(Number(known.toPrecision(digits))).replace("-", "−").replace("e+", "e");
};

export const ticks = (low, high, most) => {
  const rough = (high - low) / Math.max(most, 1), base = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((each) => each * base).find((each) => each >= rough * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
};

// The range of finite values, with a margin.
export const valueRange = (values) => {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (!(low <= high)) return [-1, 1];
  const pad = (high - low) * 0.12 || Math.max(Math.abs(high) * 0.2, 1);
  return [low - pad, high + pad];
};

// Enough digits to distinguish neighbouring ticks.
const digitsOf = (times) => {
  const [low, high] = [times[0], times.at(-1)], step = (high - low) / Math.max(times.length - 1, 1);
  return Math.min(Math.max(Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high)) / (step || 1))) + 2, 6), 15);
};

// The points of a line in a part of the time, with the one before it and the one after it.
export const visibleRange = (x, [from, to]) => {
  const first = Math.max(x.findIndex((each) => each >= from) - 1, 0), last = x.findLastIndex((each) => each <= to) + 2;
  return x.length && x[x.length - 1] < from ? [x.length - 1, x.length] : [first, last];
};

let charts = 0;

export class Chart {
  // `options`: height, label, axis (whether there are times under it).
  constructor(host, { height, label, axis = false }) {
    this.host = host;
    this.height = height + (axis ? AXIS : 0);
    this.axis = axis;
    this.svg = svg("svg", { class: "chart", height: this.height, role: "group", "aria-label": label });
    this.layers = {};
    this.hole = svg("rect", { y: 0, height: this.height });
    const clip = svg("clipPath", { id: `clip-${++charts}` });
    clip.append(this.hole);
    this.svg.append(clip);
    for (const name of ["grid", "under", "lines", "over", "handles"]) {
      this.layers[name] = svg("g", { class: name });
      this.svg.append(this.layers[name]);
    }
    for (const name of ["under", "lines"]) this.layers[name].setAttribute("clip-path", `url(#${clip.id})`);
    this.cursor = svg("line", { class: "cursor" });
    this.layers.over.before(this.cursor);
    host.append(this.svg);
    this.times = [0, 1];
    this.values = [0, 1];
    this.measure();
  }

  // Take the width of the place; reading it while charts are drawn would lay out the page for each of them.
  measure() {
    this.width = Math.max(this.host.clientWidth, 160);
    this.plot = { left: GUTTER, right: this.width - RIGHT, top: TOP, bottom: this.height - BOTTOM - (this.axis ? AXIS : 0) };
    this.svg.setAttribute("width", this.width);
    for (const [key, value] of Object.entries({ x: this.plot.left - 1, width: this.plot.right - this.plot.left + 2 })) this.hole.setAttribute(key, value);
  }

  x(time) {
    const { left, right } = this.plot, [from, to] = this.times;
    return left + ((time - from) / (to - from || 1)) * (right - left);
  }

  y(value) {
    const { top, bottom } = this.plot, [low, high] = this.values;
    const place = bottom - ((value - low) / (high - low || 1)) * (bottom - top);
    return Math.min(Math.max(place, top - 6), bottom + 6); // infinities are at the edges
  }

  timeAt(clientX) {
    const { left, right } = this.plot, [from, to] = this.times;
    const part = (clientX - this.svg.getBoundingClientRect().left - left) / (right - left);
    return from + Math.min(Math.max(part, 0), 1) * (to - from);
  }

  valueAt(clientY) {
    const { top, bottom } = this.plot, [low, high] = this.values;
    return low + ((bottom - (clientY - this.svg.getBoundingClientRect().top)) / (bottom - top)) * (high - low);
  }

  // Begin a drawing: the grid of times and values.
  frame(times, values, names = true) {
    Object.assign(this, { times, values });
    for (const layer of ["grid", "under", "lines", "over", "handles"]) this.layers[layer].replaceChildren();
    const { left, right, top, bottom } = this.plot, { grid } = this.layers;
    const marks = ticks(...times, (right - left) / 90), digits = marks.length ? digitsOf(marks) : 6;
    for (const time of marks) {
      const x = this.x(time);
      grid.append(svg("line", { x1: x, x2: x, y1: top, y2: bottom }));
      if (this.axis) grid.append(svg("text", { x, y: bottom + 16, class: "time" }, number(time, digits)));
    }
    if (names) {
      for (const value of ticks(...values, (bottom - top) / 20)) {
        const y = this.y(value);
        grid.append(svg("line", { x1: left, x2: right, y1: y, y2: y }), svg("text", { x: left - 8, y: y + 4, class: "value" }, number(value)));
      }
    }
  }

  // Lines; `held`: values hold until the next point.
  path(x, y, held) {
    let d = "";
    for (let i = 0; i < x.length; i++) {
      const px = this.x(x[i]).toFixed(1), py = this.y(Number(y[i])).toFixed(1);
      d += i === 0 ? `M${px} ${py}` : held ? `H${px}V${py}` : `L${px} ${py}`;
    }
    return d;
  }

  line(x, y, { held = false, dots = false, kind = "line" } = {}) {
    this.layers.lines.append(svg("path", { d: this.path(x, y, held), class: kind }));
    if (!dots || x.length > this.width / 8) return;
    for (let i = 0; i < x.length; i++) this.layers.lines.append(svg("circle", { cx: this.x(x[i]), cy: this.y(Number(y[i])), r: 2, class: "dot" }));
  }

  // What is between two lines over the same times, both held.
  area(x, low, high, kind) {
    let back = "";
    for (let i = x.length - 1; i >= 0; i--) {
      const y = this.y(Number(low[i])).toFixed(1);
      back += `V${y}H${this.x(x[i]).toFixed(1)}`;
    }
    this.layers.under.append(svg("path", { d: `${this.path(x, high, true)}${back}Z`, class: kind }));
  }

  level(value, kind = "level") {
    const { left, right } = this.plot, y = this.y(value);
    this.layers.under.append(svg("line", { x1: left, x2: right, y1: y, y2: y, class: kind }));
  }

  band(from, to, kind, top = this.plot.top, bottom = this.plot.bottom) {
    const x = this.x(from);
    this.layers.under.append(svg("rect", { x, y: top, width: Math.max(Math.min(this.x(to), this.plot.right) - x, 1.5), height: bottom - top, class: kind }));
  }

  // Whether a time is in view.
  has(time) { return this.times[0] <= time && time <= this.times[1]; }

  point(time) {
    const { top, bottom } = this.plot, shown = time !== null && this.has(time);
    this.cursor.classList.toggle("shown", shown);
    if (!shown) return;
    const x = this.x(time);
    for (const [key, value] of Object.entries({ x1: x, x2: x, y1: top, y2: bottom })) this.cursor.setAttribute(key, value);
  }
}
