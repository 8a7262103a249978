// Requests to the server: numbered, the newest wins, one of each kind at a time.

const page = Math.random().toString(36).slice(2);
let number = 0;

const post = async (path, body, headers = {}) => {
  const answer = await fetch(path, { method: "POST", body, headers });
  const data = await answer.json();
  return answer.ok ? data : { error: { message: data.sentence, start: null, end: null } };
};

const lost = { error: { message: "the server does not answer: is 'rtamt play' still running?", start: null, end: null } };

export const ask = async (kind, message) => {
  try {
    return await post(`ask/${kind}`, JSON.stringify({ ...message, page, number: ++number }));
  } catch {
    return lost;
  }
};

export const start = () => post("start", "{}");
export const cancel = () => post("cancel", "{}");

export const upload = async (file) => {
  try {
    return await post("upload", file, { "X-Name": encodeURIComponent(file.name) });
  } catch {
    return lost;
  }
};

export const bytesOf = async (recording) => {
  const answer = await fetch(`file/${recording}`);
  return answer.ok ? new Uint8Array(await answer.arrayBuffer()) : null;
};

// Requests of one kind that follow the user: the latest one is sent when the previous one is answered.
export class LatestRequest {
  constructor(kind, makeRequest, show, delay) {
    Object.assign(this, { kind, makeRequest, show, delay, timer: null, busy: false, again: false, sent: 0 });
  }

  schedule(delay = this.delay) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.send(), delay);
  }

  async send() {
    this.timer = null;
    if (this.busy) { this.again = true; return; }
    const request = this.makeRequest();
    if (request === null) return;
    this.busy = true;
    const sent = ++this.sent, begun = performance.now();
    const answer = await ask(this.kind, request);
    this.busy = false;
    const again = this.again;
    this.again = false;
    if (again) this.send();
    if (!answer.late && sent === this.sent - (again ? 1 : 0)) this.show(answer, begun, request);
  }
}
