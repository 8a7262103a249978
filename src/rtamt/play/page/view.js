// The part of the time that all charts show, and how it is changed: buttons, keys, the wheel, and two fingers.

import { number } from "./chart.js";

const $ = (id) => document.getElementById(id);
const CLOSEST = 1e-6; // of the whole time
const WHEEL = 400; // pixels of the wheel that halve the visible time span

// A time without digits that do not matter in a view of this length.
const rounded = (time, length) => {
  const step = 10 ** Math.floor(Math.log10(length / 200));
  return Math.round(time / step) * step;
};

export class View {
  // `page`: whole(), the begin and the end of all of the time; at(), the cursor; viewed(), after a change.
  constructor(page) {
    this.page = page;
    this.part = null; // [begin, end]; null for all of it
    const actions = { "zoom-in": () => this.zoom(0.5), "zoom-out": () => this.zoom(2), earlier: () => this.pan(-0.5), later: () => this.pan(0.5), everything: () => this.all() };
    for (const [id, action] of Object.entries(actions)) $(id).addEventListener("click", action);
    this.keys($("at"));
  }

  get times() { return this.part ?? this.page.whole(); }

  // Whether data for a part of the time covers the visible part.
  has(near) { return Boolean(this.part && near && near.view[0] <= this.part[0] && this.part[1] <= near.view[1]); }

  // Around a time, by default the cursor, or the middle if the cursor is not in view.
  zoom(factor, around = this.page.at()) {
    const [from, to] = this.times, at = around !== null && from <= around && around <= to ? around : (from + to) / 2;
    this.show(at + (from - at) * factor, at + (to - at) * factor);
  }

  pan(share) {
    const [from, to] = this.times, way = (to - from) * share;
    this.show(from + way, to + way);
  }

  all() { this.show(...this.page.whole()); }

  // Move the view so that a time is in it.
  reveal(at) {
    const [from, to] = this.times;
    if (this.part && at !== null && (at < from || at > to)) this.show(at - (to - from) / 2, at + (to - from) / 2);
  }

  // Show a part of the time, as near to what is asked as there is time.
  show(from, to) {
    const [start, end] = this.page.whole(), least = Math.max((end - start) * CLOSEST, Math.abs(end) * 1e-9);
    const length = Math.min(Math.max(to - from, least), end - start);
    const begin = Math.min(Math.max((from + to - length) / 2, start), end - length);
    this.part = length < end - start ? [begin, begin + length] : null;
    this.showRange();
    this.page.viewed();
  }

  // Set the visible part without a request.
  take(part) { this.part = part; this.showRange(); }

  // Keep the part that the whole time still has.
  fit() {
    const [start, end] = this.page.whole();
    if (this.part && (this.part[0] < start || this.part[1] > end)) this.show(...this.part);
  }

  showRange() {
    const { part } = this;
    $("seen").textContent = part ? part.map((time) => `${number(rounded(time, part[1] - part[0]), 12)} s`).join(" to ") : "";
    for (const id of ["zoom-out", "earlier", "later", "everything"]) $(id).disabled = !part;
  }

  // ---- keys and gestures over a chart

  keys(element) {
    const act = { "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), 0: () => this.all(), "[": () => this.pan(-0.25), "]": () => this.pan(0.25) };
    element.addEventListener("keydown", (event) => {
      if (!(event.key in act) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act[event.key]();
    });
  }

  // `interrupted`: ends what one finger has begun when a second one comes.
  listen(chart, interrupted) {
    const { svg } = chart, fingers = new Map();
    let held = null; // the times under the fingers, or under the pointer that drags the view
    this.keys(svg);
    svg.addEventListener("wheel", (event) => {
      if (event.ctrlKey || event.metaKey) {
        event.preventDefault();
        this.zoom(2 ** (event.deltaY / WHEEL), chart.timeAt(event.clientX));
      } else if (this.part && (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY))) {
        event.preventDefault();
        this.pan((event.deltaX || event.deltaY) / chart.width);
      }
    }, { passive: false });
    const down = (event) => {
      fingers.set(event.pointerId, event.clientX);
      if (fingers.size !== 2 && !(event.shiftKey && event.button === 0)) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      interrupted();
      for (const id of fingers.keys()) svg.setPointerCapture(id);
      held = [...fingers].map(([id, x]) => [id, chart.timeAt(x)]);
    };
    const move = (event) => {
      if (!fingers.has(event.pointerId)) return;
      fingers.set(event.pointerId, event.clientX);
      if (!held) return;
      event.stopImmediatePropagation();
      const [left, right] = this.pulled(chart, held.map(([id, time]) => [fingers.get(id), time]));
      this.show(left, right);
    };
    const up = (event) => {
      fingers.delete(event.pointerId);
      if (held) event.stopImmediatePropagation();
      if (!fingers.size) held = null;
      else if (held) held = [...fingers].map(([id, x]) => [id, chart.timeAt(x)]);
    };
    svg.addEventListener("pointerdown", down, { capture: true });
    svg.addEventListener("pointermove", move, { capture: true });
    for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, up, { capture: true });
  }

  // The view in which each time is under its finger; one finger moves the view, two also zoom.
  pulled(chart, fingers) {
    const { left, right } = chart.plot, edge = chart.svg.getBoundingClientRect().left + left, width = right - left;
    const [from, to] = this.times, shares = fingers.map(([x]) => (x - edge) / width), at = fingers.map(([, time]) => time);
    let length = to - from;
    if (fingers.length > 1 && Math.abs(shares[1] - shares[0]) > 0.01) length = Math.abs((at[1] - at[0]) / (shares[1] - shares[0]));
    const begin = at[0] - shares[0] * length;
    return [begin, begin + length];
  }
}
