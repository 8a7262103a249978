// The state of the page as the fragment of an address: JSON, compressed, in the letters of URLs.

const VERSION = "1";

const through = async (bytes, stream) =>
  new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

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

// The state of a fragment; null if it is none of ours.
export const decode = async (fragment) => {
  if (!fragment.startsWith(VERSION)) return null;
  try {
    const bytes = fromBase64(fragment.slice(VERSION.length).replaceAll("-", "+").replaceAll("_", "/"));
    return JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"))));
  } catch {
    return null;
  }
};
