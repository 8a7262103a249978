"""The formula of a sentence: what FRET's semantics for finite traces requires.

The scope gives intervals of the trace: throughout, each maximal interval in a mode, or what is before or after it. In
each interval the condition gives triggers: the instants at which it becomes true, or is true as the interval begins.
Each trigger starts an obligation, which ends with the interval. (D. Giannakopoulou, T. Pressburger, A. Mavridou,
J. Schumann, "Automated formalization of structured natural language requirements", IST 2021.)

Here an interval is a formula ``inside``, true at its instants, None for the whole trace. ``trigger`` is true where an
obligation starts, None for the first instant alone. A window that reaches beyond the interval or beyond the trace
requires nothing, other than a bare ``eventually``, which a trace that ends too early violates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Interval
from rtamt.language.operators import STL
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from rtamt.language.formula import Formula


def negation(a: Formula) -> Formula:
    """Return ``not a``, without two negations in a row."""
    return a.args[0] if isinstance(a, Apply) and a.op is STL["not"] else STL["not"](a)


def both(a: Formula, b: Formula) -> Formula:
    """Return ``a and b``."""
    return STL["and"](a, b)


def either(a: Formula, b: Formula) -> Formula:
    """Return ``a or b``."""
    return STL["or"](a, b)


def window(operator: str, begin: Fraction, end: Fraction, *args: Formula) -> Formula:
    """Return an operator over the window from ``begin`` to ``end`` seconds."""
    return STL[operator](*args, interval=Interval(begin, end))


def _always(a: Formula) -> Formula:
    return STL["always"](a)


def _implies(a: Formula, b: Formula) -> Formula:
    return STL["implies"](a, b)


# ---- scopes --------------------------------------------------------------------------------------


def inside(scope: str, mode: Formula, *, only: bool) -> Formula:
    """Return the formula that is true in the intervals of a scope; with ``only``, outside of them.

    Args:
        scope: in, notin, before or after.
        mode: the mode, or the condition that stands for one.
        only: whether the intervals are those that the scope leaves.
    """
    # After the first interval of the mode: it is not the mode now or before, and was the mode before that.
    ended = STL["once"](both(negation(mode), STL["once"](mode)))
    within, outside = {
        "in": (mode, negation(mode)),
        "notin": (negation(mode), mode),
        "before": (STL["historically"](negation(mode)), STL["once"](mode)),
        "after": (ended, negation(ended)),
    }[scope]
    return outside if only else within


# ---- timings -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Obligation:
    """The inputs of timings: the formulas of the interval, the trigger, the response and the stop, and the duration.

    ``step`` is the sampling period, ``duration`` that of the timing, both in seconds.
    """

    response: Formula
    step: Fraction
    inside: Formula | None = None
    trigger: Formula | None = None
    stop: Formula | None = None
    duration: Fraction | None = None

    def starts(self, obligation: Formula) -> Formula:
        """Return the formula for: an obligation holds at each trigger."""
        return obligation if self.trigger is None else _always(_implies(self.trigger, obligation))

    def throughout(self, a: Formula) -> Formula:
        """Return the formula for: a formula holds from each trigger to the end of its interval."""
        if self.trigger is None:
            return _always(a)
        if self.inside is None:
            return _always(_implies(STL["once"](self.trigger), a))
        if self.trigger == STL["rise"](self.inside):
            return _always(_implies(self.inside, a))
        return _always(_implies(STL["since"](self.inside, self.trigger), a))

    def for_a_while(self, begin: Fraction, end: Fraction, a: Formula) -> Formula:
        """Return that a formula holds from ``begin`` to ``end`` after each trigger, as long as the interval lasts."""
        if self.inside is None or self.trigger is None:
            return self.starts(window("always", begin, end, a))
        return _always(_implies(window("since", begin, end, self.inside, self.trigger), a))

    def or_left(self, a: Formula) -> Formula:
        """Return the formula for: a formula holds, or the interval has ended."""
        return a if self.inside is None else either(a, negation(self.inside))

    @property
    def length(self) -> Fraction:
        """The duration of the timing."""
        assert self.duration is not None
        return self.duration

    @property
    def ending(self) -> Formula:
        """The formula of the stop."""
        assert self.stop is not None
        return self.stop


def _beyond(at: Fraction) -> Formula:
    """Return the formula for: the trace ends within ``at`` seconds."""
    return window("always", at, at, STL["false"]())


def _immediately(o: Obligation) -> Formula:
    return o.starts(o.response)


def _next(o: Obligation) -> Formula:
    return o.starts(STL["next"](o.response if o.inside is None else _implies(o.inside, o.response)))


def _throughout(o: Obligation) -> Formula:
    return o.throughout(o.response)


def _never(o: Obligation) -> Formula:
    return o.throughout(negation(o.response))


def _eventually(o: Obligation) -> Formula:
    if o.inside is None:
        return o.starts(STL["eventually"](o.response))
    return o.starts(STL["until"](o.inside, both(o.inside, o.response)))


def _finally(o: Obligation) -> Formula:
    last = STL["next"](STL["false"]() if o.inside is None else negation(o.inside))
    return o.throughout(_implies(last, o.response))


def _within(o: Obligation) -> Formula:
    n = o.length
    return o.starts(either(window("eventually", 0 * n, n, o.or_left(o.response)), _beyond(n)))


def _for(o: Obligation) -> Formula:
    return o.for_a_while(0 * o.length, o.length, o.response)


def _after(o: Obligation) -> Formula:
    n = o.length
    if o.inside is None or o.trigger is None:
        then = window("always", n + o.step, n + o.step, o.response)
        return o.starts(both(window("always", 0 * n, n, negation(o.response)), then))
    return both(
        o.for_a_while(0 * n, n, negation(o.response)), o.for_a_while(n + o.step, n + o.step, o.response)
    )


def _until(o: Obligation) -> Formula:
    return o.starts(STL["unless"](o.response, o.or_left(o.ending)))


def _before(o: Obligation) -> Formula:
    first = o.or_left(both(o.response, negation(o.ending)))
    return o.starts(STL["unless"](negation(o.ending), first))


def _not_after(o: Obligation) -> Formula:
    n = o.length
    early = window("eventually", 0 * n, n, o.or_left(o.response))
    return o.starts(either(early, window("always", n + o.step, n + o.step, o.or_left(negation(o.response)))))


#: Every timing of FRETish and its formula.
TIMINGS: dict[str, Callable[[Obligation], Formula]] = {
    "immediately": _immediately,
    "next": _next,
    "always": _throughout,
    "never": _never,
    "eventually": _eventually,
    "finally": _finally,
    "within": _within,
    "for": _for,
    "after": _after,
    "until": _until,
    "before": _before,
}

#: With ``only``, a timing must not be met outside the scope: the formula that says so, of the opposite response or,
#: where False, of the response itself.
_NOT_MET: dict[str, tuple[Callable[[Obligation], Formula], bool]] = {
    "immediately": (_immediately, True),
    "next": (_next, True),
    "always": (_eventually, True),
    "never": (_eventually, False),
    "eventually": (_never, False),
    "finally": (_finally, True),
    "within": (_for, True),
    "for": (_within, True),
    "after": (_not_after, False),
    "until": (_before, True),
    "before": (_until, True),
}


def formalize(
    timing: str,
    response: Formula,
    *,
    step: Fraction,
    scope: Formula | None = None,
    condition: Formula | None = None,
    holding: bool = False,
    only: bool = False,
    stop: Formula | None = None,
    duration: Fraction | None = None,
) -> Formula:
    """Return the formula of a sentence, which must hold at the first instant of a trace.

    Args:
        timing: one of :data:`TIMINGS`.
        response: what must hold.
        step: the sampling period in seconds.
        scope: true at the instants of the scope, see :func:`inside`; None for the whole trace.
        condition: what triggers the requirement; None for the first instant of each interval.
        holding: whether each instant of the condition triggers, not only the first one.
        only: whether the scope is one with "only": the timing must not be met there.
        stop: the condition after "until" or "before".
        duration: that of the timing, in seconds.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula as f
    >>> print(formalize("within", f("r >= 1"), step=Fraction(1), condition=f("c >= 1"), duration=Fraction(3)))
    always(rise(c >= 1) -> eventually[0:3](r >= 1) or always[3:3] false)
    """
    reached = condition if scope is None else scope if condition is None else both(scope, condition)
    trigger = reached if holding or reached is None else STL["rise"](reached)
    met, opposed = _NOT_MET[timing] if only else (TIMINGS[timing], False)
    return met(Obligation(negation(response) if opposed else response, step, scope, trigger, stop, duration))
