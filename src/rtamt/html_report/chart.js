// One chart: lines over time in a canvas of uPlot, with intervals, thresholds, the critical point and the cursors.

const AXIS = 64;
const COLORS = 6;
const NAMES = 6; // of values at an axis
const LONGEST = 10; // characters of one

// Those of increasing values that are far enough from the one before.
const apart = (values, distance) => values.reduce((found, value) => {
  if (!found.length || value - found[found.length - 1] >= distance) found.push(value);
  return found;
}, []);

const palette = () => {
  const style = getComputedStyle(document.documentElement);
  return (name) => style.getPropertyValue(`--${name}`).trim();
};

class Chart {
  // `options`: lines, height, levels (numbers to draw), because and fails (flat intervals), node (of a robustness).
  constructor(card, host, options) {
    Object.assign(this, { card, host, ...options });
    this.timeline = card.timeline;
    this.robustness = this.node !== undefined;
    this.values = null; // the vertical zoom
    this.plot = null;
    this.legend = new Legend(this);
  }

  get visible() { return this.host.offsetParent !== null; }

  color(index) { return this.robustness && index === 0 ? "ink" : `s${(this.robustness ? index - 1 : index) % COLORS}`; }

  // Finite values in the middle, infinities at the edges, where there are any.
  bounds() {
    const shown = this.lines.filter((line) => line.shown);
    const finite = shown.flatMap(({ data }) => [data.low, data.high].filter((value) => value !== null)).concat(this.levels);
    let low = Math.min(...finite), high = Math.max(...finite);
    if (!(low < high)) { const middle = Number.isFinite(low) ? low : 0; low = middle - 1; high = middle + 1; }
    const pad = (high - low) * 0.08;
    this.finite = [low, high];
    this.edges = [low - 3 * pad, high + 3 * pad];
    this.infinite = [0, 1].map((end) => shown.some((line) => line.data.ends[end]));
    return [low - (this.infinite[0] ? 4 : 1) * pad, high + (this.infinite[1] ? 4 : 1) * pad];
  }

  clipped(value) { return Math.min(Math.max(value, this.edges[0]), this.edges[1]); }

  // What each line shows of the present view, in columns of device pixels.
  look() {
    const [from, to] = this.timeline.view;
    const columns = Math.max(this.width - AXIS, 100) * devicePixelRatio;
    this.seen = this.lines.map((line) => (line.shown ? line.seen(from, to, columns) : { kind: "samples", x: [], y: [] }));
    const tables = this.seen.map(({ x, y }) => [x, y.map((value) => this.clipped(value))]);
    return tables.length === 1 ? tables[0] : uPlot.join(tables);
  }

  draw() {
    if (!this.visible) return;
    const width = Math.max(this.host.clientWidth, 300);
    if (this.plot && width !== this.width) this.drop();
    this.width = width;
    const range = this.bounds();
    const data = this.look();
    this.silent = true; // a new plot points at nothing
    if (!this.plot) this.make(data);
    const fitted = this.card.fitted ? this.fit() : range;
    this.plot.batch(() => {
      this.plot.setData(data, false);
      this.plot.setScale("x", { min: this.timeline.view[0], max: this.timeline.view[1] });
      const [min, max] = this.values || fitted;
      this.plot.setScale("y", { min, max });
    });
    this.host.setAttribute("aria-label", this.summary());
    this.legend.note(this.seen);
    this.point();
  }

  // The values that are seen.
  fit() {
    let low = Infinity, high = -Infinity;
    this.seen.forEach((part, i) => {
      const line = this.lines[i];
      const values = part.kind === "ranges" ? [...line.lows.subarray(part.first, part.last + 1), ...line.highs.subarray(part.first, part.last + 1)] : part.y;
      for (const value of values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    });
    if (!(low <= high)) return this.bounds();
    const pad = (high - low) * 0.08 || 1;
    return [low - pad, high + pad];
  }

  drop() {
    if (this.plot) this.plot.destroy();
    this.plot = null;
  }

  make(data) {
    const color = palette(), { times } = this.timeline;
    const dense = this.card.data.dense, ratio = devicePixelRatio;
    const axis = { stroke: color("quiet"), font: "11px system-ui, sans-serif", ticks: { stroke: color("faint"), width: 1, size: 4 }, grid: { stroke: color("faint"), width: 0.6 } };
    const series = this.lines.map((line, index) => ({
      label: line.name,
      stroke: color(this.color(index)),
      width: 1.4,
      pxAlign: 0,
      spanGaps: true,
      paths: dense ? uPlot.paths.stepped({ align: 1 }) : uPlot.paths.linear(),
      ...(this.robustness && index === 0 ? { fill: (u) => this.halves(u, color), fillTo: () => 0 } : {}),
      points: { show: () => this.dotted(index), size: 5, width: 1, fill: color(this.color(index)), stroke: color(this.color(index)) },
    }));
    this.plot = new uPlot({
      width: this.width,
      height: this.height,
      ms: 1,
      pxAlign: 0,
      padding: [6, 18, 0, 0],
      legend: { show: false },
      scales: { x: { time: false, auto: false }, y: { auto: false } },
      axes: [
        { ...axis, size: 26, gap: 3, splits: (u, _, min, max) => times.ticks(min, max, Math.max(u.bbox.width / ratio / 100, 2)), values: (_, places) => times.labels(places) },
        { ...axis, size: AXIS, gap: 4, splits: (u, _, min, max) => this.marksOfValues(min, max), values: (_, places) => places.map((y) => this.nameOfValue(y)) },
      ],
      series: [{}, ...series],
      cursor: {
        x: true, y: false, points: { show: false },
        drag: { x: true, y: true, uni: 24, setScale: false },
        bind: { dblclick: () => () => { this.values = null; this.timeline.everything(); return null; } },
      },
      hooks: {
        drawClear: [(u) => this.under(u, color)],
        draw: [(u) => this.over(u, color)],
        setSelect: [(u) => this.selected(u)],
        setCursor: [(u) => this.moved(u)],
      },
    }, data, this.host);
    this.listen();
  }

  marksOfValues(min, max) {
    const [low, high] = this.values || (this.card.fitted ? [min, max] : this.finite);
    const codes = Object.keys(this.names()).map(Number).filter((code) => code >= low && code <= high).sort((a, b) => a - b);
    const found = codes.length ? apart(codes, (high - low) / NAMES) : valueTicks(low, high);
    if (!this.values && !this.card.fitted) this.infinite.forEach((there, end) => { if (there) found[end ? "push" : "unshift"](this.edges[end]); });
    return found;
  }

  nameOfValue(y) {
    if (this.infinite[0] && y === this.edges[0]) return "−∞";
    if (this.infinite[1] && y === this.edges[1]) return "+∞";
    const name = this.names()[y];
    if (name === undefined) return number(y);
    return name.length > LONGEST ? `${name.slice(0, LONGEST - 1)}…` : name;
  }

  // The names of values, if they are the same for all lines that are shown.
  names() {
    const all = this.lines.filter((line) => line.shown).map((line) => line.names), [first] = all;
    return first && all.every((names) => JSON.stringify(names) === JSON.stringify(first)) ? first : {};
  }

  // Samples have dots where there is room for them; what is no sample never has.
  dotted(index) {
    const part = this.seen[index];
    return part.kind === "samples" && part.x.length > 0 && part.x.length < Math.max((this.width - AXIS) / 9, 2);
  }

  halves(u, color) {
    const { top, height } = u.bbox, zero = u.valToPos(0, "y", true);
    const gradient = u.ctx.createLinearGradient(0, top, 0, top + height);
    const part = Math.min(Math.max((zero - top) / height, 0), 1);
    for (const [at, name] of [[0, "above"], [part, "above"], [part, "below"], [1, "below"]]) gradient.addColorStop(at, color(name));
    return gradient;
  }

  // ---- under and over the lines

  clip(u, paint) {
    const { left, top, width, height } = u.bbox;
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(left, top, width, height);
    u.ctx.clip();
    paint(u.ctx, u.bbox);
    u.ctx.restore();
  }

  under(u, color) {
    this.clip(u, (ctx, box) => {
      this.bands(u, ctx, box, this.fails, color("fails"));
      this.bands(u, ctx, box, this.because, color("because"), color("because-edge"));
      this.seen.forEach((part, i) => { if (part.kind === "ranges") this.ranges(u, ctx, this.lines[i], part, color(this.color(i))); });
    });
  }

  // Intervals, as one where nobody could see what is between them.
  bands(u, ctx, { top, height }, flat, fill, edge) {
    const [from, to] = this.timeline.view;
    let first = before(flat, from);
    first = Math.max(first - (first % 2 ? 1 : 0), 0);
    let begin = null, end = null;
    const paint = () => {
      if (begin === null) return;
      ctx.fillStyle = fill;
      ctx.fillRect(begin, top, Math.max(end - begin, 2), height);
      if (edge && end - begin > 5) {
        ctx.fillStyle = edge;
        ctx.fillRect(begin, top, 1, height);
        ctx.fillRect(end - 1, top, 1, height);
      }
    };
    for (let i = first; i < flat.length && flat[i] <= to; i += 2) {
      const a = u.valToPos(Math.max(flat[i], from), "x", true), b = u.valToPos(Math.min(flat[i + 1], to), "x", true);
      if (b < a) continue;
      if (begin !== null && a <= end + 1) { end = Math.max(end, b); continue; }
      paint();
      begin = a;
      end = b;
    }
    paint();
  }

  // Where only the range of the samples is known: boxes, no line.
  ranges(u, ctx, line, { first, last }, color) {
    ctx.fillStyle = color;
    ctx.globalAlpha = 0.3;
    for (let i = first; i <= last; i++) {
      const end = i + 1 < line.at.length ? line.at[i + 1] : this.timeline.end;
      const a = u.valToPos(line.at[i], "x", true), b = u.valToPos(end, "x", true);
      const high = u.valToPos(this.clipped(line.highs[i]), "y", true), low = u.valToPos(this.clipped(line.lows[i]), "y", true);
      ctx.fillRect(a, high - 1, b - a, Math.max(low - high, 0) + 2);
    }
    ctx.globalAlpha = 1;
  }

  over(u, color) {
    this.clip(u, (ctx, { left, top, width, height }) => {
      const rule = (x0, y0, x1, y1, name, dash) => {
        ctx.strokeStyle = color(name);
        ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
        ctx.lineWidth = devicePixelRatio;
        ctx.beginPath();
        ctx.moveTo(x0, y0);
        ctx.lineTo(x1, y1);
        ctx.stroke();
      };
      for (const level of this.levels) {
        const y = u.valToPos(level, "y", true);
        rule(left, y, left + width, y, "quiet", this.robustness ? [] : [6, 4]);
      }
      const upright = (x, name, dash) => { const at = u.valToPos(x, "x", true); rule(at, top, at, top + height, name, dash); };
      const { critical } = this.card.data;
      if (critical) {
        upright(critical.x, "ink", [2, 3]);
        if (this.node === critical.node) this.diamond(u, ctx, critical.x, color);
      }
      this.timeline.marks.forEach((mark, i) => {
        if (mark === null) return;
        upright(mark, "mark", []);
        ctx.fillStyle = color("mark");
        ctx.font = `bold ${11 * devicePixelRatio}px system-ui, sans-serif`;
        ctx.fillText("AB"[i], u.valToPos(mark, "x", true) + 3 * devicePixelRatio, top + 11 * devicePixelRatio);
      });
    });
  }

  diamond(u, ctx, position, color) {
    const line = this.lines[0];
    if (!line.loaded) return;
    const size = 5 * devicePixelRatio, x = u.valToPos(position, "x", true);
    const y = u.valToPos(this.clipped(line.y[Math.max(before(line.x, position), 0)]), "y", true);
    ctx.setLineDash([]);
    ctx.lineWidth = 1.6 * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x, y - size);
    ctx.lineTo(x + size, y);
    ctx.lineTo(x, y + size);
    ctx.lineTo(x - size, y);
    ctx.closePath();
    ctx.fillStyle = color("paper");
    ctx.fill();
    ctx.strokeStyle = color("ink");
    ctx.stroke();
  }

  // ---- the mouse

  selected(u) {
    const { left, top, width, height } = u.select;
    if (width === 0 && height === 0) return;
    const whole = u.bbox.height / devicePixelRatio;
    const full = u.bbox.width / devicePixelRatio;
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    if (height > 3 && height < whole - 1) this.values = [u.posToVal(top + height, "y"), u.posToVal(top, "y")];
    if (width > 3 && width < full - 1) this.timeline.look(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
    else this.draw();
  }

  moved(u) {
    if (this.silent) return;
    const { left } = u.cursor;
    this.timeline.point(left === null || left < 0 ? null : this.card.snapped(u.posToVal(left, "x")));
  }

  point() {
    if (!this.plot) return;
    const { cursor } = this.timeline;
    this.silent = true;
    this.plot.setCursor(cursor === null ? { left: -10, top: -10 } : { left: this.plot.valToPos(cursor, "x"), top: 0 });
    this.silent = false;
    this.legend.values();
  }

  listen() {
    const { over } = this.plot;
    let pressed = null;
    over.addEventListener("mousedown", (event) => { pressed = event.clientX; });
    over.addEventListener("click", (event) => {
      if (pressed === null || Math.abs(event.clientX - pressed) > 3 || this.timeline.cursor === null) return;
      this.timeline.mark(event.shiftKey ? 1 : 0, this.timeline.cursor);
    });
    over.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
      event.preventDefault();
      const position = this.plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
      this.timeline.zoom(event.deltaY > 0 ? 1.25 : 0.8, position);
    }, { passive: false });
  }

  // For those who do not see it.
  summary() {
    const ranges = this.lines.filter((line) => line.shown).map((line) => (
      line.data.low === null ? `${line.name}: no finite value` : `${line.name} from ${line.text(line.data.low)} to ${line.text(line.data.high)}`));
    const failing = [];
    for (let i = 0; i < this.fails.length && i < 10; i += 2) {
      failing.push(`${this.timeline.times.text(Math.max(this.fails[i], this.timeline.start))} to ${this.timeline.times.text(this.fails[i + 1])}`);
    }
    return ranges.join("; ") + (failing.length ? `; does not hold from ${failing.join(", ")}` : "");
  }
}
