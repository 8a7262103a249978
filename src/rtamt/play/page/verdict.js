// The verdict, the numbers under it, the requirements and the explanation.

import { number } from "./chart.js";

const $ = (id) => document.getElementById(id);
const WORDS = { satisfied: "Satisfied", violated: "Violated", open: "Undecided" };
const SIGNS = { satisfied: "✓", violated: "✗", open: "?" };

const made = (name, text, className = "") => {
  const node = document.createElement(name);
  node.textContent = text;
  if (className) node.className = className;
  return node;
};

const interval = ([low, high]) => (low === high ? number(low) : `${number(low)} to ${number(high)}`);

export class Verdict {
  constructor(choose) { this.choose = choose; }

  // The text has an error: what is shown is of the last text without.
  stale() { $("result").classList.add("stale"); }

  show(answer) {
    $("result").classList.remove("stale");
    const whole = this.whole(answer.requirements), word = $("verdict").firstElementChild;
    $("result").className = `card ${whole}`;
    if (word.textContent !== WORDS[whole]) word.textContent = WORDS[whole]; // a live region: announced when it changes
    const rows = [["Robustness", interval(answer.interval)]];
    if (answer.first !== null && answer.first !== undefined) rows.push(["First violation", `${number(answer.first, 6)} s`]);
    if (answer.explanation?.critical !== null && answer.explanation) rows.push(["Critical point", `${number(answer.explanation.critical, 6)} s`]);
    $("numbers").replaceChildren(...rows.flatMap(([name, value]) => [made("dt", name), made("dd", value)]));
    this.requirements(answer);
    this.why(answer.explanation);
  }

  whole(requirements) {
    const verdicts = requirements.map((each) => each.verdict);
    return ["violated", "open"].find((each) => verdicts.includes(each)) || "satisfied";
  }

  requirements({ requirements, focus }) {
    $("requirements").hidden = requirements.length < 2;
    $("requirements").replaceChildren(...requirements.map((each) => {
      const button = made("button", "", each.verdict);
      button.type = "button";
      button.setAttribute("aria-pressed", each.name === focus);
      button.append(made("span", each.name), made("i", `${SIGNS[each.verdict]} ${interval(each.interval)}`));
      button.addEventListener("click", () => this.choose(each.name));
      return button;
    }));
  }

  why(explanation) {
    if (!explanation) { $("why").replaceChildren(); return; }
    const causes = document.createElement("ul");
    causes.append(...explanation.causes.map((each) => made("li", each.text)));
    if (explanation.more) causes.append(made("li", `${explanation.more} more`, "quiet"));
    $("why").replaceChildren(...explanation.summary.map((each) => made("p", each)), ...(explanation.causes.length ? [causes] : []));
  }
}
