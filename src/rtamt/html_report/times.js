// Numbers and positions as text, ticks of axes, and the time that all cards of one trace share.

const number = (value) => {
  if (Math.abs(value) === Infinity) return value > 0 ? "+∞" : "−∞";
  return String(Number(value.toPrecision(6))).replace("-", "−");
};

// 1, 2 or 5 (or another of `factors`) times a power of ten, so that about `count` of them fit.
const niceStep = (span, count, factors = [1, 2, 5]) => {
  const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
  return power * (factors.find((factor) => factor * power >= raw * (1 - 1e-9)) || 10);
};

const ticks = (low, high, step) => {
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; i++) found.push(Number((i * step).toPrecision(12)));
  return found;
};

// About three ticks of values, but at least two: a single one would show no scale.
const valueTicks = (low, high) => {
  const few = ticks(low, high, niceStep(high - low, 3));
  return few.length > 1 ? few : ticks(low, high, niceStep(high - low, 4, [1, 2, 2.5, 5]));
};

const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400];

class Times {
  constructor({ origin, dated }) { this.origin = origin; this.dated = dated; }

  // A position as text: a date and the seconds since the start, or seconds.
  text(x) {
    // Positions of dates are differences of large numbers: what follows the microseconds is rounding.
    const seconds = String(Number(this.dated ? x.toFixed(6) : x.toPrecision(12))).replace("-", "−");
    if (!this.dated) return this.origin ? `${this.origin} + ${seconds} s` : `${seconds} s`;
    const iso = new Date(this.origin + x * 1000).toISOString();
    return `${iso.replace("T", " ").replace(/\.?0*Z$/, "")} (+${seconds} s)`;
  }

  get label() {
    if (this.dated) return `UTC, ${new Date(this.origin).toISOString().slice(0, 10)}`;
    return this.origin ? `seconds after ${this.origin} s` : "seconds";
  }

  ticks(low, high, count) {
    let step = niceStep(high - low, count);
    if (!this.dated || step < 1) return ticks(low, high, step);
    step = SECONDS.find((s) => s >= (high - low) / count) || Math.ceil((high - low) / count / 86400) * 86400;
    const offset = (this.origin / 1000) % step;
    return ticks(low + offset, high + offset, step).map((t) => t - offset);
  }

  labels(places) {
    const step = places.length > 1 ? places[1] - places[0] : 1;
    if (!this.dated) return places.map((x) => String(Number(x.toPrecision(10))).replace("-", "−"));
    return places.map((x) => {
      const iso = new Date(Math.round((this.origin + x * 1000) * 1000) / 1000).toISOString();
      if (step >= 86400) return iso.slice(0, 10);
      if (step >= 60) return iso.slice(11, 16);
      return step >= 1 ? iso.slice(11, 19) : `${iso.slice(14, 19)}${(x + this.origin / 1000).toFixed(6).replace(/^[^.]*|\.?0+$/g, "")}`;
    });
  }
}

// What is seen of one trace (view), and what is pointed at (cursor, and the marks A and B), in all of its cards.
class Timeline {
  constructor(data) {
    this.times = new Times(data);
    this.start = data.start;
    this.end = data.end;
    this.cards = new Set();
    this.cursor = null;
    this.marks = [null, null];
    this.view = [...this.limits];
  }

  get limits() {
    const margin = 0.01 * (this.end - this.start) || 0.5;
    return [this.start - margin, this.end + margin];
  }

  join(card) {
    const all = this.view.every((end, i) => end === this.limits[i]);
    this.start = Math.min(this.start, card.data.start);
    this.end = Math.max(this.end, card.data.end);
    if (all) this.view = [...this.limits];
    this.cards.add(card);
  }

  look(low, high, alone = false) {
    const [first, last] = this.limits, most = last - first;
    const width = Math.min(Math.max(high - low, most * 1e-8), most);
    const start = Math.min(Math.max(low, first), last - width);
    this.view = [start, start + width];
    this.cards.forEach((card) => card.draw());
    Timeline.changed();
    if (alone || !Timeline.synchronised) return;
    for (const other of Timeline.all.values()) {
      if (other !== this) other.look(low - this.start + other.start, high - this.start + other.start, true);
    }
  }

  everything() { this.look(...this.limits); }

  zoom(factor, around) {
    const [low, high] = this.view, middle = around ?? this.cursor ?? (low + high) / 2;
    this.look(middle - (middle - low) * factor, middle + (high - middle) * factor);
  }

  pan(part) { const step = (this.view[1] - this.view[0]) * part; this.look(this.view[0] + step, this.view[1] + step); }

  point(cursor) {
    this.cursor = cursor;
    this.cards.forEach((card) => card.point());
    Timeline.changed();
  }

  mark(which, position) {
    this.marks[which] = position;
    this.cards.forEach((card) => { card.draw(); card.point(); });
  }

  static of(data) {
    const key = `${data.trace} ${data.origin} ${data.dated}`;
    if (!Timeline.all.has(key)) Timeline.all.set(key, new Timeline(data));
    return Timeline.all.get(key);
  }
}
Timeline.all = new Map();
Timeline.synchronised = true;
Timeline.changed = () => {}; // what is seen or pointed at
