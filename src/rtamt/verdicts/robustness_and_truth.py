"""The two outputs of a requirement: robustness and Boolean truth, from one program."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from rtamt.language.formula import Const, Formula, Var
from rtamt.language.operators import STL
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.semantics import apply_semantics, boolean
from rtamt.signals.signal import Signal
from rtamt.signals.time_domain_interface import DomainTrace

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.value_types import ValueType
    from rtamt.rewrite.semantics import PredicateSemantics

#: Returns the signal of each formula over a trace, all from one program: an ``Evaluators`` of the engine.
Evaluate: TypeAlias = Callable[[tuple[Formula, ...], DomainTrace], list[Signal]]


class Outputs(NamedTuple):
    """The formulas of the two outputs of a requirement.

    ``robustness``: under the semantics that was chosen. ``truth``: +inf where the requirement holds and -inf
    where it does not, the same under every semantics; never derived from the sign of the robustness.
    """

    robustness: Formula
    truth: Formula


def outputs_of(formula: Formula, applied: Formula | None = None) -> Outputs:
    """Return the outputs of a requirement; ``applied``: the formula with its semantics, if it is not standard.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> print(*outputs_of(parse_formula("x >= 3")), sep=", ")
    x >= 3, x >= 3
    """
    return Outputs(formula if applied is None else applied, boolean(formula))


def outputs_under(formula: Formula, semantics: str | PredicateSemantics, roles: Mapping[str, str]) -> Outputs:
    """Return the outputs of a requirement under a semantics."""
    return outputs_of(formula, apply_semantics(formula, semantics, roles))


def align_inputs(formula: Formula, names: Sequence[str], types: Mapping[str, ValueType]) -> Formula:
    """Return a formula with the same values that reads all the names: so several formulas begin and end together.

    ``types``: of the variables that are no plain numbers.
    """
    if not names:
        return formula
    everything: Formula = Var(names[0], type=types.get(names[0]))
    for name in names[1:]:
        everything = STL["and"](everything, Var(name, type=types.get(name)))
    return STL["and"](formula, STL["or"](Const(float("inf")), everything))
