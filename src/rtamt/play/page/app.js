// The page: its state, requests to the server, and the presentation of results.

import { Editor } from "./editor.js";
import { decode, encode, fromBase64, toBase64 } from "./link.js";
import { Timeline } from "./online.js";
import { Chart, valueRange, visibleRange } from "./chart.js";
import { bytesOf, cancel, LatestRequest, ask, start, upload } from "./server.js";
import { Signal } from "./signal.js";
import { Verdict } from "./verdict.js";
import { View } from "./view.js";

const $ = (id) => document.getElementById(id);
const EXAMPLE = {
  text: "always(req >= 3 -> eventually[0:5](gnt >= 3))",
  signals: {
    req: { hold: true, points: [[0, 0], [4, 6], [6, 0], [18, 5], [21, 0]] },
    gnt: { hold: true, points: [[0, 0], [7, 4], [10, 0], [26, 4], [28, 0]] },
  },
};

const state = { text: "", time: "discrete", period: "1s", duration: 30, signals: {}, recording: null, resample: "", focus: null, at: null };
const withoutPrototype = (signals) => Object.assign(Object.create(null), signals); // any name, even __proto__
state.signals = withoutPrototype({});
const own = (object, name) => (object && Object.hasOwn(object, name) ? object[name] : undefined); // not what all objects inherit
let answer = null; // the last one without an error
let changes = 0; // of what is evaluated
let charts = new Map();

const width = () => Math.max($("charts").clientWidth - 68, 100);

const makeRequest = (more = {}) => ({
  text: state.text, time: state.time, period: state.period, duration: state.duration, resample: state.resample, focus: state.focus,
  signals: state.recording ? {} : state.signals, recording: state.recording?.number ?? null, width: width(), view: view.part, change: changes, ...more,
});

const toast = (text) => {
  $("toast").textContent = text;
  $("toast").hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => { $("toast").hidden = true; }, 4000);
};

// ---- answers

const evaluation = new LatestRequest("evaluate", () => makeRequest(), (found, begun, { text, recording }) => {
  if (text !== state.text || recording !== (state.recording?.number ?? null)) return; // of another text, or other data
  show(found);
  const { dataset } = document.documentElement; // for measurements
  dataset.took = (performance.now() - begun).toFixed(2);
  dataset.updates = Number(dataset.updates || 0) + 1;
}, 40);
const replay = new LatestRequest("replay", () => (answer ? makeRequest({ view: null }) : null), (found) => {
  timeline.replayed(found);
  if (view.part) details.watched.schedule(0);
  if (state.at !== null) cursorState.schedule(0);
}, 120);
const cursorState = new LatestRequest("cursor", () => (answer && state.at !== null ? makeRequest({ at: state.at }) : null), (found, _, { at, change }) => { if (change === changes) timeline.known(found, at); }, 30);
// The visible part of the time span, in full detail.
const details = {
  drawn: new LatestRequest("redraw", () => (answer && view.part ? makeRequest() : null), (found, _, { change }) => {
    if (found.error || change !== changes) return;
    answer.near = found.near;
    arrange(answer.variables);
    timeline.draw();
  }, 50),
  watched: new LatestRequest("redraw_replay", () => (answer && timeline.found && !timeline.found.error && view.part ? makeRequest() : null), (found, _, { change }) => { if (change === changes) timeline.redrawn(found); }, 100),
};

const view = new View({
  at: () => state.at,
  whole: () => (state.recording || !answer ? [answer?.clock.start ?? 0, answer?.clock.end ?? 1] : [0, state.duration || 1]),
  viewed: () => {
    if (!answer) return;
    arrange(answer.variables);
    timeline.draw();
    point();
    remember();
    details.drawn.schedule();
    details.watched.schedule();
  },
});

const changed = ({ delay, kept = true } = {}) => {
  changes += 1;
  if (kept) remember();
  evaluation.schedule(delay);
};

const editor = new Editor(() => { state.text = editor.text; changed(); });
const verdict = new Verdict((name) => { state.focus = name; changed({ delay: 0 }); });
const timeline = new Timeline({
  moved: (at) => { state.at = at; view.reveal(at); point(); cursorState.schedule(); remember(); },
  at: () => state.at,
  drawn: () => drawn(),
  view,
});

function show(found) {
  const problem = $("problem");
  problem.classList.toggle("wrong", Boolean(found.error));
  editor.mark([
    ...(found.error ? [{ ...found.error, kind: "error" }] : []),
    ...(found.warnings || []).map((each) => ({ ...each, kind: "warning" })),
  ]);
  $("text").setAttribute("aria-invalid", Boolean(found.error));
  if (found.variables) {
    tidy(found.variables);
    $("period").disabled = found.declared; // by the text
    $("period").value = found.declared ? `${found.period}s` : state.period;
    editor.names = state.recording ? state.recording.signals.map((each) => each.name) : found.variables;
    if (!state.recording && found.missing.length) { addSignals(found.missing); return; }
  }
  if (found.error) {
    problem.textContent = where(found.error) + found.error.message;
    verdict.stale();
    if (found.variables) arrange(found.variables);
    return;
  }
  problem.textContent = found.warnings.length ? found.warnings.map((each) => `${each.code}: ${each.message}`).join("\n") : `Horizon ${found.horizon === "Infinity" ? "∞" : found.horizon} · ${found.samples} samples`;
  answer = found;
  view.fit();
  $("period").placeholder = found.step === null ? "inferred" : `${Number(found.step.toPrecision(6))} s`;
  verdict.show(found);
  arrange(found.variables);
  timeline.evaluated(found);
  point();
  replay.schedule();
}

const where = ({ start: at }) => {
  if (at === null) return "";
  const before = state.text.slice(0, at).split("\n");
  return before.length > 1 || state.text.includes("\n") ? `Line ${before.length}, column ${before.at(-1).length + 1}: ` : `Column ${at + 1}: `;
};

// New variables begin as constants, which go with the variable: names that are being typed leave nothing behind.
const provided = new Set();

const tidy = (names) => {
  for (const name of [...provided].filter((each) => !names.includes(each))) {
    delete state.signals[name];
    provided.delete(name);
  }
};

function addSignals(names) {
  const unknown = names.filter((name) => !(name in state.signals));
  for (const name of unknown) { state.signals[name] = { hold: true, points: [[0, 0]] }; provided.add(name); }
  if (unknown.length) changed({ delay: 0 });
}

// ---- signals

const page = {
  view,
  get times() { return view.times; },
  get duration() { return state.duration; },
  get period() { return state.time === "dense" ? (answer?.period ?? 1) / 10 : answer?.period ?? 1; },
  cursor: () => state.at,
  model: (name) => state.signals[name],
  change: (name, model, final) => { provided.delete(name); state.signals[name] = model; changed({ delay: 0, kept: final }); },
};

// What is drawn: in detail as far as that is known, else of all of the time.
const drawn = () => (answer && view.has(answer.near) ? answer.near : answer);

function arrange(names) {
  const key = JSON.stringify([names, state.recording?.number ?? null]);
  if (arrange.key !== key) {
    arrange.key = key;
    charts = new Map();
    $("charts").replaceChildren();
    for (const name of names) {
      const host = document.createElement("div");
      host.className = "signal";
      $("charts").append(host);
      charts.set(name, state.recording ? new Recorded(name, host) : new Signal(name, host, page));
    }
  }
  for (const [name, chart] of charts) {
    chart.levels = own(answer?.thresholds, name) || [];
    chart.because = own(answer?.explanation?.because, name) || [];
    if (state.recording) chart.data = drawn()?.lines.find((each) => each.name === name) || chart.data;
    chart.draw();
  }
  $("source").textContent = state.recording ? `${state.recording.name} · ${state.recording.samples} samples${since()}` : "";
}

// The date from which seconds are counted, if the recording has one.
const since = () => {
  const origin = answer?.clock.origin ?? "";
  return origin.includes("T") ? ` · time from ${origin.slice(0, 19).replace("T", " ")} UTC` : "";
};

class Recorded {
  constructor(name, host) {
    const head = document.createElement("div"), title = document.createElement("h3");
    this.unit = document.createElement("span");
    head.className = "signal-head";
    title.textContent = name;
    this.unit.className = "unit";
    head.append(title, this.unit);
    const place = document.createElement("div");
    host.append(head, place);
    this.chart = new Chart(place, { height: 96, label: `Signal ${name}` });
    timeline.listen(this.chart);
  }

  draw() {
    if (!this.data || !answer) return;
    this.unit.textContent = this.data.unit;
    const part = visibleRange(this.data.x, view.times);
    this.chart.frame(view.times, valueRange([...this.data.y.slice(...part).map(Number), ...this.levels]));
    for (const [from, to] of this.because) this.chart.band(from, to, "because");
    for (const level of this.levels) this.chart.level(level);
    this.chart.line(this.data.x, this.data.y, { held: answer.dense, dots: true });
    this.chart.point(state.at);
  }
}

function point() {
  for (const { chart } of charts.values()) chart.point(state.at);
  timeline.point();
}

// ---- recordings

function use(recording) {
  state.recording = recording;
  state.period = "";
  state.at = null;
  view.take(null);
  settings();
  changed({ delay: 0 });
}

async function load(file) {
  $("source").textContent = `reading ${file.name} …`;
  const found = await upload(file);
  if (found.error) {
    $("source").textContent = "";
    toast(found.error.message);
    return null;
  }
  use(found);
  return found;
}

function settings() {
  for (const each of document.querySelectorAll("input[name=time]")) each.checked = each.value === state.time;
  $("period").value = state.period;
  $("duration").value = state.duration;
  $("resample").value = state.resample;
  $("lasting").hidden = $("hint").hidden = Boolean(state.recording);
  $("resampling").hidden = $("draw").hidden = $("columns").hidden = !state.recording;
  $("columns").replaceChildren(...(state.recording?.signals || []).map(({ name, unit }) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = name;
    button.title = unit ? `insert ${name} [${unit}]` : `insert ${name}`;
    button.addEventListener("click", () => editor.insert(name));
    return button;
  }));
}

// ---- the link

const kept = () => ({ ...state, view: view.part, recording: state.recording && { number: state.recording.number, name: state.recording.name } });

const remember = () => {
  clearTimeout(remember.timer);
  remember.timer = setTimeout(async () => history.replaceState(null, "", `#${await encode(kept())}`), 300);
};

$("link").addEventListener("click", async () => {
  const shared = kept();
  let whole = true;
  if (state.recording) {
    const bytes = await bytesOf(state.recording.number);
    whole = bytes !== null;
    shared.recording = whole ? { name: state.recording.name, bytes: toBase64(bytes) } : null;
  }
  const text = `${location.origin}/#${await encode(shared)}`;
  document.documentElement.dataset.link = text;
  try {
    await navigator.clipboard.writeText(text);
    toast(whole ? "Link copied. Open it with: rtamt play 'LINK'" : "Link copied without the recording, which is too large for it.");
  } catch {
    $("shared").value = text; // the browser does not allow it
    $("sharing").showModal();
    $("shared").select();
  }
});

async function restore(saved) {
  for (const name of Object.keys(state)) if (name !== "recording" && name in saved) state[name] = saved[name];
  state.signals = withoutPrototype(state.signals);
  const { recording } = saved;
  if (recording?.bytes) await load(new File([fromBase64(recording.bytes)], recording.name));
  else if (recording) {
    const found = await ask("recording", { recording: recording.number });
    if (found.error) toast(`'${recording.name}' is no longer here: load it again`);
    else state.recording = found;
  }
  for (const name of ["period", "at", "focus"]) if (name in saved) state[name] = saved[name];
  view.take(saved.view ?? null);
}

// ---- the controls

for (const each of document.querySelectorAll("input[name=time]")) each.addEventListener("change", () => { state.time = each.value; changed({ delay: 0 }); });
$("period").addEventListener("input", () => { state.period = $("period").value; changed(); });
$("duration").addEventListener("input", () => {
  const seconds = $("duration").valueAsNumber;
  if (seconds >= 0) { state.duration = seconds; state.at = null; view.take(null); changed(); }
});
$("resample").addEventListener("change", () => { state.resample = $("resample").value; changed({ delay: 0 }); });
$("upload").addEventListener("change", async (event) => {
  const [file] = event.target.files;
  if (file) await load(file);
  event.target.value = "";
});
$("draw").addEventListener("click", () => {
  state.recording = null;
  state.period ||= "1s";
  state.at = null;
  view.take(null);
  settings();
  changed({ delay: 0 });
});
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("dropping"); });
addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  const [file] = event.dataTransfer.files;
  if (file) load(file);
});
new ResizeObserver(() => {
  for (const { chart } of charts.values()) chart.measure();
  timeline.measure();
  if (!answer) return;
  arrange(answer.variables);
  timeline.draw();
  point();
}).observe($("charts"));

for (const button of document.querySelectorAll("[data-wanted]")) {
  button.addEventListener("click", async () => {
    const buttons = document.querySelectorAll("[data-wanted]");
    for (const each of buttons) each.disabled = true;
    $("cancel").hidden = false;
    $("answer").textContent = "searching …";
    const found = await ask("find_trace", makeRequest({ wanted: button.dataset.wanted }));
    for (const each of buttons) each.disabled = false;
    $("cancel").hidden = true;
    $("answer").textContent = found.error ? found.error.message : found.sentence;
    if (!found.signals) return;
    Object.assign(state, { recording: null, period: `${found.period}s`, duration: found.duration, at: null, focus: null });
    Object.assign(state.signals, found.signals);
    view.take(null);
    settings();
    changed({ delay: 0 });
  });
}
$("cancel").addEventListener("click", cancel);

// ---- the beginning

const given = await start();
editor.know(given.vocabulary);
$("file").textContent = given.name;
$("upload").accept = given.suffixes.join(",");
if (!given.analysis) {
  for (const each of document.querySelectorAll("[data-wanted]")) each.disabled = true;
  $("answer").textContent = "It needs the package z3: pip install 'rtamt[analysis]'";
}
const saved = location.hash.length > 1 ? await decode(location.hash.slice(1)) : null;
if (location.hash.length > 1 && !saved) toast("The link is damaged: the page starts without it.");
if (saved) await restore(saved);
else {
  state.time = given.time;
  if (given.text) state.text = given.text.trimEnd();
  else if (!given.recording) Object.assign(state, { text: EXAMPLE.text, signals: withoutPrototype(structuredClone(EXAMPLE.signals)) });
  if (given.recording) state.recording = given.recording;
  if (given.period || given.recording) state.period = given.period;
  if (given.complaint) toast(given.complaint);
}
editor.text = state.text;
settings();
changed({ delay: 0, kept: false });
document.documentElement.dataset.ready = "true";
