"""The error for undefined values, shared by both back ends."""

from __future__ import annotations

from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply
from rtamt.language.operators import Blocks, Compiled
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.formula import Formula


_WHY = "it is 0/0, inf - inf, 0 * inf, or a function outside its domain"

#: The meaning of an operation without a text.
UNNAMED = f"an operation\n{_WHY}"


def undefined(formula: Formula, where: str) -> EvaluationError:
    """Return the error for an undefined value (0/0, inf - inf, …), or for a custom operator that returned NaN.

    ``formula``: the formula without a value, as the user wrote it. ``where``: :func:`at_sample`, or ``"time 0.5 s"``.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> str(undefined(parse_formula("x / y"), at_sample(3, 0.3)))[:48]
    "'x / y' has no value at sample 3, time 0.3 s: it"
    """
    from rtamt.language.printing.printer import excerpt

    if isinstance(formula, Apply) and _is_the_users(formula):
        return EvaluationError(
            f"the operator '{formula.op.name}' gave NaN: '{excerpt(formula)}' has no value at {where}; "
            f"mend the operator, or change the formula or the data so that this cannot happen"
        )
    return undefined_text(meaning_of(formula), where)


class UndefinedByDefinitionError(EvaluationError):
    """The definition's error for an undefined value, which callers word with times in their own format.

    ``args``: the formula without a value, as it is written, the tick or sample, and the time in seconds.
    """

    def __init__(self, formula: Formula, place: int, seconds: float) -> None:
        super().__init__(formula, place, seconds)

    @property
    def time(self) -> float:
        """The time in seconds."""
        seconds: float = self.args[2]
        return seconds


class UndefinedAtTickError(UndefinedByDefinitionError):
    """An undefined value in dense time."""

    def __str__(self) -> str:
        from rtamt.language.units.moments import time_text

        formula, _, seconds = self.args
        return str(undefined(formula, f"time {time_text(seconds)}"))


class UndefinedAtSampleError(UndefinedByDefinitionError):
    """An undefined value in discrete time."""

    def __str__(self) -> str:
        formula, sample, seconds = self.args
        return str(undefined(formula, at_sample(sample, seconds)))


def meaning_of(formula: Formula) -> str:
    """Return what :func:`undefined_text` needs of a formula of built-in operators, as text."""
    from rtamt.language.printing.printer import excerpt

    why = formula.op.fails if isinstance(formula, Apply) else ""
    return f"'{excerpt(formula)}'\n{why or _WHY}"


def undefined_text(meaning: str, where: str) -> EvaluationError:
    """Return the error for an undefined value of which only the text is known, see :func:`meaning_of`."""
    formula, _, why = meaning.rpartition("\n")
    return EvaluationError(
        f"{formula} has no value at {where}: {why}; change the formula or the data so that this cannot happen"
    )


def at_sample(sample: int, seconds: float, *, dated: bool = False) -> str:
    """Return the index and time of a sample for a message; ``dated``: whether the caller's times are dates."""
    from rtamt.language.units.moments import time_text

    return f"sample {sample}, time {time_text(seconds, dated=dated)}"


def _is_the_users(formula: Apply) -> bool:
    """Return whether an operator is custom code that the core calls."""
    op = formula.op
    return isinstance(op.kernel, Blocks | Compiled) or (op.kernel is None and op.expansion is None)
