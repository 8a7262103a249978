"""Decision lists: "if a recording satisfies the template then it is good, else if ..., else it is bad"."""

from __future__ import annotations

from math import isinf
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.mining.classifier_templates import Template

    Bits = NDArray[np.bool_]


#: A gap around a threshold, as a share of the values of all recordings, that is wide.
WIDE = 0.05
#: How many errors the narrowest gap counts as.
_NARROW = 2.0


@dataclass(frozen=True)
class Rule:
    """If a recording satisfies the template with this threshold, it is good, or bad.

    ``covered``: how many good and how many bad recordings it decided when it was learned.
    """

    template: Template
    column: int
    threshold: float
    good: bool
    covered: tuple[int, int]

    @property
    def text(self) -> str:
        """The template with its threshold."""
        return self.template.written(self.threshold)

    def satisfied(self, table: NDArray[np.float64]) -> Bits:
        """Return which recordings satisfy the template, from their tight values."""
        found: Bits = self.template.direction * (self.threshold - table[:, self.column]) >= 0
        return found


@dataclass(frozen=True)
class DecisionList:
    """Rules in their order, and the class of recordings that satisfy none."""

    rules: tuple[Rule, ...]
    default: bool

    def predicted(self, table: NDArray[np.float64]) -> Bits:
        """Return which recordings are good, from their tight values."""
        good = np.full(len(table), self.default)
        for rule in reversed(self.rules):
            good[rule.satisfied(table)] = rule.good
        return good

    def formula(self) -> str:
        """Return the formula, over ``rule_1``, ``rule_2`` and so on, that is satisfied where a recording is good."""
        text, joined = ("true" if self.default else "false"), ""
        for place in range(len(self.rules), 0, -1):
            good = self.rules[place - 1].good
            name, word = f"rule_{place}" if good else f"not rule_{place}", "or" if good else "and"
            if text in {"true", "false"}:
                # Where what follows is the same class, the rule decides nothing.
                text = text if (text == "true") == good else name
            else:
                text = f"{name} {word} {f'({text})' if joined not in {'', word} else text}"
                joined = word
        return text


def learn_list(
    templates: Sequence[Template], table: NDArray[np.float64], good: Bits, most: int
) -> DecisionList:
    """Return a decision list of at most ``most`` rules; each rule minimises the remaining errors.

    Errors of a rule itself count twice where more rules may follow, which mend only those of the rest. A threshold in a
    narrow gap fits these recordings by chance: the gap adds up to two errors, the less the closer it
    comes to :data:`WIDE`. Ties are broken by the purity of what a rule decides, then by the order of the templates.
    """
    rules: list[Rule] = []
    left = np.ones(len(good), bool)
    default = majority(good)
    while len(rules) < most:
        rest = good[left]
        errors = int((rest != majority(rest)).sum())
        final = 1.0 if len(rules) == most - 1 else 2.0
        best = _best(templates, table[left], rest, np.ptp(_finite(table), axis=0), final) if errors else None
        if best is None or best[0] >= errors:
            break
        rule = best[1]
        rules.append(rule)
        left &= ~rule.satisfied(table)
        default = majority(good[left]) if left.any() else not rule.good
    return DecisionList(tuple(rules), default)


def majority(good: Bits) -> bool:
    """Return the class of most recordings; good if there are as many of both."""
    return bool(2 * good.sum() >= len(good))


def _finite(table: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(np.isfinite(table), table, 0.0)


def _best(
    templates: Sequence[Template],
    table: NDArray[np.float64],
    good: Bits,
    spread: NDArray[np.float64],
    final: float,
) -> tuple[int, Rule] | None:
    """Return the rule that leaves the fewest errors, and how many; ``final``: what an error of the rule counts."""
    best: tuple[tuple[float, float, float], int, Rule] | None = None
    count, all_good = len(good), int(good.sum())
    for column, template in enumerate(templates):
        order = np.argsort(template.direction * table[:, column], kind="stable")
        values = table[order, column]
        cuts = np.flatnonzero(values[1:] != values[:-1]) + 1
        if not len(cuts):
            continue
        goods = np.cumsum(good[order])[cuts - 1]
        bads = cuts - goods
        rest = np.minimum(all_good - goods, count - cuts - (all_good - goods))
        with np.errstate(invalid="ignore"):
            gaps = np.abs(values[cuts] - values[cuts - 1]) / (spread[column] or 1.0)
        for is_good, wrong in ((True, bads), (False, goods)):
            errors = wrong + rest
            costs = final * wrong + rest + _NARROW * (1 - np.minimum(gaps / WIDE, 1))
            # A rule that leaves as many errors as none is no rule, however wide its gap.
            costs[errors >= min(all_good, count - all_good)] = np.inf
            place = int(np.lexsort((-gaps, wrong / cuts, costs))[0])
            key = (float(costs[place]), float(wrong[place] / cuts[place]), -float(gaps[place]))
            if best is None or key < best[0]:
                threshold = between(float(values[cuts[place] - 1]), float(values[cuts[place]]))
                covered = int(goods[place]), int(bads[place])
                best = key, int(errors[place]), Rule(template, column, threshold, is_good, covered)
    return None if best is None else (best[1], best[2])


def between(first: float, second: float) -> float:
    """Return the number with the fewest digits in the middle half between two different numbers.

    >>> between(41.97, 42.31), between(-3.0, 1.0), between(2.0, float("inf"))
    (42.1, 0.0, 3.0)
    """
    low, high = min(first, second), max(first, second)
    if isinf(low):
        low = high - max(1.0, abs(high)) if not isinf(high) else -1.0
    if isinf(high):
        high = low + max(1.0, abs(low))
    middle, quarter = low + (high - low) / 2, (high - low) / 4
    if abs(middle) <= quarter:
        return 0.0
    for digits in range(1, 18):
        rounded = float(f"{middle:.{digits}g}")
        if abs(rounded - middle) <= quarter and low < rounded < high:
            return rounded
    return high if low < high else middle
