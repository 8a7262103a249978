// Lines: arrays that are decoded when they are needed, and what is drawn of them between two instants.

const arrays = new Map();

// A promise of the typed array that the page holds under a number.
const arrayOf = (number) => {
  if (!arrays.has(number)) {
    const holder = document.getElementById(`blob-${number}`);
    arrays.set(number, decode(holder.textContent, holder.dataset.kind, Number(holder.dataset.length)));
  }
  return arrays.get(number);
};

// Base64 of a zlib stream of the bytes by their weight: all first ones, then all second ones, and so on.
const decode = async (text, kind, length) => {
  const letters = atob(text), packed = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const sorted = new Uint8Array(await new Response(stream).arrayBuffer());
  const size = Number(kind[1]), bytes = new Uint8Array(sorted.length);
  for (let weight = 0; weight < size; weight++) {
    for (let i = 0, from = weight * length; i < length; i++) bytes[i * size + weight] = sorted[from + i];
  }
  return new { f8: Float64Array, f4: Float32Array }[kind](bytes.buffer);
};

// Intervals as pairs of positions in one flat array, in order.
const intervalsOf = async (data) => (typeof data === "number" ? arrayOf(data) : Float64Array.from(data.flat()));

// The index of the last position at or before x, -1 if there is none.
const before = (positions, x) => {
  let low = 0, high = positions.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (positions[middle] <= x) low = middle + 1; else high = middle;
  }
  return low - 1;
};

// Positions that follow a rule are the same array in all lines of a trace.
const rules = new Map();
const positionsOf = async (data, count) => {
  if (data.blob !== undefined) return arrayOf(data.blob);
  const key = `${data.start} ${data.step} ${data.rate} ${count}`;
  if (!rules.has(key)) {
    rules.set(key, Float64Array.from({ length: count },
      data.rate === undefined ? (_, i) => data.start + i * data.step : (_, i) => data.start + i / data.rate));
  }
  return rules.get(key);
};

class Line {
  constructor(data) {
    this.data = data;
    this.name = data.name;
    this.points = data.points;
    this.names = data.names || {}; // of values: members of an enumeration, or true and false
    this.shown = true;
  }

  text(value) { return this.names[value] ?? number(value); }

  // Whether the page holds every sample.
  get embedded() { return this.data.x !== undefined; }

  get loaded() { return this.x !== undefined; }

  // Load what is small: all of a short line, the overview of a long one.
  async prepare() {
    const { overview } = this.data;
    if (!overview) return this.load();
    [this.at, this.lows, this.highs] = await Promise.all([overview.at, overview.low, overview.high].map(arrayOf));
    return undefined;
  }

  async load() {
    if (this.loaded || !this.embedded) return;
    const { x, y } = this.data;
    const [positions, values] = await Promise.all([positionsOf(x, this.points), arrayOf(y.blob)]);
    this.y = y.sign === undefined ? values : Float64Array.from(values, (value) => y.sign * value - y.sign * y.limit);
    this.x = positions;
  }

  // A value as it is written to a file.
  written(index) { return this.names[this.y[index]] ?? this.y[index]; }

  // The index of the sample that is meant at a position: in dense time the last one, else the nearest.
  nearest(position, dense) {
    const i = Math.max(before(this.x, position), 0), next = Math.min(i + 1, this.x.length - 1);
    return !dense && this.x[next] - position < position - this.x[i] ? next : i;
  }

  // The value at a position as text: a number, or the range in which it is.
  valueAt(position, dense) {
    if (this.loaded) return position < this.x[0] ? "" : this.text(this.y[this.nearest(position, dense)]);
    if (!this.at || position < this.at[0]) return "";
    const i = Math.max(before(this.at, position), 0);
    return `${this.text(this.lows[i])} … ${this.text(this.highs[i])}`;
  }

  // What is drawn between two instants in so many columns: `kind` is "samples" (all of them), "extremes" (what drawing
  // all of them would look like), or "ranges" (wider than a column, in between nothing is known).
  seen(from, to, columns) {
    if (this.loaded) return samples(this.x, this.y, from, to, columns);
    const first = Math.max(before(this.at, from), 0), last = Math.min(before(this.at, to) + 1, this.at.length - 1);
    const part = (this.at[last] - this.at[first]) / Math.max(last - first, 1);
    if (this.data.band || part > (2.5 * (to - from)) / columns) return { kind: "ranges", x: [], y: [], first, last };
    const x = [], y = [];
    for (let i = first; i <= last; i++) {
      const low = this.lows[i], high = this.highs[i];
      const rising = y.length === 0 || Math.abs(y[y.length - 1] - low) <= Math.abs(y[y.length - 1] - high);
      x.push(this.at[i], this.at[i] + part / 2);
      y.push(rising ? low : high, rising ? high : low);
    }
    return { kind: "extremes", x, y, per: (this.points / this.at.length) * (last - first + 1) / columns };
  }
}

// The samples from the last one before `from` to the first after `to`; of many in one column the first, lowest,
// highest and last one.
const samples = (x, y, from, to, columns) => {
  const first = Math.max(before(x, from), 0), last = Math.min(before(x, to) + 1, x.length - 1);
  const count = last - first + 1;
  if (count <= 4 * columns) {
    return { kind: "samples", x: Array.from(x.subarray(first, last + 1)), y: Array.from(y.subarray(first, last + 1)), per: count / columns };
  }
  const found = { kind: "extremes", x: [], y: [], per: count / columns };
  const width = (to - from) / columns;
  let i = first;
  while (i <= last) {
    const end = from + (Math.floor((x[i] - from) / width) + 1) * width, start = i;
    let low = i, high = i;
    for (i++; i <= last && x[i] < end; i++) {
      if (y[i] < y[low]) low = i;
      if (y[i] > y[high]) high = i;
    }
    let done = -1;
    for (const at of low < high ? [start, low, high, i - 1] : [start, high, low, i - 1]) {
      if (at > done) { found.x.push(x[at]); found.y.push(y[at]); done = at; }
    }
  }
  return found;
};
