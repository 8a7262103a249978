"""Compile many requirements to programs without formulas, see ``prepared.py``."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.compiler.stored import is_built_in
from rtamt.engine.backend import compiled_backend
from rtamt.language.contents import operators_of
from rtamt.language.formula import Apply, Var, fold, postorder
from rtamt.language.operators import builtin
from rtamt.lazy.dataclasses import replace
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import reach
from rtamt.signals.discrete import DISCRETE
from rtamt.verdicts.decompose import anchor
from rtamt.verdicts.prepared import Asked, Joined, Prepared, Window

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.compiler.program import Program
    from rtamt.compiler.stored import StoredPlan
    from rtamt.language.formula import Formula
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.verdicts.decompose import Anchored, Leaf

#: Registers of a program, of 2 KiB each: together half of a second-level cache of 1 MiB.
REGISTERS = 256


def is_storable(asked: Asked) -> str:
    """Return why no bytes can hold a requirement, as the end of a sentence; empty if they can."""
    formulas = [formula for formula in asked if formula is not None]
    if all(builtin(op.name) is op for op in operators_of(*formulas)):  # most
        return ""
    for node in postorder(*map(desugar, formulas)):
        if not is_built_in(node):
            assert isinstance(node, Apply)
            return f"uses the operator '{node.op.name}', whose code bytes cannot carry"
    return ""


def prepare(asked: Sequence[Asked], inputs: tuple[str, ...], domain: TimeDomain) -> list[Prepared]:
    """Compile requirements over the same inputs, in as few programs as their registers fit the cache.

    ``domain``: with a known step. Of every requirement the same is selected. Raises :class:`UsageError` for a custom
    operator, whose code bytes cannot carry.
    """
    whole = _prepared(asked, inputs, domain)
    if len(asked) > 1:
        plans = [plan for plan in (whole.robustness, whole.leaves) if plan is not None]
        most = max(_registers(program) for plan in plans for program in plan.programs())
        if most > REGISTERS:
            # So many parts at once as would be left after halving: the programs in between need not be compiled.
            size = max(1, len(asked) // 2 ** (most // REGISTERS).bit_length())
            parts = (asked[first : first + size] for first in range(0, len(asked), size))
            return [prepared for part in parts for prepared in prepare(part, inputs, domain)]
    return [whole]


def _prepared(asked: Sequence[Asked], inputs: tuple[str, ...], domain: TimeDomain) -> Prepared:
    step = domain.step
    assert step is not None, "a program has a fixed step"
    robustness = domain.ground(*(each.robustness for each in asked if each.robustness is not None))
    truths = [
        anchor(each) for each in domain.ground(*(each.truth for each in asked if each.truth is not None))
    ]
    found: dict[Leaf, int] = {}
    for truth in truths:
        for leaf in truth.leaves:
            found.setdefault(leaf, len(found))
    formulas = [leaf.formula for leaf in found]
    backend = compiled_backend(domain)
    first = second = None
    if not domain.held_at_end:
        together = tuple(dict.fromkeys((*robustness, *formulas)))
        first = second = backend.stored(together, step, inputs) if together else None
        places, needed = (_places(each, together) for each in (robustness, formulas))
    else:
        once = tuple(dict.fromkeys(robustness)), tuple(dict.fromkeys(formulas))
        first, second = (backend.stored(each, step, inputs) if each else None for each in once)
        places, needed = _places(robustness, once[0]), _places(formulas, once[1])
    windows = {
        number: Window(
            place,
            leaf.reduce,
            int(leaf.begin / step),
            None if leaf.end is None else int(leaf.end / step),
            reach(desugar(leaf.formula), step) + 1 if domain.held_at_end and leaf.end is None else 0,
        )
        for (leaf, number), place in zip(found.items(), needed, strict=True)
    }
    joining, joined = _joining(truths, found) if truths else (None, ())
    return Prepared(domain, inputs, first, second, joining, windows, tuple(places), joined)


def _places(formulas: Sequence[Formula], among: Sequence[Formula]) -> list[int]:
    """Return the index of each formula among others that are all different."""
    places = {formula: place for place, formula in enumerate(among)}
    return [places[formula] for formula in formulas]


def _joining(truths: Sequence[Anchored], found: Mapping[Leaf, int]) -> tuple[StoredPlan, tuple[Joined, ...]]:
    """Return the program that joins leaves, and where it has the truth of each requirement."""
    formulas: dict[Formula, int] = {}
    joined = []
    for truth in truths:
        numbers = [found[leaf] for leaf in truth.leaves]

        def renamed(node: Formula, args: tuple[Formula, ...], numbers: list[int] = numbers) -> Formula:
            if isinstance(node, Var):
                return Var(f"#{numbers[int(node.name[1:])]}")
            return replace(node, args=args) if isinstance(node, Apply) else node

        value = formulas.setdefault(fold(truth.skeleton, renamed), len(formulas))
        parts: list[tuple[int | None, int | None]] = []
        for part in truth.conjuncts():
            leaf = truth.leaf(part)
            if leaf is not None and leaf.reduce == "min":
                parts.append((found[leaf], None))
            else:
                parts.append((None, formulas.setdefault(fold(part, renamed), len(formulas))))
        joined.append(Joined(value, tuple(numbers), tuple(parts)))
    return compiled_backend(DISCRETE).stored(tuple(formulas), Fraction(1), ()), tuple(joined)


def _registers(program: Program) -> int:
    places = compiled_backend(program.domain).layout(program)
    return 1 + max((place.register for place in places if place.register is not None), default=-1)
