"""The laws that every operator obeys, over random formulas in which it stands beside others.

Each law is a function of a case and of what hypothesis draws for it; it raises AssertionError with the
formula, the signals, and what was expected. Hypothesis shrinks them to the smallest that break the law.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

from rtamt.engine import dense_evaluate, dense_reference, reference, signals
from rtamt.engine.dense_monitor import DenseMonitor
from rtamt.engine.evaluate import Evaluator
from rtamt.engine.monitor import Monitor
from rtamt.errors import EvaluationError, SpecificationError
from rtamt.language.formula import Apply, Formula, Interval, Var, fold, variables
from rtamt.language.operators import STL, Bounds, Fixity, Language, Operator, Sort, Tense
from rtamt.language.parser import parse_formula
from rtamt.language.printer import to_text
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify
from rtamt.testing.strategies import chunkings, dense_chunkings, dense_traces, formulas, traces

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_ONE = Fraction(1)
_NAMES = ("x", "y")
_HOLE = "hole"
_NANOSECONDS = 10**9


def check_operator(
    operator: Operator,
    language: Language = STL,
    *,
    infinite: bool = True,
    tolerance: float = 0.0,
    examples: int = 50,
) -> None:
    """Hold an operator to the generic laws; raise :class:`AssertionError` with the smallest counterexample.

    In each time domain in which the operator has a meaning: what is fast gives what the definition says;
    online plus ``finish()`` is offline, in any chunks, and no value comes late; what is printed parses
    back; the pastified formula gives the same later, or is refused; the dual is the dual. The operator
    stands in random formulas beside those of ``language``, in both back ends.

    ``infinite``: whether signals hold ±inf, too. ``tolerance``: the relative error that a fast kernel may
    make, because it adds up in another order than the definition. ``examples``: how many a law.

    Raises :class:`UsageError` where the record cannot be an operator.

    >>> from rtamt.extend import STL
    >>> from rtamt.testing import check_operator
    >>> check_operator(STL["once"], examples=5)
    """
    if language.get(operator.name) is not operator:
        language = language.extend(operator)
    case = _Case(operator, language, infinite, tolerance)
    laws = list(_LAWS)
    if not operator.discrete_only and _has_dense_meaning(operator):
        laws += _DENSE_LAWS
    if operator.expansion is not None and operator.definition is not None:
        laws.append(_expansion_is_the_definition)
    if operator.dual is not None:
        laws.append(_dual)
    for law in laws:
        _hold(law, case, examples)


@dataclass(frozen=True)
class _Case:
    operator: Operator
    language: Language
    infinite: bool
    tolerance: float

    def formula(self, draw: Callable[[Any], Any], *, dense: bool = False, unbounded: bool = False) -> Formula:
        """Draw a formula in which the operator stands, its operands and surroundings drawn, too."""
        simple: dict[str, Any] = {
            "arithmetic": False,
            "discrete": not dense,
            "infinite": self.infinite,
            "select": lambda op: self.infinite or op.fixity is not Fixity.ATOM,  # true is +inf
        }
        operands = tuple(
            draw(formulas(1, _NAMES, unbounded_past=False, **simple)) for _ in self.operator.operands
        )
        node = Apply(self.operator, operands, self._interval(draw, unbounded=unbounded))
        around = draw(formulas(2, ("x", _HOLE), **simple))
        return fold(around, lambda n, args: _filled(n, args, node))

    def _interval(self, draw: Callable[[Any], Any], *, unbounded: bool) -> Interval | None:
        op = self.operator
        open_end = op.bounds is Bounds.OPTIONAL and (unbounded or op.tense is Tense.PAST)
        if op.bounds is Bounds.NONE or (open_end and draw(st.integers(0, 3)) == 0):
            return None
        begin = draw(st.integers(0, 3))
        end = None if open_end and draw(st.integers(0, 3)) == 0 else begin + draw(st.integers(0, 3))
        return Interval(Fraction(begin), None if end is None else Fraction(end))

    def equal(self, got: Any, expected: Any) -> bool:
        """Tell whether two lists of values agree; None is one that could not be computed."""
        if got is None or expected is None:
            return got is None and expected is None
        if len(got) != len(expected):
            return False
        return bool(np.allclose(got, expected, rtol=self.tolerance, atol=self.tolerance))

    def broken(self, law: str, formula: Formula, data: Any, expected: Any, got: Any) -> AssertionError:
        """Return the counterexample as an error."""
        return AssertionError(
            f"the operator '{self.operator.name}' breaks the law \"{law}\" in '{to_text(formula, self.language)}':\n"
            + "".join(f"  {name} = {_listed(values)}\n" for name, values in data.items())
            + f"  expected {_listed(expected)}\n  got      {_listed(got)}"
        )


def _hold(law: Callable[[_Case, Any], None], case: _Case, examples: int) -> None:
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


def _filled(node: Formula, args: tuple[Formula, ...], filling: Formula) -> Formula:
    if isinstance(node, Apply):
        return Apply(node.op, args, node.interval)
    return filling if node == Var(_HOLE) else node


def _has_dense_meaning(op: Operator) -> bool:
    return op.dense is not None or op.expansion is not None or op.tense is Tense.NONE


def _listed(values: Any) -> str:
    if values is None:
        return "no value (EvaluationError)"
    if isinstance(values, tuple):
        return f"{np.asarray(values[1]).tolist()} at {np.asarray(values[0]).tolist()}"
    return str(np.asarray(values).tolist()) if isinstance(values, np.ndarray) else str(values)


# ---- text ----------------------------------------------------------------------------------------


def _prints_and_parses(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, unbounded=True)
    text = to_text(formula, case.language)
    again = parse_formula(text, language=case.language)
    if again != formula:
        raise case.broken("what is printed parses back", formula, {}, text, to_text(again, case.language))
    formula.latex()


def _example_reads(case: _Case, _draw: Callable[[Any], Any]) -> None:
    example = case.operator.example
    formula = parse_formula(example, language=case.language)
    if not any(isinstance(node, Apply) and node.op is case.operator for node in _nodes(formula)):
        raise case.broken("the example shows the operator", formula, {}, case.operator.name, example)


def _nodes(formula: Formula) -> list[Formula]:
    found: list[Formula] = []
    fold(formula, lambda node, _below: found.append(node))
    return found


# ---- discrete time -------------------------------------------------------------------------------


def _columns(case: _Case, draw: Callable[[Any], Any]) -> dict[str, Array]:
    columns: dict[str, Array] = draw(traces(_NAMES, max_size=12, infinite=case.infinite))
    return columns


def _defined(formula: Formula, columns: dict[str, Array]) -> Array | None:
    n = len(columns["x"])
    frozen = {name: column.copy() for name, column in columns.items()}
    for column in frozen.values():
        column.flags.writeable = False
    try:
        return reference.evaluate(formula, frozen, n, _ONE)
    except EvaluationError as error:
        _check_own_code(error)
        return None


def _check_own_code(error: EvaluationError) -> None:
    """Let an operator that has no value pass; one whose own code fails is told."""
    if error.__cause__ is not None:
        raise error


def _fast_is_the_definition(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw, unbounded=True), _columns(case, draw)
    expected = _defined(formula, columns)
    got: Array | None
    try:
        recording = signals.trace(columns, _NAMES, _ONE)
        got = Evaluator((formula,), _ONE)(recording)[0]
    except EvaluationError as error:
        _check_own_code(error)
        got = None
    if not case.equal(got, expected):
        raise case.broken("fast is the definition", formula, columns, expected, got)


def _online_is_offline(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw), _columns(case, draw)
    expected = _defined(formula, columns)
    assume(expected is not None)
    sizes = draw(chunkings(len(columns["x"])))
    depth = horizon(formula)
    assert depth is not None
    for backend in ("cpp", "python"):
        monitor = Monitor(formula, backend=backend)
        for _ in range(2):  # a reset monitor is a new one
            got: list[float] = []
            at = 0
            for size in sizes:
                chunk = {name: columns[name][at : at + size] for name in monitor.input_names}
                at += size
                got += monitor.update_many(
                    {**chunk, "time": np.arange(at - size, at, dtype=float)}
                ).values.tolist()
                if len(got) != max(0, at - int(depth)):
                    raise case.broken(
                        f"a value comes when its horizon is reached ({backend})",
                        formula,
                        columns,
                        f"{max(0, at - int(depth))} values after {at} samples",
                        f"{len(got)} values",
                    )
            got += monitor.finish().values.tolist()
            if not case.equal(got, expected):
                law = f"online and finish is offline, in chunks of {sizes} ({backend})"
                raise case.broken(law, formula, columns, expected, got)
            monitor.reset()


def _pastified_is_later(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw), _columns(case, draw)
    try:
        past = pastify(formula)
    except SpecificationError:
        op = case.operator
        if op.tense is Tense.NONE or op.twin is not None or op.guards:
            raise
        return
    depth = horizon(formula)
    assert depth is not None
    expected, got = _defined(formula, columns), _defined(past, columns)
    assume(expected is not None and got is not None)
    assert expected is not None
    assert got is not None
    h = int(depth)
    whole = expected[: max(0, len(expected) - h)]
    if not case.equal(got[h:], whole):
        law = f"the pastified '{to_text(past, case.language)}' gives the same {h} later"
        raise case.broken(law, formula, columns, whole, got[h:])


def _expansion_is_the_definition(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw, unbounded=True), _columns(case, draw)
    expected, got = _defined(formula, columns), _defined(desugar(formula), columns)
    if not case.equal(got, expected):
        raise case.broken("the expansion is the definition", formula, columns, expected, got)


def _dual(case: _Case, draw: Callable[[Any], Any]) -> None:
    op = case.operator
    assert op.dual is not None
    dual = case.language.get(op.dual)
    assert dual is not None, f"'{op.name}' names the dual '{op.dual}', which the language does not have"
    operands = tuple(Var(_NAMES[k % len(_NAMES)]) for k in range(len(op.operands)))
    interval = case._interval(draw, unbounded=True)
    columns = _columns(case, draw)
    negated = tuple(
        STL["not"](x) if sort is Sort.FORMULA else x for x, sort in zip(operands, op.operands, strict=True)
    )
    formula, other = STL["not"](Apply(op, operands, interval)), Apply(dual, negated, interval)
    expected, got = _defined(formula, columns), _defined(other, columns)
    if not case.equal(got, expected):
        raise case.broken(f"its dual is '{op.dual}'", formula, columns, expected, got)


# ---- dense time ----------------------------------------------------------------------------------


def _trace(case: _Case, draw: Callable[[Any], Any], formula: Formula) -> dict[str, Any]:
    trace = draw(dense_traces(_NAMES, max_size=8, infinite=case.infinite))
    return {name: trace[name] for name in variables(formula)}


def _stepped(times: Any, values: Any) -> tuple[list[int], list[float]]:
    """Return a step function as its changes alone."""
    changes: list[tuple[int, float]] = []
    for time, value in zip(times, values, strict=True):
        if not changes or changes[-1][1] != value:
            changes.append((int(time), float(value)))
    return [t for t, _ in changes], [v for _, v in changes]


def _densely_defined(formula: Formula, trace: dict[str, Any]) -> tuple[list[int], list[float]] | None:
    try:
        steps = dense_reference.evaluate(formula, trace, _ONE)
    except EvaluationError as error:
        _check_own_code(error)
        return None
    return _stepped(steps.times, steps.values)


def _same_steps(case: _Case, got: Any, expected: Any) -> bool:
    if got is None or expected is None:
        return got is expected
    # Values that differ by less than the tolerance may be merged in one and not in the other.
    instants = sorted({*got[0], *expected[0]})
    return case.equal(_at(got, instants), _at(expected, instants))


def _at(steps: tuple[list[int], list[float]], instants: list[int]) -> list[float]:
    places = np.searchsorted(steps[0], instants, side="right") - 1
    return [steps[1][place] if place >= 0 else np.nan for place in places]


def _ticks(trace: dict[str, Any]) -> dict[str, Any]:
    return {name: (np.asarray(t, np.int64) * _NANOSECONDS, values) for name, (t, values) in trace.items()}


def _fast_is_the_dense_definition(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, dense=True, unbounded=True)
    assume(variables(formula))
    trace = _trace(case, draw, formula)
    expected = _densely_defined(formula, trace)
    recording = dense_evaluate.trace(_ticks(trace), variables(formula), _ONE)
    got: Any
    try:
        signal = dense_evaluate.evaluate(formula, recording)
        got = _stepped(signal.times // _NANOSECONDS, signal.values)
    except EvaluationError as error:
        _check_own_code(error)
        got = None
    # What has no value after the end, and is read by nothing, may pass unnoticed in one of them.
    assume(expected is not None and got is not None)
    if not _same_steps(case, got, expected):
        raise case.broken("fast is the definition, in dense time", formula, trace, expected, got)


def _dense_online_is_offline(case: _Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, dense=True)
    assume(variables(formula))
    trace = _trace(case, draw, formula)
    expected = _densely_defined(formula, trace)
    assume(expected is not None)
    updates = draw(dense_chunkings(trace))
    for backend in ("cpp", "python"):
        monitor = DenseMonitor(formula, resolution=_ONE, backend=backend)
        for _ in range(2):  # a reset monitor is a new one
            times: list[int] = []
            values: list[float] = []
            try:
                told = [monitor.update_many(_ticks(update)) for update in updates] + [monitor.finish()]
            except EvaluationError as error:
                _check_own_code(error)
                assume(False)
                raise
            for signal in told:
                times += (signal.times // _NANOSECONDS).tolist()
                values += signal.values.tolist()
            if times != sorted(set(times)) or not _same_steps(case, _stepped(times, values), expected):
                law = f"online and finish is offline, in dense time ({backend})"
                raise case.broken(law, formula, trace, expected, (times, values))
            monitor.reset()


_LAWS = (
    _example_reads,
    _prints_and_parses,
    _fast_is_the_definition,
    _online_is_offline,
    _pastified_is_later,
)
_DENSE_LAWS = (_fast_is_the_dense_definition, _dense_online_is_offline)
