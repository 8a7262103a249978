"""The meaning of a FRETish sentence on a finite trace, from its fields: intervals, triggers, obligations.

Written from the published semantics (Giannakopoulou et al., "Automated formalization of structured natural language
requirements", IST 2021), with sets of instants and no formula.
"""

from __future__ import annotations

from collections.abc import Sequence

Truth = Sequence[bool]


def intervals(scope: str, mode: Truth, *, only: bool) -> list[tuple[int, int]]:
    """Return the intervals of a scope as pairs of their first and last instants."""
    n = len(mode)
    first = next((t for t in range(n) if mode[t]), None)
    if scope == "":
        active = [True] * n
    elif scope in ("in", "notin"):
        active = [m == (scope == "in") for m in mode]
    elif scope == "before":
        active = [first is None or t < first for t in range(n)]
    else:
        end = None if first is None else next((t for t in range(first, n) if not mode[t]), None)
        active = [end is not None and t >= end for t in range(n)]
    if only:
        active = [not each for each in active]
    starts = [t for t in range(n) if active[t] and (t == 0 or not active[t - 1])]
    return [(a, next((t - 1 for t in range(a, n) if not active[t]), n - 1)) for a in starts]


def triggers(interval: tuple[int, int], condition: Truth | None, *, holding: bool) -> list[int]:
    """Return the instants of an interval at which an obligation starts."""
    a, b = interval
    if condition is None:
        return [a]
    held = [t for t in range(a, b + 1) if condition[t]]
    return held if holding else [t for t in held if t == a or not condition[t - 1]]


def met(timing: str, t: int, end: int, r: Truth, stop: Truth, n: int) -> bool | None:
    """Return whether the obligation of instant ``t`` is met in an interval that ends at ``end``; None: don't care."""
    first_stop = next((s for s in range(t, end + 1) if stop[s]), None)
    near = range(t, min(t + n, end) + 1)
    match timing:
        case "immediately":
            return r[t]
        case "next":
            return r[t + 1] if t < end else None
        case "always":
            return all(r[t : end + 1])
        case "never":
            return not any(r[t : end + 1])
        case "eventually":
            return any(r[t : end + 1])
        case "finally":
            return r[end]
        case "within":
            return any(r[s] for s in near) if t + n <= end else None
        case "for":
            return all(r[s] for s in near)
        case "after":
            return not any(r[s] for s in near) and (t + n + 1 > end or r[t + n + 1])
        case "until":
            return all(r[t : end + 1 if first_stop is None else first_stop])
        case _:
            return None if first_stop is None else any(r[t:first_stop])


def unmet(timing: str, t: int, end: int, r: Truth, stop: Truth, n: int) -> bool | None:
    """Return whether the timing is certainly not met from ``t`` on, which scopes with "only" require."""
    if timing == "within":  # not even in what is left of the interval
        return not any(r[s] for s in range(t, min(t + n, end) + 1))
    if timing == "for" and t + n > end:
        return None
    if timing == "after" and t + n + 1 > end:
        return None
    if timing in ("until", "before") and not any(stop[t : end + 1]):
        return None if timing == "until" else not any(r[t : end + 1])
    found = met(timing, t, end, r, stop, n)
    return None if found is None else not found


def holds(
    timing: str,
    response: Truth,
    *,
    scope: str = "",
    mode: Truth = (),
    only: bool = False,
    condition: Truth | None = None,
    holding: bool = False,
    stop: Truth = (),
    samples: int = 0,
) -> bool:
    """Return whether a sentence with these fields holds on a trace, given by the truth of its formulas."""
    n = len(response)
    where = intervals(scope, mode if scope else [False] * n, only=only)
    check = unmet if only else met
    return all(
        check(timing, t, each[1], response, stop, samples) is not False
        for each in where
        for t in triggers(each, condition, holding=holding)
    )
