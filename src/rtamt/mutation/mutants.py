"""The mutants of a requirement: one small change each."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import StlError, UsageError, line_and_column
from rtamt.language.parsing.grammar import is_number
from rtamt.language.substitution import substituted
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.mutation.equal_formulas import Keys
from rtamt.mutation.operators import changes_of, describe_change

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class Mutant:
    """A requirement with one small change.

    ``number``: from 1 on. ``kind``: ``"operator"``, ``"threshold"`` or ``"bound"``. ``change``: the part before and
    after it. ``line`` and ``column``: where it is in the text; None where it is elsewhere, in an imported file.
    """

    number: int
    requirement: str
    kind: str
    change: str
    line: int | None
    column: int | None
    specification: Specification = field(repr=False, compare=False)

    @property
    def name(self) -> str:
        """The name of the mutant in reports: ``M12``."""
        return f"M{self.number}"


def mutants_of(spec: Specification, step: Fraction | None = None) -> list[Mutant]:
    """Return the mutants of the requirements of a specification, in the order of the text.

    Each differs from its requirement by one other operator (of the same operands, by the operator table), one constant
    that is a tenth larger or smaller, or one bound that is. A mutant that is trivially equal to the requirement, or to
    an earlier mutant, is left out: see :mod:`rtamt.mutation.equal_formulas`. ``step``: the sampling period, of which
    bounds are multiples in discrete time; by default that of the specification.

    Raises :class:`UsageError` if bounds have to be changed and no sampling period is known.

    >>> import rtamt
    >>> spec = rtamt.parse("always[0:5](x >= 3)", period=1)
    >>> for mutant in mutants_of(spec):
    ...     print(mutant.name, mutant.kind, mutant.change)
    M1 operator always[0:5](x >= 3) → eventually[0:5](x >= 3)
    M2 operator always[0:5](x >= 3) → x >= 3
    M3 bound always[0:5](x >= 3) → always[0:6](x >= 3)
    M4 bound always[0:5](x >= 3) → always[0:4](x >= 3)
    M5 operator x >= 3 → x < 3
    M6 operator x >= 3 → x > 3
    M7 operator x >= 3 → x <= 3
    M8 threshold x >= 3 → x >= 3.3
    M9 threshold x >= 3 → x >= 2.7
    """
    grid = step or spec.period if spec.domain.sampled else None
    found: list[Mutant] = []
    for name, one in spec.requirements.items():
        found += _of_one(name, one, grid, len(found))
    return found


def _of_one(name: str, spec: Specification, step: Fraction | None, before: int) -> list[Mutant]:
    formula = spec.formula
    if is_number(formula):
        raise UsageError(f"'{name}' is a number, which has no verdict; compare it, such as {name} > 0")
    if step is None and spec.domain.sampled and _has_bounds(formula):
        raise UsageError(
            "mutants have other bounds, in whole sampling periods, and the period is not known; "
            "give it, such as period='100ms'"
        )
    keys = Keys(step or spec.resolution or Fraction(1, 10**9), continuous=spec.domain.continuous)
    seen = {keys.of(formula)}
    found: list[Mutant] = []
    for change in changes_of(formula, step):
        (mutated,) = substituted((formula,), change.old, change.new)
        if not is_number(mutated):
            new = spec.with_formula(mutated)
            try:
                (spec._domain_for(period=step) if spec.domain.sampled else spec.domain).check(mutated)
            except StlError:  # a bound that is empty or no multiple, which is no requirement at all
                continue
            key = keys.of(mutated)
            if key not in seen:
                seen.add(key)
                place = _place(spec, change.old)
                number = before + len(found) + 1
                found.append(Mutant(number, name, change.kind, describe_change(change), *place, new))
    return found


def _has_bounds(formula: Formula) -> bool:
    from rtamt.language.formula import Apply, postorder

    return any(isinstance(node, Apply) and node.interval is not None for node in postorder(formula))


def _place(spec: Specification, part: Formula) -> tuple[int | None, int | None]:
    span = part.span
    return (None, None) if span is None else line_and_column(spec.text, span.start)


def kinds_of(mutants: list[Mutant]) -> dict[str, int]:
    """Return the number of mutants of each kind."""
    return dict(Counter(mutant.kind for mutant in mutants))
