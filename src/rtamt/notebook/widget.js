// The page of a result in a frame; zoom and cursor in both directions, as messages.

const unpacked = (bytes) => new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).text();

const render = ({ model, el }) => {
  const frame = document.createElement("iframe");
  frame.title = "requirements and charts";
  frame.setAttribute("sandbox", "allow-scripts allow-downloads");
  frame.style.cssText = "width: 100%; border: 0";
  const fit = () => { frame.style.height = `${model.get("height")}px`; };
  const load = async () => { frame.srcdoc = await unpacked(model.get("_page")); };
  const send = () => {
    const zoom = model.get("zoom");
    frame.contentWindow?.postMessage({ rtamt: { zoom: zoom.length === 2 ? zoom : null, cursor: model.get("cursor") } }, "*");
  };
  let receiving = false; // what the page reports is not sent back to it
  const changed = () => { if (!receiving) send(); };
  const receive = ({ source, data }) => {
    if (source !== frame.contentWindow || !data?.rtamt) return;
    const { ready, zoom, cursor } = data.rtamt;
    if (ready && (model.get("zoom").length === 2 || model.get("cursor") !== null)) { send(); return; }
    receiving = true;
    model.set("zoom", zoom);
    model.set("cursor", cursor);
    receiving = false;
    model.save_changes();
  };
  window.addEventListener("message", receive);
  model.on("change:height", fit);
  model.on("change:_page", load);
  model.on("change:zoom change:cursor", changed);
  fit();
  load();
  el.append(frame);
  return () => {
    window.removeEventListener("message", receive);
    model.off("change:height", fit);
    model.off("change:_page", load);
    model.off("change:zoom change:cursor", changed);
  };
};

export default { render };
