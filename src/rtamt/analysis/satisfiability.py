"""Queries about one or two specifications, as functions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.analysis.bounded_checker import LIMIT, SAMPLES, BoundedChecker, Conclusion, Part

if TYPE_CHECKING:
    from rtamt.specification import Specification


def satisfiable(spec: Specification, *, samples: int = SAMPLES, limit: float = LIMIT) -> Conclusion:
    """Answer whether some trace satisfies a specification; of several requirements, all of them.

    ``samples``: the length of the trace. ``limit``: seconds that a query may take.

    >>> import rtamt
    >>> from rtamt.analysis import satisfiable
    >>> print(satisfiable(rtamt.parse("always(x > 3) and eventually[0:5](x < 2)")))
    no trace of 200 samples satisfies it
    """
    checker = BoundedChecker([spec], samples, limit)
    return checker.satisfiable(_whole(spec))


def valid(spec: Specification, *, samples: int = SAMPLES, limit: float = LIMIT) -> Conclusion:
    """Return whether every trace of at most ``samples`` samples satisfies a specification.

    >>> import rtamt
    >>> from rtamt.analysis import valid
    >>> answer = valid(rtamt.parse("always(x > 3 -> eventually[0:5](x > 2))"))
    >>> print(answer)
    it always holds: no counterexample up to 200 samples
    >>> answer.holds
    True
    """
    return BoundedChecker([spec], samples, limit).valid(_whole(spec))


def implies(
    first: Specification, second: Specification, *, samples: int = SAMPLES, limit: float = LIMIT
) -> Conclusion:
    """Answer whether every trace that satisfies the first specification satisfies the second.

    Ranges and rates are assumed of the signals: those that one specification declares hold for the other one, too.

    >>> import rtamt
    >>> from rtamt.analysis import implies
    >>> soon, later = rtamt.parse("eventually[0:5](x > 3)"), rtamt.parse("eventually[0:10](x > 3)")
    >>> print(implies(soon, later))
    the first implies the second: no counterexample of any length
    >>> answer = implies(later, soon)
    >>> answer.holds, answer.witness.samples > 6, answer.witness.confirmed
    (False, True, True)
    """
    return BoundedChecker([first, second], samples, limit).implies(_whole(first), _whole(second))


def equivalent(
    first: Specification, second: Specification, *, samples: int = SAMPLES, limit: float = LIMIT
) -> Conclusion:
    """Answer whether two specifications have the same verdict on every trace, within the limits that either declares.

    >>> import rtamt
    >>> from rtamt.analysis import equivalent
    >>> print(equivalent(rtamt.parse("not always(x > 3)"), rtamt.parse("eventually(x <= 3)")))
    they agree: no counterexample up to 200 samples
    """
    return BoundedChecker([first, second], samples, limit).equivalent(_whole(first), _whole(second))


def _whole(spec: Specification) -> Part:
    return Part("", spec)
