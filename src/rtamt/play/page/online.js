// Robustness over time, and the state of an online monitor while samples arrive.

import { Chart, number, svg, valueRange, visibleRange } from "./chart.js";

const $ = (id) => document.getElementById(id);
const STEPS = 1000;
const LASTS = 8000; // milliseconds in which a recording is played

export class Timeline {
  // `page`: moved(at), at(), drawn() and view.
  constructor(page) {
    this.page = page;
    this.values = new Chart($("robustness"), { height: 110, label: "Robustness of the formula over time" });
    this.strip = new Chart($("online"), { height: 34, label: "Verdict of each instant" });
    this.bounds = new Chart($("online"), { height: 110, label: "Bounds of the robustness at the start", axis: true });
    // The last evaluation; the replay and its visible part; and the state of the monitor at the cursor.
    this.answer = this.found = this.near = this.cursorState = null;
    for (const chart of [this.values, this.strip, this.bounds]) this.listen(chart);
    $("at").addEventListener("input", () => { this.stop(); this.move(this.timeOf($("at").value / STEPS)); });
    $("play").addEventListener("click", () => (this.playing ? this.stop() : this.start()));
  }

  // Dragging over a chart moves the cursor.
  listen(chart) {
    let pressed = false;
    const move = (event) => { if (pressed) { this.stop(); this.move(chart.timeAt(event.clientX)); } };
    chart.svg.classList.add("moving");
    this.page.view.listen(chart, () => { pressed = false; });
    chart.svg.addEventListener("pointerdown", (event) => { pressed = true; chart.svg.setPointerCapture(event.pointerId); move(event); });
    chart.svg.addEventListener("pointermove", move);
    for (const end of ["pointerup", "pointercancel"]) chart.svg.addEventListener(end, () => { pressed = false; });
  }

  timeOf(part) {
    if (!this.answer || part >= 1) return null; // all of it
    const { start, end } = this.answer.clock;
    return start + part * (end - start);
  }

  move(at) {
    this.cursorState = null;
    const end = this.answer?.clock.end;
    this.page.moved(at === null || at >= end ? null : at);
  }

  start() {
    if (!this.answer) return;
    const { start, end } = this.answer.clock, from = this.page.at() ?? start, begun = performance.now();
    this.playing = true;
    this.label();
    const step = (now) => {
      if (!this.playing) return;
      const at = from + ((now - begun) / LASTS) * (end - start);
      this.move(at);
      if (at >= end) this.stop();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() { this.playing = false; this.label(); }

  label() {
    $("play").textContent = this.playing ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  // ---- answers

  evaluated(answer) { this.answer = answer; this.cursorState = null; this.draw(); }

  replayed(found) { this.found = found; this.near = null; this.drawOnline(); this.updateStatus(); }

  redrawn(found) { this.near = found.error ? null : found.near; this.drawOnline(); }

  known(found, at) { this.cursorState = found.error ? null : { ...found, at }; this.drawOnline(); this.updateStatus(); }

  // ---- drawing

  get times() { return this.page.view.times; }

  measure() { for (const chart of [this.values, this.strip, this.bounds]) chart.measure(); }

  draw() {
    if (!this.answer) return;
    const { robustness, upper, fails } = this.page.drawn(), { explanation } = this.answer, { values } = this;
    const part = visibleRange(robustness.x, this.times);
    values.frame(this.times, valueRange([...robustness.y.slice(...part), ...(upper ? upper.y.slice(...part) : []), 0].map(Number)));
    for (const [from, to] of fails) values.band(from, to, "fails");
    values.level(0, "zero");
    if (upper) values.area(robustness.x, robustness.y, upper.y, "known");
    values.line(robustness.x, robustness.y, { held: true, kind: "value-line" });
    if (explanation?.critical !== null && explanation) this.diamond(values, explanation.critical, robustness);
    this.drawOnline();
  }

  diamond(chart, time, { x: times, y: values }) {
    if (!chart.has(time)) return;
    const last = Math.max(times.findLastIndex((each) => each <= time), 0);
    const x = chart.x(time), y = chart.y(Number(values[last]));
    chart.layers.over.append(svg("path", { d: `M${x} ${y - 5}l5 5l-5 5l-5 -5Z`, class: "critical" }));
  }

  drawOnline() {
    if (!this.answer) return;
    const { found, strip, bounds } = this, { end } = this.answer.clock, now = this.page.at() ?? Infinity;
    strip.frame(this.times, [0, 1], false);
    if (!found || found.error) {
      bounds.frame(this.times, [-1, 1], false);
      this.point();
      return;
    }
    $("watched").textContent = found.formula;
    const [first, last] = this.times, shown = this.page.view.has(this.near) ? this.near : found;
    for (const [from, to, good, decided] of shown.runs) {
      if (to < first || from > last) continue;
      if (from > now) { strip.band(from, Math.min(to, end), "run-later"); continue; }
      const open = decided === null ? now < end : decided > now;
      strip.band(from, Math.min(to, end), open ? "run-open" : good ? "run-good" : "run-bad");
    }
    this.drawBounds(shown.bounds, now);
    this.point();
  }

  drawBounds({ x, lower, upper }, now) {
    const { bounds } = this;
    const until = x.findLastIndex((each) => each <= now) + 1;
    const low = lower.slice(0, until), high = upper.slice(0, until);
    const waiting = (this.cursorState?.pending || []).filter(([time]) => bounds.has(time)), part = visibleRange(x, this.times);
    bounds.frame(this.times, valueRange([...lower.slice(...part), ...upper.slice(...part), ...waiting.flatMap(([, a, b]) => [a, b]), 0].map(Number)));
    bounds.level(0, "zero");
    if (until > 0) bounds.area(x.slice(0, until), low, high, "known");
    for (const [time, a, b] of waiting) {
      const at = bounds.x(time);
      bounds.layers.over.append(svg("line", { x1: at, x2: at, y1: bounds.y(Number(a)), y2: bounds.y(Number(b)), class: "whisker" }));
    }
  }

  point() {
    if (!this.answer) return;
    const at = this.page.at(), { start, end } = this.answer.clock;
    for (const chart of [this.values, this.strip, this.bounds]) chart.point(at);
    $("at").value = at === null ? STEPS : Math.round(((at - start) / (end - start || 1)) * STEPS);
    this.updateStatus();
  }

  // What is known now, in words.
  updateStatus() {
    const { found } = this;
    if (!found) return;
    if (found.error) { $("now").textContent = found.error.message; $("watched").textContent = ""; return; }
    const at = this.page.at(), { end } = this.answer.clock, now = at ?? end;
    const { x, lower, upper, decided } = found.bounds, last = x.findLastIndex((each) => each <= now);
    // Of long recordings, the replay has some of the samples, and this moment is exact.
    const exact = this.cursorState?.at === at ? this.cursorState : null;
    const known = exact ? exact.bounds : last < 0 ? null : [lower[last], upper[last]];
    const open = exact ? exact.open : found.runs.filter(([from, , , settled]) => from <= now && now < (settled ?? end)).length;
    const between = known === null ? "nothing is known" : known[0] === known[1] ? `robustness ${number(known[0])}` : `robustness between ${number(known[0])} and ${number(known[1])}`;
    const settled = decided !== null && decided <= now ? `decided at ${number(decided, 6)} s` : at === null ? "decided by the end of the trace" : "not decided yet";
    const text = at === null
      ? `All samples: robustness ${number(this.answer.interval[0])}, ${settled}`
      : `After ${number(now, 6)} s: ${between}, ${settled}, ${open} pending`;
    $("now").textContent = text;
    $("at").setAttribute("aria-valuetext", text);
  }
}
