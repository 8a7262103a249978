// The overview and the page as a whole: filter, sort, search, deep links, themes, printing.

const ORDER = ["violated", "error", "unchecked", "satisfied"];
const opened = new Map();

const cardOf = (section) => {
  if (!opened.has(section)) opened.set(section, new Card(section));
  return opened.get(section);
};

const sections = [...document.querySelectorAll("details.card")];
const verdictOf = (section) => ORDER.find((verdict) => section.classList.contains(verdict));
const facts = new Map(sections.map((section) => {
  const number_ = section.dataset.number;
  const cell = document.querySelector(`td[data-card="${number_}"]`);
  return [section, {
    cell,
    verdict: verdictOf(section),
    number: Number(number_),
    robustness: Number((cell.querySelector("b").textContent || "NaN").replace("inf", "Infinity")),
    name: section.querySelector("summary b").textContent,
    text: section.textContent.toLowerCase(),
  }];
}));
const byNumber = new Map(sections.map((section) => [section.dataset.number, section]));
const lines = [...document.querySelectorAll("#matrix tbody tr")].map((row) => ({
  row, order: Number(row.dataset.order), name: row.dataset.name, cards: [...row.querySelectorAll("td[data-card]")].map((cell) => byNumber.get(cell.dataset.card)),
}));

const number_or_last = (value) => (Number.isNaN(value) ? Infinity : value);
const compare = {
  worst: (a, b) => ORDER.indexOf(a.verdict) - ORDER.indexOf(b.verdict) || number_or_last(a.robustness) - number_or_last(b.robustness),
  robustness: (a, b) => number_or_last(a.robustness) - number_or_last(b.robustness),
  name: (a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }),
  given: (a, b) => a.number - b.number,
};
const compareNumbers = (order) => (a, b) => (compare[order](a, b) || 0);

const arrange = () => {
  const order = document.getElementById("sort").value;
  const by = (a, b) => compareNumbers(order)(a, b) || a.number - b.number;
  sections.sort((a, b) => by(facts.get(a), facts.get(b)));
  document.getElementById("cards").append(...sections);
  const worst = (line) => line.cards.map((section) => facts.get(section)).sort(by)[0];
  lines.sort((a, b) => (order === "given" ? a.order - b.order
    : order === "name" ? a.name.localeCompare(b.name, undefined, { numeric: true }) : by(worst(a), worst(b))));
  document.querySelector("#matrix tbody").append(...lines.map(({ row }) => row));
};

const select = () => {
  const words = document.getElementById("search").value.toLowerCase().split(/\s+/).filter(Boolean);
  const verdicts = new Set([...document.querySelectorAll("[data-verdict][aria-pressed=true]")].map((button) => button.dataset.verdict));
  let count = 0;
  for (const [section, { verdict, text, cell }] of facts) {
    const there = verdicts.has(verdict) && words.every((word) => text.includes(word));
    section.hidden = !there;
    cell.classList.toggle("out", !there);
    count += there;
  }
  for (const { row, cards } of lines) row.hidden = cards.every((section) => section.hidden);
  const all = sections.length;
  document.getElementById("found").textContent = count === all ? "" : `${count} of ${all}`;
};

// #requirement/trace opens a card, #requirement/trace@from..to zooms.
const follow = async () => {
  const [, id, view] = /^#(.*?)(?:@([^@]*))?$/.exec(location.hash) || [];
  const section = id && document.getElementById(id);
  if (!section || !section.classList.contains("card")) return;
  section.hidden = false;
  section.open = true;
  const card = cardOf(section);
  section.scrollIntoView();
  await card.ready;
  const [from, to] = (view || "").split("..").map(Number);
  if (to > from) card.timeline.look(from, to);
};

const themed = (theme) => {
  document.documentElement.dataset.theme = theme;
  opened.forEach((card) => { if (card.charts) card.redrawn(); });
};
const isDark = () => document.documentElement.dataset.theme === "dark";

const start = () => {
  document.getElementById("filters").hidden = false;
  document.querySelectorAll("[data-verdict]").forEach((button) => button.addEventListener("click", () => {
    button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
    select();
  }));
  document.getElementById("search").addEventListener("input", select);
  document.getElementById("sort").addEventListener("change", arrange);
  document.getElementById("theme").addEventListener("click", () => themed(isDark() ? "light" : "dark"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (event) => themed(event.matches ? "dark" : "light"));
  const several = new Set([...document.querySelectorAll("details.card .trace")].map((trace) => trace.textContent)).size > 1;
  if (several) {
    const box = node("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => { Timeline.synchronised = box.checked; });
    document.getElementById("theme").before(node("label", {}, box, " zoom all traces together"));
  }
  let before_ = "";
  addEventListener("beforeprint", () => {
    before_ = document.documentElement.dataset.theme;
    document.documentElement.dataset.theme = "light";
    opened.forEach((card) => { if (card.charts) { card.charts.forEach((chart) => chart.drop()); card.paint(); } });
  });
  addEventListener("afterprint", () => themed(before_));
  for (const section of sections) {
    section.addEventListener("toggle", () => { if (section.open) cardOf(section); });
    if (section.open) cardOf(section);
  }
  document.getElementById("matrix").addEventListener("click", (event) => {
    const link = event.target.closest("a");
    if (link && link.hash === location.hash) follow();
  });
  addEventListener("hashchange", follow);
  follow();
};

start();
