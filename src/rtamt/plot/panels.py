"""The assignment of signals to panels: a predicate's signals share one, unless their units differ."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Var
from rtamt.language.parsing.grammar import is_predicate as is_comparison
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.language.formula import Formula


@dataclass(frozen=True, slots=True)
class Group:
    """Names of signals in one panel, and the numbers that predicates compare them with."""

    names: tuple[str, ...]
    thresholds: tuple[float, ...]


def groups(
    names: Iterable[str], predicates: Iterable[Formula], units: Mapping[str, str] = MappingProxyType({})
) -> tuple[Group, ...]:
    """Return the panels, in the order of the names. ``units``: those that are known.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> groups(["a", "b", "c"], [parse_formula("a <= c"), parse_formula("b >= 3")])
    (Group(names=('a', 'c'), thresholds=()), Group(names=('b',), thresholds=(3.0,)))
    >>> close = parse_formula("gap <= 2 * speed")
    >>> [group.names for group in groups(["gap", "speed"], [close], {"gap": "m", "speed": "m/s"})]
    [('gap',), ('speed',)]
    """
    group_of = {name: {name} for name in names}
    limits: dict[str, list[float]] = {name: [] for name in group_of}
    for predicate in predicates:
        read = [name for name in variables(predicate) if name in group_of]
        for name in read[1:]:
            merged = group_of[read[0]] | group_of[name]
            if len({units[member] for member in merged if member in units}) <= 1:
                group_of.update(dict.fromkeys(merged, merged))
        limit = _threshold(predicate)
        if limit is not None:
            limits[read[0]].append(limit)
    found = dict.fromkeys(tuple(sorted(group, key=list(group_of).index)) for group in group_of.values())
    return tuple(
        Group(members, tuple(dict.fromkeys(limit for name in members for limit in limits[name])))
        for members in found
    )


def _threshold(predicate: Formula) -> float | None:
    """Return the number with which a predicate compares a signal as it is."""
    if not (isinstance(predicate, Apply) and is_comparison(predicate.op)):
        return None
    constants = [argument for argument in predicate.args if isinstance(argument, Const)]
    return constants[0].value if constants and any(isinstance(arg, Var) for arg in predicate.args) else None
