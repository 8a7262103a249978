"""Quantifiers over the members of a group, by brute force and straight from the semantics.

This oracle shares nothing with the library, not even the parser: a formula is a nested tuple, ``text`` writes
it in the language. In discrete time entry t of a list is the value at sample t; in dense time it is the value
on the cell [t, t + 1), counted in ticks, and the last cell stands for the rest of time.

A body is evaluated on the instants T at which all its members are present: a window, a delay or a hold sees
nothing else, as if the members had a trace of their own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    Node = tuple[Any, ...]
    Values = list[Any]  # of None outside T

inf = math.inf

#: The members of the enumeration of the field ``mode``, with their codes.
MODES = {"Idle": 0.0, "Busy": 4.0}

COMPARISONS: dict[str, tuple[Callable[[float, float], float], Callable[[float, float], bool]]] = {
    ">=": (lambda x, y: x - y, lambda x, y: x >= y),
    ">": (lambda x, y: x - y, lambda x, y: x > y),
    "<=": (lambda x, y: y - x, lambda x, y: x <= y),
    "<": (lambda x, y: y - x, lambda x, y: x < y),
}
ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": lambda x, y: x + y,
    "-": lambda x, y: x - y,
    "*": lambda x, y: x * y,
}


class Group(NamedTuple):
    """The members of a group: per member and field a value for each entry, None where it is absent."""

    members: Mapping[str, Mapping[str, Sequence[float | None]]]

    def present(self, member: str, t: int) -> bool:
        return all(values[t] is not None for values in self.members[member].values())


class World(NamedTuple):
    """What is known: ordinary signals, groups, the length of a step in seconds, the time domain."""

    signals: Mapping[str, Sequence[float]]
    groups: Mapping[str, Group]
    size: int
    step: float
    dense: bool


def evaluate(world: World, formula: Node, *, truth: bool = False) -> Values:
    """Return the robustness, or the truth, of a closed formula at every entry."""
    return _Scope(world, {}, list(range(world.size))).formula(formula, truth=truth)


class _Scope:
    """A body with its members, and the instants at which it has a meaning."""

    def __init__(self, world: World, bound: Mapping[str, tuple[str, str]], instants: list[int]) -> None:
        self.world, self.bound, self.instants = world, bound, instants

    def entries(self, value: Callable[[int], Any]) -> Values:
        inside = set(self.instants)
        return [value(t) if t in inside else None for t in range(self.world.size)]

    def window(self, t: int, first: float, last: float) -> list[int]:
        """Return the instants of T from t + first to t + last."""
        if self.world.dense and last >= 0:
            # The last cell is the rest of time.
            end = self.world.size - 1
            low, high = min(t + first, end), min(t + last, end)
            return [u for u in self.instants if low <= u <= high]
        return [u for u in self.instants if t + first <= u <= t + last]

    # ---- formulas --------------------------------------------------------------------------------

    def formula(self, node: Node, *, truth: bool) -> Values:
        top, bottom = (True, False) if truth else (inf, -inf)
        kind, *rest = node

        def negate(v: Any) -> Any:
            return not v if truth else -v

        def below(child: Node) -> Values:
            return self.formula(child, truth=truth)

        def least(values: list[Any]) -> Any:
            return min(values, default=top)

        def greatest(values: list[Any]) -> Any:
            return max(values, default=bottom)

        if kind in COMPARISONS:
            x, y = map(self.number, rest)
            compare = COMPARISONS[kind][truth]
            return self.entries(lambda t: compare(x[t], y[t]))
        if kind in ("truth", "mode"):
            group, member = self.bound[rest[0]]
            values = self.world.groups[group].members[member]["on" if kind == "truth" else "mode"]
            wanted = 1.0 if kind == "truth" else MODES[rest[1]]
            return self.entries(lambda t: top if values[t] == wanted else bottom)
        if kind == "not":
            p = below(rest[0])
            return self.entries(lambda t: negate(p[t]))
        if kind in ("and", "or"):
            p, q = map(below, rest)
            pick = min if kind == "and" else max
            return self.entries(lambda t: pick(p[t], q[t]))
        if kind in ("always", "eventually", "historically", "once"):
            a, b, child = rest
            p = below(child)
            join = least if kind in ("always", "historically") else greatest
            past = kind in ("historically", "once")
            return self.entries(
                lambda t: join([p[u] for u in (self.window(t, -b, -a) if past else self.window(t, a, b))])
            )
        if kind == "since":
            a, b, *children = rest
            p, q = map(below, children)
            return self.entries(
                lambda t: greatest([least([q[u], *self.held(p, u, t)]) for u in self.window(t, -b, -a)])
            )
        if kind == "until":
            a, b, *children = rest
            p, q = map(below, children)
            return self.entries(
                lambda t: greatest([least([q[u], *self.kept(p, t, u, a)]) for u in self.window(t, a, b)])
            )
        if kind in ("rise", "fall"):
            p = below(rest[0])

            def edge(t: int) -> Any:
                before = p[t - 1] if t - 1 in self.instants else None
                if kind == "rise":
                    return least([p[t]] if before is None else [p[t], negate(before)])
                return least([negate(p[t])] if before is None else [negate(p[t]), before])

            return self.entries(edge)
        if kind in ("prev", "s_prev", "next", "s_next"):
            p = below(rest[0])
            shift = -1 if "prev" in kind else 1
            outside = bottom if kind.startswith("s_") else top
            return self.entries(lambda t: p[t + shift] if t + shift in self.instants else outside)
        if kind in ("forall", "exists"):
            bodies = [scope.formula(rest[-1], truth=truth) for scope in self.each(*rest[:-1])]
            join = least if kind == "forall" else greatest
            return self.entries(lambda t: join([p[t] for p in bodies if p[t] is not None]))
        raise AssertionError(kind)

    def held(self, p: Values, u: int, t: int) -> Values:
        """Return what p is after u and up to t; in dense time a part of u's own cell lies between."""
        if u == t:
            return []
        return [p[j] for j in self.instants if (u <= j if self.world.dense else u < j) and j <= t]

    def kept(self, p: Values, t: int, u: int, a: int) -> Values:
        """Return what p is from t until just before u."""
        own = self.world.dense and u == min(t + a, self.world.size - 1) and a > 0
        return [p[j] for j in self.instants if t <= j and (j <= u if own else j < u)]

    # ---- groups ------------------------------------------------------------------------------------

    def each(self, name: str, group: str, other: str | None) -> list[_Scope]:
        """Return a scope per member of the group, apart from the one that ``other`` stands for."""
        members = self.world.groups[group]
        taken = self.bound[other] if other else None
        return [
            _Scope(
                self.world,
                {**self.bound, name: (group, member)},
                [t for t in self.instants if members.present(member, t)],
            )
            for member in members.members
            if (group, member) != taken
        ]

    # ---- numbers -----------------------------------------------------------------------------------

    def number(self, node: Node) -> Values:
        kind, *rest = node
        if kind == "value":
            return self.entries(lambda _: rest[0])
        if kind == "signal":
            return self.entries(lambda t: self.world.signals[rest[0]][t])
        if kind == "field":
            group, member = self.bound[rest[0]]
            return self.entries(lambda t: self.world.groups[group].members[member][rest[1]][t])
        if kind in ARITHMETIC:
            x, y = map(self.number, rest)
            return self.entries(lambda t: ARITHMETIC[kind](x[t], y[t]))
        if kind == "number of":
            bodies = [scope.formula(rest[-1], truth=True) for scope in self.each(*rest[:-1])]
            return self.entries(lambda t: float(sum(p[t] for p in bodies if p[t] is not None)))
        if kind in ("delay", "ahead"):
            d, child = rest
            x = self.number(child)
            if kind == "delay":
                return self.entries(lambda t: x[t - d] if t - d in self.instants else x[self.instants[0]])
            return self.entries(lambda t: x[max(u for u in self.instants if u <= t + d)])
        if kind == "held":
            child, condition = rest
            x, p = self.number(child), self.formula(condition, truth=True)

            def last(t: int) -> Any:
                past = [u for u in self.instants if u <= t and p[u]]
                return x[past[-1] if past else self.instants[0]]

            return self.entries(last)
        if kind == "if":
            condition, yes, no = rest
            p, x, y = self.formula(condition, truth=True), self.number(yes), self.number(no)
            return self.entries(lambda t: x[t] if p[t] else y[t])
        if kind in ("minimum", "maximum", "sum", "mean"):
            a, b, child = rest
            x = self.number(child)

            def over(t: int) -> float:
                values = [x[u] for u in self.window(t, -b, -a)]
                if kind == "minimum":
                    return min(values, default=inf)
                if kind == "maximum":
                    return max(values, default=-inf)
                if kind == "sum":
                    return float(sum(values))
                return float(sum(values) / len(values)) if values else x[self.instants[0]]

            return self.entries(over)
        if kind in ("duration", "count"):
            a, b, child = rest
            p = self.formula(child, truth=True)

            def amount(t: int) -> float:
                window = self.window(t, -b, -a)
                if kind == "duration":
                    return sum(p[u] for u in window) * self.world.step
                return float(sum(p[u] and not (u - 1 in self.instants and p[u - 1]) for u in window))

            return self.entries(amount)
        raise AssertionError(kind)


# ---- the same formula in the language -------------------------------------------------------------------


def text(node: Node) -> str:
    """Return a formula as text, with parentheses around everything."""
    kind, *rest = node
    if kind == "value":
        return f"{rest[0]:g}" if rest[0] >= 0 else f"(-{-rest[0]:g})"
    if kind == "signal":
        return str(rest[0])
    if kind in ("field", "truth"):
        return f"{rest[0]}.{rest[1]}"
    if kind == "mode":
        return f"({rest[0]}.mode == {rest[1]})"
    if kind in COMPARISONS or kind in ARITHMETIC or kind in ("and", "or"):
        return f"({text(rest[0])} {kind} {text(rest[1])})"
    if kind in ("forall", "exists", "number of"):
        name, group, other, body = rest
        word = "count" if kind == "number of" else kind
        where = f" where {name} != {other}" if other else ""
        return f"({word} {name} in {group}{where}: {text(body)})"
    if kind == "if":
        return f"(if {text(rest[0])} then {text(rest[1])} else {text(rest[2])})"
    if kind in ("since", "until"):
        a, b, p, q = rest
        return f"({text(p)} {kind}{_bounds(a, b)} {text(q)})"
    if kind in ("delay", "ahead"):
        return f"{kind}[{rest[0]}]({text(rest[1])})"
    if len(rest) == 3 and not isinstance(rest[0], tuple):
        return f"{kind}{_bounds(*rest[:2])}({text(rest[2])})"
    return f"{kind}({', '.join(map(text, rest))})"


def _bounds(a: int, b: float) -> str:
    return "" if (a, b) == (0, inf) else f"[{a},{'inf' if b == inf else int(b)}]"
