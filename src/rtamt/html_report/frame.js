// In a frame, such as that of a notebook: tells the page around it what is seen and pointed at, and follows it.

const finite = (value) => typeof value === "number" && Number.isFinite(value);

if (parent !== window) {
  document.documentElement.dataset.framed = "";
  let asked = false; // at most one message a frame of the screen
  const report = (ready = false) => {
    const [timeline] = Timeline.all.values();
    if (timeline) parent.postMessage({ rtamt: { ready, zoom: timeline.view, cursor: timeline.cursor } }, "*");
  };
  let following = false;
  Timeline.changed = () => {
    if (asked || following) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; report(); });
  };
  addEventListener("message", ({ source, data }) => {
    if (source !== parent || !data?.rtamt) return;
    const { zoom, cursor } = data.rtamt;
    following = true;
    for (const timeline of Timeline.all.values()) {
      if (Array.isArray(zoom) && zoom.length === 2 && zoom.every(finite) && zoom[0] < zoom[1]) timeline.look(...zoom, true);
      timeline.point(finite(cursor) ? cursor : null);
    }
    following = false;
  });
  Promise.all([...opened.values()].map((card) => card.ready)).then(() => report(true));
}
