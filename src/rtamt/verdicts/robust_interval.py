"""While a simulation runs: is the verdict at its first instant settled, whatever is still to come?

What is still to come is put in at its best and at its worst: each predicate is two variables, one for
its places under an even number of negations and one for the others, so that the robustness can only
grow with the first and shrink with the second (after the robust satisfaction intervals of Deshmukh
et al., "Robust online monitoring of Signal Temporal Logic", 2017).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite
from typing import TYPE_CHECKING

import numpy as np

from rtamt.engine.offline import Evaluators
from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.records import Tense
from rtamt.reference import discrete as reference
from rtamt.rewrite.structure import Structure, literal
from rtamt.signals import arrays
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.domain_interface import DomainTrace, TimeDomain

    #: Stamps (seconds) and a column of values for each variable, all of one length.
    Columns = Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True)
class Settled:
    """A verdict that nothing to come can change."""

    satisfied: bool
    #: How many samples settled it.
    samples: int
    #: The robustness if the rest goes as badly as it can, and as well: what it is in the end lies between.
    low: float
    high: float

    @property
    def robustness(self) -> float:
        """The robustness as far as it was seen: ``high``, or ``low`` where only that says anything.

        ``low`` alone would mislead an optimizer: a requirement that is just met is as low as one that was
        settled early.
        """
        return self.high if isfinite(self.high) else self.low


class RobustInterval:
    """Determines whether the first samples of a simulation settle the verdict of a formula.

    ``semantics`` and ``roles`` are those of the robustness. ``domain`` is a time domain with a known step.
    ``samples`` is how many there are at the end in discrete time
    (dense time needs none). A formula with arithmetic over temporal operators, or with an operator that cannot
    be taken apart, is never settled before the end: :attr:`able` is false.
    """

    def __init__(
        self,
        formula: Formula,
        *,
        semantics: str | PredicateSemantics,
        roles: Mapping[str, str],
        backend: str,
        domain: TimeDomain,
        samples: int | None,
    ) -> None:
        self._evaluate = Evaluators(backend)
        self._semantics = semantics
        self._roles = roles
        assert domain.step is not None
        self._domain = domain
        self._step = domain.step
        self._samples = samples
        structure = Structure.of(formula, None)
        self._leaves = structure.leaves
        self._over_predicates = structure.polar[structure.core, 1]
        self.able = all(_at_one_instant(leaf.formula) for leaf in self._leaves.values())

    def after(self, times: FloatArray, columns: Columns) -> Settled | None:
        """Return the verdict that these samples settle (the fewest of them that do); None if they do not."""
        n = len(times)
        if not self.able or not n:
            return None
        distance, truth = self._over(times, columns)
        verdict = self._verdict(times, truth, n)
        if verdict is None:
            return None
        low, high = 1, n  # more samples settle what fewer do, so that the first that do can be bisected
        while low < high:
            middle = (low + high) // 2
            if self._verdict(times, truth, middle) is None:
                low = middle + 1
            else:
                high = middle
        worst, best = (self._value(times, distance, n, best=best) for best in (False, True))
        return Settled(verdict, low, worst, best)

    def _verdict(self, times: FloatArray, truth: Columns, n: int) -> bool | None:
        if self._value(times, truth, n, best=True) < 0:
            return False
        return True if self._value(times, truth, n, best=False) > 0 else None

    def _over(self, times: FloatArray, columns: Columns) -> Iterator[dict[str, FloatArray]]:
        """Yield each predicate's distance, then its truth (+inf, -inf), at every sample: both from one program."""
        outputs = {
            name: outputs_under(leaf.formula, self._semantics, self._roles)
            for name, leaf in self._leaves.items()
        }
        read = tuple(f for name, both in outputs.items() if not self._leaves[name].fixed for f in both)
        recording = self._recording(times, columns, tuple(columns))
        signals = dict(zip(read, self._evaluate(read, recording), strict=True)) if read else {}
        for output in range(2):
            found = {}
            for name, both in outputs.items():
                signal = signals.get(both[output])
                if signal is None:  # it reads no variable: one value for ever
                    found[name] = reference.evaluate(both[output], {}, 1, Fraction(1))
                else:
                    last = np.searchsorted(signal.times, times, side="right") - 1
                    found[name] = signal.values[last]
            yield found

    def _value(self, times: FloatArray, predicates: Columns, n: int, *, best: bool) -> float:
        """Return the robustness at the first instant if what follows n samples is at its best or worst."""
        columns: dict[str, FloatArray] = {}
        rest = 1 if self._samples is None else max(0, self._samples - n)
        for name, values in predicates.items():
            if self._leaves[name].fixed:
                columns[name] = np.full(n + rest, values[0])
                continue
            for sign in (1, -1):
                unknown = np.full(rest, inf if (sign > 0) == best else -inf)
                columns[literal(name, sign)] = np.concatenate((values[:n], unknown))
        later = times[n - 1] + float(self._step) * np.arange(1, rest + 1)
        recording = self._recording(np.concatenate((times[:n], later)), columns, tuple(columns))
        (signal,) = self._evaluate((self._over_predicates,), recording)
        return float(signal.values[0])

    def _recording(self, times: FloatArray, columns: Columns, names: tuple[str, ...]) -> DomainTrace:
        return self._domain.record({arrays.TIME: times, **columns}, names)


def _at_one_instant(formula: Formula) -> bool:
    return all(not isinstance(node, Apply) or node.op.tense is Tense.NONE for node in postorder(formula))
