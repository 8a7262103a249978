"""Ten families of timed requirements after Timescales, and signals for which every verdict is known.

The families and their formulas are those that D. Ulus published ("Timescales: A Benchmark Generator for
MTL Monitoring Tools", RV 2019), with a future form of each beside it; the generator is our own. Signals
are 1 or -1. A trace repeats one pattern, which satisfies the formula of either form at every sample; or
the pattern in its middle is broken, and the past form is violated from a sample on that is known.
"""

LOWER, UPPER = 3, 10  # bounds in units; units are 1, 10 and 100 samples

_BETWEEN = "(r > 0 and not(q > 0) and once(q > 0)) -> "
_UNTIL_R = "(q > 0 and not(r > 0) and eventually(r > 0)) -> "
_ANSWERED = "((z > 0) -> once[{l}:{u}](p > 0)) and not(not(z > 0) since[{u}:inf] (p > 0))"

#: Of each family the past form and the future form; {l} and {u} are the bounds.
FAMILIES = {
    "absence after q": (
        "historically(once[0:{u}](q > 0) -> (not(p > 0) since (q > 0)))",
        "always((q > 0) -> always[0:{u}](not(p > 0)))",
    ),
    "absence before r": (
        "historically((r > 0) -> historically[0:{u}](not(p > 0)))",
        "always(eventually[0:{u}](r > 0) -> (not(p > 0) until (r > 0)))",
    ),
    "absence between q and r": (
        f"historically({_BETWEEN}(not(p > 0) since[{{l}}:{{u}}] (q > 0)))",
        f"always({_UNTIL_R}(not(p > 0) until[{{l}}:{{u}}] (r > 0)))",
    ),
    "always after q": (
        "historically(once[0:{u}](q > 0) -> ((p > 0) since (q > 0)))",
        "always((q > 0) -> always[0:{u}](p > 0))",
    ),
    "always before r": (
        "historically((r > 0) -> historically[0:{u}](p > 0))",
        "always(eventually[0:{u}](r > 0) -> ((p > 0) until (r > 0)))",
    ),
    "always between q and r": (
        f"historically({_BETWEEN}((p > 0) since[{{l}}:{{u}}] (q > 0)))",
        f"always({_UNTIL_R}((p > 0) until[{{l}}:{{u}}] (r > 0)))",
    ),
    "recurrence globally": (
        "historically(once[0:{u}](p > 0))",
        "always(eventually[0:{u}](p > 0))",
    ),
    "recurrence between q and r": (
        f"historically({_BETWEEN}(once[0:{{u}}](p > 0 or q > 0) since (q > 0)))",
        f"always({_UNTIL_R}(eventually[0:{{u}}](p > 0 or r > 0) until (r > 0)))",
    ),
    "response globally": (
        f"historically({_ANSWERED})",
        "always((p > 0) -> eventually[{l}:{u}](z > 0))",
    ),
    "response between q and r": (
        f"historically({_BETWEEN}(({_ANSWERED}) since (q > 0)))",
        f"always({_UNTIL_R}(((p > 0) -> (not(r > 0) until[{{l}}:{{u}}] (z > 0 and not(r > 0)))) until (r > 0)))",
    ),
}


def formula(family, unit, form):
    """Return the formula of a family, ``form`` "past" or "future", with bounds of so many samples a unit."""
    return FAMILIES[family][form == "future"].format(l=LOWER * unit, u=UPPER * unit)


def _pattern(family, unit, wrong):
    """Return where each signal is 1 in a pattern, its length, and where the past form fails if it is wrong."""
    low, up = LOWER * unit, UPPER * unit
    half = (low + up) // 2
    kind, _, scope = family.partition(" ")
    if kind in ("absence", "always"):  # p where it may be; "always" is absence of its opposite
        spoilt = [half // 2] if wrong else []
        if scope == "after q":
            return {"q": [0], "p": [up + 1, *spoilt]}, up + 3, half // 2
        if scope == "before r":
            spoilt = [up + 2 - half // 2] if wrong else []
            return {"r": [up + 2], "p": [0, *spoilt]}, up + 4, up + 2
        return {"q": [0], "r": [half], "p": [half + 1, *spoilt]}, half + 4, half
    if kind == "recurrence":
        times = [up] if wrong else [up, 2 * up]
        if scope == "globally":
            return {"p": [0, *times]}, 3 * up, 2 * up + 1
        return {"q": [0], "r": [3 * up + up // 2], "p": [*times, 3 * up]}, 4 * up, 3 * up + up // 2
    answer = [] if wrong else [1 + half]
    if scope == "globally":
        return {"p": [1], "z": answer}, up + 4, 1 + up
    return {"q": [0], "p": [1], "z": answer, "r": [up + 3]}, up + 6, up + 3


def _column(ones, length):
    """Return a pattern's samples of one signal."""
    column = [-1.0] * length
    for at in ones:
        column[at] = 1.0
    return column


def violated_at(family, unit, n):
    """Return the first sample at which the past form is violated where the trace of n samples is wrong."""
    _, length, failure = _pattern(family, unit, wrong=True)
    return n // length // 2 * length + failure


def signals(family, unit, n, *, wrong=False):
    """Return n samples of each variable; with one pattern broken, in the middle, if ``wrong``."""
    ones, length, _ = _pattern(family, unit, wrong=False)
    broken, _, _ = _pattern(family, unit, wrong=True)
    cycles = n // length
    columns = {}
    for name in ones:
        right = _column(ones[name], length)
        column = columns[name] = right * cycles + [-1.0] * (n - cycles * length)  # ends in silence
        if wrong:
            begin = cycles // 2 * length
            column[begin : begin + length] = _column(broken[name], length)
    if family == "recurrence globally":
        for at in (*range(n // length * length, n, UPPER * unit), n - 1):
            columns["p"][at] = 1.0
    if family.startswith("always"):
        columns["p"] = [-value for value in columns["p"]]
    return columns
