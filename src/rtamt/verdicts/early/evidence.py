"""The evidence of a verdict: a minimal set of the samples so far that decides it alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError
from rtamt.language.formula import Apply, postorder
from rtamt.language.operators import Bounds, Tense
from rtamt.rewrite.desugar import desugar
from rtamt.signals.outcomes import Cause, Verdict, VerdictRun

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula

    #: The time of an update, in steps and in the caller's form, and its values.
    Sample = tuple[float, Any, Mapping[str, Any]]
    #: A variable of a sample: the place of the sample, and the name.
    Item = tuple[int, str]


#: Samples that are kept at least.
_FEW = 64


class Evidence:
    """The samples of a monitor of verdicts, as far back as a verdict that it reports may depend on them.

    ``span``: how far back, in steps; None: all of them are kept. ``continuous``: whether a sample holds its value
    up to the next one of its variable.
    """

    def __init__(self, span: int | None, *, continuous: bool) -> None:
        self._span, self._continuous = span, continuous
        self._samples: list[Sample] = []
        self._newest: dict[str, float] = {}
        self._limit = _FEW

    def take(self, step: float, time: Any, values: Mapping[str, Any]) -> None:
        """Remember a sample; ``step``: its time in steps."""
        self._samples.append((step, time, dict(values)))
        self._newest.update(dict.fromkeys(values, step))
        if self._span is not None and len(self._samples) > self._limit:
            self._trim(min(self._newest.values()) - self._span)
            self._limit = 2 * len(self._samples) + _FEW

    def _trim(self, begin: float) -> None:
        """Drop the samples before a step, except for values that still hold then."""
        kept: list[Sample] = []
        held: set[str] = set()
        for step, time, values in reversed(self._samples):
            if step >= begin:
                kept.append((step, time, values))
            elif self._continuous and not held.issuperset(values):
                kept.append((step, time, values))
                held.update(values)
        self._samples = kept[::-1]

    def copied(self) -> Evidence:
        """Return an independent copy."""
        twin = Evidence(self._span, continuous=self._continuous)
        twin._samples, twin._newest, twin._limit = list(self._samples), dict(self._newest), self._limit
        return twin

    def causes(
        self, verdict: Verdict | VerdictRun, decided: float, monitor: Callable[[], Any], *, ended: bool
    ) -> list[Cause]:
        """Return the samples that decide a verdict without any other.

        ``decided``: when it was decided, in steps. ``monitor``: makes a new monitor, without evidence; ``ended``:
        whether the trace has ended.
        """
        samples = self._samples
        # Those of a variable that lags behind may be earlier than what arrived before them.
        last = max((place for place, (step, _, _) in enumerate(samples) if step == decided), default=-1)
        items = [
            (place, name)
            for place, (_, _, values) in enumerate(samples[: last + 1])
            for name, value in values.items()
            if value is not None
        ]

        def decide(some: Sequence[Item], finish: bool) -> bool:
            return _decides(set(some), samples, verdict, monitor(), finish=finish)

        finish = not decide(items, False)
        if finish and not (ended and decide(items, True)):
            raise UsageError(
                f"the samples that decided {verdict!r} are not remembered any more, or it is not of this monitor"
            )
        kept = _least(items, lambda some: decide(some, finish))
        return [Cause(name, samples[place][1], samples[place][2][name]) for place, name in kept]


def _least(items: list[Item], enough: Callable[[Sequence[Item]], bool]) -> list[Item]:
    """Return items that are enough, and without any one of them are not; more items are never less."""
    size = len(items)
    while size:
        place = 0
        while place < len(items):
            rest = [*items[:place], *items[place + size :]]
            if enough(rest):
                items = rest
            else:
                place += size
        size //= 2
    return items


def _decides(
    kept: set[Item], samples: Sequence[Sample], verdict: Verdict | VerdictRun, monitor: Any, *, finish: bool
) -> bool:
    """Return whether a monitor gives a verdict if all values but some are missing."""
    found: list[Any] = []
    try:
        for place, (_, time, values) in enumerate(samples):
            found += monitor.update(
                time, **{name: value if (place, name) in kept else None for name, value in values.items()}
            )
        found += monitor.finish() if finish else []
    except StlError:  # there is nothing to report without the samples that are left out
        return False
    same = [each for each in found if each.satisfied == verdict.satisfied]
    if isinstance(verdict, Verdict):
        return any(each.time == verdict.time for each in same)
    begin = verdict.begin
    for run in sorted(same, key=lambda each: each.begin):
        if run.begin <= begin < run.end:
            begin = run.end
    return bool(begin >= verdict.end)


def span_of(formula: Formula, step: Fraction) -> int | None:
    """Return how many steps apart samples that decide the verdict of an instant, and its report, lie at most.

    None if they may be arbitrarily far apart.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> [span_of(parse_formula(t), Fraction(1)) for t in ("once[0:3] always[1:2](x > 0)", "historically(x > 0)")]
    [10, None]
    """
    reach = 0
    for node in postorder(desugar(formula)):
        if not isinstance(node, Apply) or node.op.tense is Tense.NONE:
            continue
        if node.op.bounds is Bounds.NONE and node.op.kernel is not None and node.op.reach == 1:
            reach += 1
        elif node.interval is None or node.interval.end is None:
            return None
        else:
            reach += int(node.interval.end / step)
    return 2 * reach
