// The text: coloured words, the place of an error, and completion.

const TOKEN = /\/\/[^\n]*|"[^"\n]*"|[A-Za-z_][\w.]*|\d[\w.]*|\s+|[^\sA-Za-z_\d]/g;
const WORD = /[A-Za-z_][\w.]*$/;
const MOST = 8;

export class Editor {
  constructor(changed) {
    this.area = document.getElementById("text");
    this.mirror = document.getElementById("mirror");
    this.list = document.getElementById("words");
    this.words = new Map();
    this.names = [];
    this.marks = [];
    this.found = [];
    this.chosen = 0;
    this.area.addEventListener("input", () => { this.marks = []; this.draw(); this.complete(false); changed(); });
    this.area.addEventListener("keydown", (event) => this.key(event));
    this.area.addEventListener("blur", () => this.close());
    this.area.addEventListener("click", () => this.close());
    this.list.addEventListener("pointerdown", (event) => {
      const item = event.target.closest("li");
      event.preventDefault(); // the text keeps the focus
      if (item) this.take(Number(item.dataset.number));
    });
  }

  get text() { return this.area.value; }

  set text(text) { this.area.value = text; this.marks = []; this.close(); this.draw(); }

  know(vocabulary) {
    for (const word of vocabulary) this.words.set(word.word, word);
    this.draw();
  }

  // Places in the text: {start, end, kind}, kind "error" or "warning".
  mark(marks) { this.marks = marks.filter((mark) => mark.start !== null); this.draw(); }

  insert(name) {
    this.area.focus();
    this.area.setRangeText(name, this.area.selectionStart, this.area.selectionEnd, "end");
    this.area.dispatchEvent(new Event("input"));
    this.close();
  }

  // ---- the mirror under the text

  draw() {
    const { text } = this, edges = new Set();
    for (const { start, end } of this.marks) { edges.add(start); edges.add(Math.max(end, start + 1)); }
    const nodes = [];
    for (const match of text.matchAll(TOKEN)) {
      let from = match.index;
      const stop = from + match[0].length, kind = this.kind(match[0]);
      for (const edge of [...edges].filter((each) => each > from && each < stop).sort((a, b) => a - b).concat(stop)) {
        nodes.push(this.piece(text.slice(from, edge), kind, from));
        from = edge;
      }
    }
    if (this.marks.some(({ start }) => start >= text.length)) nodes.push(this.piece(" ", "", text.length));
    this.mirror.replaceChildren(...nodes, "\n");
  }

  piece(text, kind, from) {
    const span = document.createElement("span");
    span.textContent = text;
    const mark = this.marks.find(({ start, end }) => from >= start && from < Math.max(end, start + 1));
    span.className = [kind, mark ? mark.kind : ""].join(" ").trim();
    return span;
  }

  kind(token) {
    if (token.startsWith("//")) return "comment";
    if (/^[\d"]/.test(token)) return "number";
    return this.words.get(token)?.kind || "";
  }

  // ---- completion

  complete(asked) {
    const { selectionStart: caret, selectionEnd } = this.area;
    const before = this.text.slice(0, caret), word = WORD.exec(before)?.[0] || "";
    const after = /^[\w.]/.test(this.text.slice(caret));
    if (caret !== selectionEnd || after || (!asked && word.length < 1)) { this.close(); return; }
    const own = [...before.slice(0, before.length - word.length).matchAll(/[A-Za-z_]\w*/g)].map((match) => match[0]);
    const names = [...new Set([...this.names, ...own])].filter((name) => !this.words.has(name));
    const all = [
      ...names.map((name) => ({ word: name, kind: "name", doc: this.names.includes(name) ? "signal" : "" })),
      ...this.words.values(),
    ];
    const small = word.toLowerCase();
    this.found = all.filter((each) => each.word.toLowerCase().startsWith(small) && each.word !== word).slice(0, MOST);
    this.from = caret - word.length;
    if (!this.found.length) { this.close(); return; }
    this.chosen = 0;
    this.show();
  }

  show() {
    this.list.replaceChildren(...this.found.map((each, number) => {
      const item = document.createElement("li"), name = document.createElement("b"), doc = document.createElement("span");
      item.id = `word-${number}`;
      item.dataset.number = number;
      item.setAttribute("role", "option");
      item.setAttribute("aria-selected", number === this.chosen);
      name.textContent = each.word;
      name.className = each.kind;
      doc.textContent = each.doc;
      item.append(name, doc);
      return item;
    }));
    this.list.hidden = false;
    const place = this.placeOf(this.from);
    this.list.style.left = `${Math.max(0, Math.min(place.left, this.mirror.clientWidth - this.list.offsetWidth))}px`;
    this.list.style.top = `${place.bottom + 4}px`;
    this.area.setAttribute("aria-activedescendant", `word-${this.chosen}`);
  }

  // The place of a character in the mirror.
  placeOf(offset) {
    const walk = document.createTreeWalker(this.mirror, NodeFilter.SHOW_TEXT), range = document.createRange();
    let rest = offset;
    for (let node = walk.nextNode(); node; node = walk.nextNode()) {
      if (rest <= node.length) {
        range.setStart(node, rest);
        range.setEnd(node, Math.min(rest + 1, node.length));
        const box = range.getBoundingClientRect(), host = this.mirror.getBoundingClientRect();
        return { left: box.left - host.left, bottom: box.bottom - host.top };
      }
      rest -= node.length;
    }
    return { left: 0, bottom: this.mirror.clientHeight };
  }

  close() {
    this.found = [];
    this.list.hidden = true;
    this.area.removeAttribute("aria-activedescendant");
  }

  take(number) {
    const { word } = this.found[number];
    this.area.setRangeText(word, this.from, this.area.selectionStart, "end");
    this.close();
    this.area.dispatchEvent(new Event("input"));
    this.close();
  }

  key(event) {
    if (event.key === " " && event.ctrlKey) { event.preventDefault(); this.complete(true); return; }
    if (this.list.hidden) return;
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (move) {
      event.preventDefault();
      this.chosen = (this.chosen + move + this.found.length) % this.found.length;
      this.show();
    } else if (event.key === "Enter" || event.key === "Tab") {
      event.preventDefault();
      this.take(this.chosen);
    } else if (event.key === "Escape") {
      event.preventDefault();
      this.close();
    }
  }
}
