"""The operator under test, and the report of a broken law."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from rtamt.language.formula import Apply, Formula, Interval, Var, fold
from rtamt.language.operators import Bounds, Fixity, Language, Operator, Tense
from rtamt.language.printing.printer import to_text
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.testing.strategies import formulas

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.errors import EvaluationError

ONE = Fraction(1)
NAMES = ("x", "y")
_HOLE = "hole"


@dataclass(frozen=True)
class Case:
    """An operator in its language, and the tolerance of the laws."""

    operator: Operator
    language: Language
    infinite: bool
    tolerance: float

    def formula(self, draw: Callable[[Any], Any], *, dense: bool = False, unbounded: bool = False) -> Formula:
        """Draw a formula that contains the operator, with random operands and context."""
        simple: dict[str, Any] = {
            "arithmetic": False,
            "discrete": not dense,
            "infinite": self.infinite,
            "select": lambda op: self.infinite or op.fixity is not Fixity.ATOM,  # true is +inf
        }
        operands = tuple(
            draw(formulas(1, NAMES, unbounded_past=False, **simple)) for _ in self.operator.operands
        )
        node = Apply(self.operator, operands, self.interval(draw, unbounded=unbounded))
        around = draw(formulas(2, ("x", _HOLE), **simple))
        return fold(around, lambda n, args: _fill(n, args, node))

    def interval(self, draw: Callable[[Any], Any], *, unbounded: bool) -> Interval | None:
        """Draw an interval for the operator; None if it takes no interval, or sometimes if the interval is optional."""
        op = self.operator
        open_end = op.bounds is Bounds.OPTIONAL and (unbounded or op.tense is Tense.PAST)
        if op.bounds is Bounds.NONE or (open_end and draw(st.integers(0, 3)) == 0):
            return None
        begin = draw(st.integers(0, 3))
        end = None if open_end and draw(st.integers(0, 3)) == 0 else begin + draw(st.integers(0, 3))
        return Interval(Fraction(begin), None if end is None else Fraction(end))

    def equal(self, got: Any, expected: Any) -> bool:
        """Return whether two lists of values agree; None is a list that could not be computed."""
        if got is None or expected is None:
            return got is None and expected is None
        if len(got) != len(expected):
            return False
        return bool(np.allclose(got, expected, rtol=self.tolerance, atol=self.tolerance))

    def broken(self, law: str, formula: Formula, data: Any, expected: Any, got: Any) -> AssertionError:
        """Return the counterexample as an error."""
        return AssertionError(
            f"the operator '{self.operator.name}' breaks the law \"{law}\" in '{to_text(formula, self.language)}':\n"
            + "".join(f"  {name} = {_format_list(values)}\n" for name, values in data.items())
            + f"  expected {_format_list(expected)}\n  got      {_format_list(got)}"
        )


def hold(law: Callable[[Case, Any], None], case: Case, examples: int) -> None:
    """Test a law on a fixed set of examples; raise its error on the smallest counterexample."""

    @settings(
        max_examples=examples,
        deadline=None,
        database=None,
        derandomize=True,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def holds(data: Any) -> None:
        law(case, data.draw)

    holds()


def _fill(node: Formula, args: tuple[Formula, ...], filling: Formula) -> Formula:
    if isinstance(node, Apply):
        return Apply(node.op, args, node.interval)
    return filling if node == Var(_HOLE) else node


def _format_list(values: Any) -> str:
    if values is None:
        return "no value (EvaluationError)"
    if isinstance(values, tuple):
        return f"{np.asarray(values[1]).tolist()} at {np.asarray(values[0]).tolist()}"
    return str(np.asarray(values).tolist()) if isinstance(values, np.ndarray) else str(values)


def check_own_code(error: EvaluationError) -> None:
    """Pass for an operator without a value; raise if the operator's own code fails."""
    if error.__cause__ is not None:
        raise error
