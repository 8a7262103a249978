"""Definitions that use each other twice: what the library does takes the time of the graph, not of its text."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rtamt
from rtamt.cli import main
from rtamt.errors import BoundError, EvaluationError, SpecificationError
from rtamt.language.formula import COUNTLESS, size
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.printer import canonical, excerpt, to_text
from rtamt.language.printing.writing import LONGEST
from rtamt.reference.discrete_robustness import evaluate_all
from rtamt.rewrite import pastify

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = pytest.mark.timeout(20)

DEPTH = 60


def chain(first: str, step: str, last: str, depth: int = DEPTH) -> str:
    """Return definitions a0, a1, ..., each made of the previous one, and a formula over the last."""
    lines = [f"a0 = {first}"]
    lines += [f"a{i} = {step.format(f'a{i - 1}')}" for i in range(1, depth + 1)]
    return ";\n".join([*lines, last.format(f"a{depth}")])


SHAPES = {
    "since": chain("x >= 0", "({0} since {0})", "always({0})"),
    "sums": chain("x", "{0} + {0}", "always({0} >= 0)"),
    "minimum": chain("x", "min({0}, {0})", "{0} >= 0"),
    "conjunctions": chain("always(x >= 0)", "{0} and {0}", "{0}"),
    "implications": chain("x >= 0", "({0} -> {0})", "always({0})"),
    "unless": chain("x >= 0", "({0} unless[0:1] {0})", "{0}", 12),
    "windows": chain("x >= 0", "(eventually[0:1]({0}) and {0})", "always({0})", 30),
    "deep": chain("x >= 0", "not {0}", "always({0})", 200),
}
DATA = {"time": [0, 1, 2, 3], "x": [1.0, 2.0, 3.0, 4.0]}
DENSE = {"x": ([0, 1, 2, 3], [1.0, 2.0, 3.0, 4.0])}


def monitored(spec: rtamt.Specification) -> None:
    if spec.horizon == np.inf:
        with pytest.raises(BoundError):
            spec.monitor()
        spec = rtamt.parse(spec.text.replace("always", "historically"))
    monitor = spec.monitor(watch=["a3"])
    for t in range(3):
        monitor.update(float(t), x=1.0)
    assert pickle.loads(pickle.dumps(monitor))["a3"] == copy.deepcopy(monitor)["a3"]
    assert repr(monitor)


def drawn(spec: rtamt.Specification) -> None:
    import matplotlib.pyplot as plt

    figure = spec.evaluate(DATA).plot()
    assert figure.axes
    plt.close(figure)


def with_the_papers_classes(spec: rtamt.Specification) -> None:
    for old in (rtamt.StlDiscreteTimeSpecification(), rtamt.StlDenseTimeSpecification()):
        old.declare_var("x", "float")
        old.spec = spec.text
        old.parse()
        assert len(old.spec_print()) <= LONGEST
        if isinstance(old, rtamt.StlDiscreteTimeSpecification):
            old.evaluate({"time": [0, 1], "x": [1.0, 1.0]})
        else:
            old.evaluate(["x", [[0, 1.0], [1, 1.0]]])
        assert old.get_value("a3")


OPERATIONS: dict[str, Callable[[rtamt.Specification], Any]] = {
    "text": lambda spec: str(spec) and str(spec.formula) and repr(spec) and repr(spec.formula),
    "canonical": lambda spec: canonical(spec.formula),
    "latex": lambda spec: spec.formula.latex(),
    "equality": lambda spec: (
        spec.formula == (again := rtamt.parse(spec.text).formula) and hash(spec.formula) == hash(again)
    ),
    "variables": lambda spec: spec.input_names == ("x",),
    "horizon": lambda spec: spec.horizon >= 0,
    "compile": lambda spec: spec.horizon == np.inf or spec.compile().disassemble(),
    "compile dense": lambda spec: spec.horizon == np.inf or spec.compile(time="dense").to_bytes(),
    "pastified": lambda spec: spec.horizon == np.inf or repr(spec.pastified()),
    "pickle": lambda spec: pickle.loads(pickle.dumps(spec)).formula == spec.formula,
    "pickled formula": lambda spec: pickle.loads(pickle.dumps(spec.formula)) == spec.formula,
    "copy": lambda spec: copy.deepcopy(spec).formula == copy.copy(spec.formula),
    "evaluate": lambda spec: repr(spec.evaluate(DATA)) and spec.evaluate(DATA).satisfied,
    "evaluate dense": lambda spec: repr(spec.evaluate(DENSE, time="dense")),
    "evaluate in Python": lambda spec: repr(rtamt.parse(spec.text, backend="python").evaluate(DATA)),
    "evaluate dense in Python": lambda spec: repr(
        rtamt.parse(spec.text, backend="python").evaluate(DENSE, time="dense")
    ),
    "evaluate every part": lambda spec: evaluate_all(spec.formula, {"x": np.ones(3)}, 3, Fraction(1)),
    "other semantics": lambda spec: spec.evaluate(DATA, semantics="output_vacuity").robustness <= np.inf,
    "stream": lambda spec: rtamt.check_stream(spec, [DATA], period=1).samples == 4,
    "stream dense": lambda spec: rtamt.check_stream(spec, [DENSE], time="dense").samples > 0,
    "explain": lambda spec: str(spec.evaluate(DATA).explain()),
    "explain dense": lambda spec: str(spec.evaluate(DENSE, time="dense").explain()),
}


OPERATIONS |= {"monitor": monitored, "plot": drawn, "the paper's classes": with_the_papers_classes}

COMMANDS = {
    "check": ["{spec}", "{trace}"],
    "check dense": ["{spec}", "{trace}", "--time", "dense"],
    "check json": ["{spec}", "{trace}", "--json"],
    "check junit": ["{spec}", "{trace}", "--junit", "{out}"],
    "info": ["{spec}"],
    "info json": ["{spec}", "--json"],
    "info latex": ["{spec}", "--latex"],
    "info dense": ["{spec}", "--time", "dense"],
    "lint": ["{spec}"],
    "explain": ["{spec}", "{trace}"],
    "report": ["{spec}", "{trace}", "-o", "{out}.html"],
}


@pytest.mark.parametrize("shape", SHAPES)
def test_every_operation_on_shared_definitions_returns(shape: str) -> None:
    spec = rtamt.parse(SHAPES[shape])
    for name, operation in OPERATIONS.items():
        done = operation(spec)
        assert done is None or done, name


@pytest.mark.parametrize("shape", SHAPES)
def test_every_command_on_shared_definitions_returns(
    shape: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec, trace = tmp_path / "spec.stl", tmp_path / "trace.csv"
    spec.write_text(SHAPES[shape])
    trace.write_text("time,x\n0,1\n1,2\n2,3\n3,4\n")
    names = {"spec": spec, "trace": trace, "out": tmp_path / "out"}
    for command, arguments in COMMANDS.items():
        code = main([command.split()[0], *(each.format(**names) for each in arguments)])
        told = capsys.readouterr()
        assert code in (0, 1), (command, told.err)
        assert len(told.out) < 1_000_000, command


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_the_error_of_a_running_monitor_names_the_beginning_of_a_sum_of_2_to_the_60_terms(
    backend: str, time: str
) -> None:
    spec = rtamt.parse(chain("x", "{0} + {0}", "sqrt({0}) >= 0"), backend=backend, time=time)
    monitor = spec.monitor()
    if time == "dense":  # where the value at an instant is known once the next one comes
        monitor.update(0.0, x=1.0)
    with pytest.raises(EvaluationError, match=r"^'sqrt\(x \+ x \+ \(x \+ x\) .*… \(abbreviated: ") as caught:
        monitor.update(1.0, x=-1.0)
    assert f"more than {COUNTLESS:.0e} operators" in str(caught.value)
    assert len(str(caught.value)) < 600


def test_a_text_up_to_the_limit_is_written_out_and_a_longer_one_says_that_it_is_not() -> None:
    text = " and ".join(["x >= 1"] * 10_000)
    formula = parse_formula(text)
    assert len(text) < LONGEST
    assert str(formula) == text
    assert to_text(formula, limit=len(text)) == text
    beginning = f"{text[:200]}… (abbreviated: 39999 operators, variables and numbers)"
    assert to_text(formula, limit=len(text) - 1) == excerpt(formula) == beginning


def test_equality_tells_graphs_apart_that_differ_in_one_leaf() -> None:
    one, other = (rtamt.parse(chain(f"x >= {k}", "({0} since {0})", "{0}")).formula for k in (0, 1))
    again = rtamt.parse(chain("x >= 0", "({0} since {0})", "{0}")).formula
    assert one == again
    assert again == one
    assert one != other
    assert again != other
    assert size(one) == COUNTLESS


def test_a_chain_of_2000_definitions_needs_no_recursion() -> None:
    spec = rtamt.parse(chain("always(x >= 0)", "not {0}", "{0}", 2000))
    assert pickle.loads(pickle.dumps(spec.formula)) == spec.formula
    assert rtamt.check_stream(spec, [DATA], period=1).satisfied


def test_pastification_of_a_shared_formula_at_2_to_the_30_delays_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pastify, "MOST", 1000)
    lines = ["a0 = x >= 0"] + [f"a{i} = (eventually[0:{2**i}] a{i - 1}) or a{i - 1}" for i in range(1, 30)]
    spec = rtamt.parse("; ".join([*lines, "a29"]))
    with pytest.raises(SpecificationError, match=r"^the pastified formula would have more than 1000 "):
        spec.pastified()
    assert spec.monitor().update(0.0, x=1.0) is None
