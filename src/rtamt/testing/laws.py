"""The laws that every operator obeys, over random formulas that combine it with others.

Each law is a function of a case and of hypothesis' draw function; it raises AssertionError with the
formula, the signals, and the expected value. Hypothesis shrinks them to a minimal counterexample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hypothesis import assume

from rtamt.engine import BACKENDS, Evaluators, engine_of
from rtamt.errors import EvaluationError, SpecificationError
from rtamt.language.formula import Apply, Formula, Var, fold
from rtamt.language.operators import STL, Language, Operator, Sort, Tense
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.printer import to_text
from rtamt.lazy.modules import np
from rtamt.reference import discrete_robustness as reference
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify
from rtamt.signals.discrete import DISCRETE, record_discrete
from rtamt.testing.case import NAMES, ONE, Case, check_own_code, hold
from rtamt.testing.dense_laws import DENSE_LAWS, has_dense_meaning
from rtamt.testing.strategies import chunkings, traces

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def check_operator(
    operator: Operator,
    language: Language = STL,
    *,
    infinite: bool = True,
    tolerance: float = 0.0,
    examples: int = 50,
) -> None:
    """Check that an operator obeys the generic laws; raise :class:`AssertionError` with a minimal counterexample.

    In each time domain in which the operator is defined: the kernel computes the values of the definition;
    online results plus ``finish()`` equal the offline results, for any chunks, and no value is late; printed
    formulas parse back; the pastified formula has the same value later, or is rejected; the dual operator is
    dual. The operator is tested in random formulas with those of ``language``, in both back ends.

    ``infinite``: whether signals also contain ±inf. ``tolerance``: the allowed relative error of a kernel,
    for example because it adds in a different order than the definition. ``examples``: the number per law.

    Raises :class:`UsageError` if the record is not a valid operator.

    >>> from rtamt.extend import STL
    >>> from rtamt.testing import check_operator
    >>> check_operator(STL["once"], examples=5)
    """
    if language.get(operator.name) is not operator:
        language = language.extend(operator)
    case = Case(operator, language, infinite, tolerance)
    laws = list(_LAWS)
    if not operator.discrete_only and has_dense_meaning(operator):
        laws += DENSE_LAWS
    if operator.expansion is not None and operator.definition is not None:
        laws.append(_expansion_is_the_definition)
    if operator.dual is not None:
        laws.append(_dual)
    for law in laws:
        hold(law, case, examples)


# ---- text ----------------------------------------------------------------------------------------


def _prints_and_parses(case: Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, unbounded=True)
    text = to_text(formula, case.language)
    again = parse_formula(text, language=case.language)
    if again != formula:
        raise case.broken("what is printed parses back", formula, {}, text, to_text(again, case.language))
    formula.latex()


def _example_reads(case: Case, _draw: Callable[[Any], Any]) -> None:
    example = case.operator.example
    formula = parse_formula(example, language=case.language)
    if not any(isinstance(node, Apply) and node.op is case.operator for node in _nodes(formula)):
        raise case.broken("the example shows the operator", formula, {}, case.operator.name, example)


def _nodes(formula: Formula) -> list[Formula]:
    found: list[Formula] = []
    fold(formula, lambda node, _below: found.append(node))
    return found


# ---- discrete time -------------------------------------------------------------------------------


def _columns(case: Case, draw: Callable[[Any], Any]) -> dict[str, Array]:
    columns: dict[str, Array] = draw(traces(NAMES, max_size=12, infinite=case.infinite))
    return columns


def _defined(formula: Formula, columns: dict[str, Array]) -> Array | None:
    n = len(columns["x"])
    frozen = {name: column.copy() for name, column in columns.items()}
    for column in frozen.values():
        column.flags.writeable = False
    try:
        return reference.evaluate(formula, frozen, n, ONE)
    except EvaluationError as error:
        check_own_code(error)
        return None


def _fast_is_the_definition(case: Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw, unbounded=True), _columns(case, draw)
    expected = _defined(formula, columns)
    got: Array | None
    try:
        recording = record_discrete(columns, NAMES, ONE)
        got = Evaluators(BACKENDS[0])((formula,), recording)[0].values
    except EvaluationError as error:
        check_own_code(error)
        got = None
    if not case.equal(got, expected):
        raise case.broken("fast is the definition", formula, columns, expected, got)


def _online_is_offline(case: Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw), _columns(case, draw)
    expected = _defined(formula, columns)
    assume(expected is not None)
    sizes = draw(chunkings(len(columns["x"])))
    depth = horizon(formula)
    assert depth is not None
    for backend in BACKENDS:
        monitor: Any = engine_of(DISCRETE).monitor(formula, backend=backend)
        for _ in range(2):  # a reset monitor acts like a new one
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


def _pastified_is_later(case: Case, draw: Callable[[Any], Any]) -> None:
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


def _expansion_is_the_definition(case: Case, draw: Callable[[Any], Any]) -> None:
    formula, columns = case.formula(draw, unbounded=True), _columns(case, draw)
    expected, got = _defined(formula, columns), _defined(desugar(formula), columns)
    if not case.equal(got, expected):
        raise case.broken("the expansion is the definition", formula, columns, expected, got)


def _dual(case: Case, draw: Callable[[Any], Any]) -> None:
    op = case.operator
    assert op.dual is not None
    dual = case.language.get(op.dual)
    assert dual is not None, f"'{op.name}' names the dual '{op.dual}', which the language does not have"
    operands = tuple(Var(NAMES[k % len(NAMES)]) for k in range(len(op.operands)))
    interval = case.interval(draw, unbounded=True)
    columns = _columns(case, draw)
    negated = tuple(
        STL["not"](x) if sort is Sort.FORMULA else x for x, sort in zip(operands, op.operands, strict=True)
    )
    formula, other = STL["not"](Apply(op, operands, interval)), Apply(dual, negated, interval)
    expected, got = _defined(formula, columns), _defined(other, columns)
    if not case.equal(got, expected):
        raise case.broken(f"its dual is '{op.dual}'", formula, columns, expected, got)


_LAWS = (
    _example_reads,
    _prints_and_parses,
    _fast_is_the_definition,
    _online_is_offline,
    _pastified_is_later,
)
