// The state of the page as the fragment of an address: JSON, compressed, in the letters of URLs.

const VERSION = "1";
const MOST = 16_000_000; // bytes of a state: some kilobytes of a link can decompress to gigabytes

const through = async (bytes, stream) => {
  const parts = [];
  let size = 0;
  for (const reader = new Blob([bytes]).stream().pipeThrough(stream).getReader(); ;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > MOST) {
      await reader.cancel();
      throw new RangeError("too large");
    }
    parts.push(value);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
};

export const toBase64 = (bytes) => {
  let text = "";
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
};

export const fromBase64 = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

export const encode = async (state) => {
  const bytes = await through(new TextEncoder().encode(JSON.stringify(state)), new CompressionStream("deflate-raw"));
  return VERSION + toBase64(bytes).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
};

const isNumber = (value) => Number.isFinite(value);
const isPoint = (each, k, all) => Array.isArray(each) && each.length === 2 && each.every(isNumber) && (k === 0 || all[k - 1][0] < each[0]);
const isSignal = (each) => typeof each?.hold === "boolean" && Array.isArray(each.points) && each.points.length > 0 && each.points.every(isPoint);
const isText = (value) => typeof value === "string";
const isNothing = (value) => value === null;
const isRecording = ({ name, bytes, number }) => isText(name) && (bytes === undefined ? Number.isInteger(number) : isText(bytes));

// What each part of a state must be; links come from anybody.
const KINDS = {
  text: isText, time: (value) => value === "discrete" || value === "dense", period: isText, resample: isText,
  duration: (value) => isNumber(value) && value >= 0,
  signals: (value) => value !== null && typeof value === "object" && !Array.isArray(value) && Object.values(value).every(isSignal),
  recording: (value) => isNothing(value) || (typeof value === "object" && isRecording(value)),
  focus: (value) => isNothing(value) || isText(value),
  at: (value) => isNothing(value) || isNumber(value),
  view: (value) => isNothing(value) || (Array.isArray(value) && value.length === 2 && value.every(isNumber) && value[0] < value[1]),
};
const isState = (data) => data !== null && typeof data === "object" && Object.entries(KINDS).every(([name, is]) => !(name in data) || is(data[name]));

// The state of a fragment; null if it is none of ours.
export const decode = async (fragment) => {
  if (!fragment.startsWith(VERSION)) return null;
  try {
    const bytes = fromBase64(fragment.slice(VERSION.length).replaceAll("-", "+").replaceAll("_", "/"));
    const state = JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"))));
    if (isText(state?.recording?.bytes)) fromBase64(state.recording.bytes); // throws for what is none
    return isState(state) ? state : null;
  } catch {
    return null;
  }
};
