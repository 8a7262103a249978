"""A setting of the wrong kind is answered by a sentence, never by a TypeError or AttributeError from inside."""

from pathlib import Path

import numpy as np
import pytest

import rtamt
from rtamt.extend import STL, Bounds, Fixity, Operator, Sort, Tense

SAID = {
    "time": (lambda: rtamt.parse("x", time=None), "unknown time domain None; time domains: discrete, dense"),
    "backend": (lambda: rtamt.parse("x", backend=3), "unknown backend 3; back ends: cpp, python"),
    "language": (
        lambda: rtamt.parse("x", language="stl"),
        "language is 'stl', expected a Language: STL or STL.extend(...)",
    ),
    "constants": (
        lambda: rtamt.parse("x", constants=["k"]),
        "constants is ['k'], expected a mapping from name to value, such as {'limit': 3}",
    ),
    "roles": (
        lambda: rtamt.parse("x", roles="x"),
        "roles is 'x', expected a mapping from name to value, such as {'req': 'input'}",
    ),
    "resolution": (lambda: rtamt.parse("x", resolution=0), "the resolution is 0; it must be positive"),
    "watch": (
        lambda: rtamt.parse("x").monitor(watch=3),
        "watch is 3, expected names or formulas, such as ['x >= 3']",
    ),
    "watch, one of several": (
        lambda: rtamt.parse("x").monitor(watch=["x", 3]),
        "watch is ['x', 3], expected names or formulas, such as ['x >= 3']",
    ),
    "watched formula": (
        lambda: rtamt.parse("x").monitor(watch=["x"])[rtamt.parse("x >= 3").formula],
        "'x >= 3' is not watched; the monitor watches 'x'",
    ),
    "variables of a watched formula": (
        lambda: rtamt.parse("x").monitor(watch=rtamt.parse("y >= 3").formula),
        "'y >= 3' reads 'y', which the formula does not; watch what reads x only",
    ),
    "watched": (
        lambda: rtamt.parse("x").monitor(watch=["x"])[3],
        "'3' is not watched; the monitor watches 'x'",
    ),
    "sub-formula": (lambda: rtamt.parse("x").evaluate({"x": [1]})[None], "a formula is text, got NoneType"),
    "text of a new specification": (
        lambda: rtamt.Specification("always(x >= 3)"),
        "a specification is made by rtamt.parse(text) or rtamt.load(path), got 'always(x >= 3)'",
    ),
    "data of a new trace": (
        lambda: rtamt.Trace({"x": [1, 2]}),
        "a trace is made by rtamt.read(data), got {'x': [1, 2]}",
    ),
    "values of a new trace": (
        lambda: rtamt.Trace([1, 2]),
        "a trace is made by rtamt.read(data), got [1, 2]",
    ),
    "name of a file": (
        lambda: rtamt.parse("limits.stl"),
        "'limits.stl' is the name of a file; write rtamt.load('limits.stl') (if a formula is meant, put it in "
        "parentheses)",
    ),
    "path of a file": (
        lambda: rtamt.parse("specs/limits.stl"),
        "'specs/limits.stl' is the name of a file; write rtamt.load('specs/limits.stl') (if a formula is meant, put it "
        "in parentheses)",
    ),
    "path for a text": (
        lambda: rtamt.parse(Path("limits.stl")),
        "a formula is text, got the path 'limits.stl'; rtamt.load reads a file",
    ),
    "axes for a figure": (
        lambda: rtamt.parse("x").evaluate({"x": [1]}).plot(figure="axes"),
        "figure is 'axes', expected a figure of matplotlib, such as plt.figure() or axes.figure",
    ),
    "axes for a figure, tree": (
        lambda: rtamt.parse("x").evaluate({"x": [1]}).plot_tree(figure="axes"),
        "figure is 'axes', expected a figure of matplotlib, such as plt.figure() or axes.figure",
    ),
    "truth of a result": (
        lambda: bool(rtamt.parse("x").evaluate({"x": [1]})),
        "a result is neither true nor false; read result.satisfied, result.robustness or result.interval",
    ),
    "specification for a result": (
        lambda: rtamt.first_violation(rtamt.parse("x")),
        "expected a result, got <specification x>; write spec.evaluate(data)",
    ),
    "one recording for several, batch": (
        lambda: rtamt.evaluate_batch(rtamt.parse("x"), {"x": [1]}),
        "traces is a dict; give a list of recordings; spec.evaluate_batch(data) takes a mapping to arrays of shape "
        "(traces, samples)",
    ),
    "file for several recordings": (
        lambda: rtamt.evaluate_batch(rtamt.parse("x"), "log.csv"),
        "traces is a str; give a list of recordings; spec.evaluate_batch(data) takes a mapping to arrays of shape "
        "(traces, samples)",
    ),
    "one recording for several, chunks": (
        lambda: rtamt.check_stream(rtamt.parse("x"), rtamt.read({"x": [1]})),
        "chunks is a Trace; give a list of recordings, or an iterator; spec.evaluate(data) takes one recording",
    ),
    "path": (lambda: rtamt.load(None), "the path of a specification is None, expected text or a Path"),
    "text for a specification, batch": (
        lambda: rtamt.evaluate_batch("x >= 3", [{"x": [1]}]),
        "expected a specification, got 'x >= 3'; write rtamt.parse(...) or rtamt.load(...)",
    ),
    "text for a specification, all": (
        lambda: rtamt.evaluate_all([rtamt.parse("x"), "x >= 3"], {"x": [1]}),
        "specification 1: expected a specification, got 'x >= 3'; write rtamt.parse(...) or rtamt.load(...)",
    ),
    "text for a specification, chunks": (
        lambda: rtamt.check_stream("x >= 3", [{"x": [1]}]),
        "expected a specification, got 'x >= 3'; write rtamt.parse(...) or rtamt.load(...)",
    ),
    "specifications": (
        lambda: rtamt.evaluate_all(5, {"x": [1]}),
        "specs is 5; give a list of specifications",
    ),
    "chunks": (
        lambda: rtamt.check_stream(rtamt.parse("x"), 5),
        "chunks is 5; give a list of recordings, or an iterator",
    ),
    "infinite workers": (
        lambda: rtamt.evaluate_batch(rtamt.parse("x"), [], workers=float("inf")),
        "workers is inf; give a number of threads, 1 or more",
    ),
    "selected columns": (
        lambda: rtamt.Suite([rtamt.parse("x")], select=5),
        "select is 5; give a list of names, such as ['robustness']",
    ),
    "ranges": (
        lambda: rtamt.parse("x").monitor(verdict="interval", ranges=5),
        "ranges=5 is no mapping from variables; give for example {'x': (0, 120)}",
    ),
    "prediction": (
        lambda: rtamt.parse("x").monitor(verdict="interval").interval(prediction=5),
        "prediction=5 is no mapping from variables; give for example {'x': (0, 120)}",
    ),
    "unit of time": (
        lambda: rtamt.parse("x").monitor(time_unit=["ms"]),
        "['ms'] is not a unit of time; units: h, min, s, ms, us, ns",
    ),
    "gaps": (
        lambda: rtamt.Fleet(rtamt.parse("x"), 1, gaps=[]),
        "gaps is []; policies: reject, restart, hold",
    ),
    "expiry": (
        lambda: rtamt.Fleet(rtamt.parse("x"), 1).expire(before="noon"),
        "before is 'noon'; give a number of seconds, or a date",
    ),
    "expiry before NaN": (
        lambda: rtamt.Fleet(rtamt.parse("x"), 1).expire(before=float("nan")),
        "before is nan; give a number of seconds, or a date",
    ),
    "discarded time": (
        lambda: rtamt.Fleet(rtamt.parse("x"), 1, lateness=2).discard(7, None),
        "time is None; give a number of seconds, or a date",
    ),
    "operator": (lambda: STL.extend(3), "3 is no operator; give an Operator"),
}


@pytest.mark.parametrize("call", SAID)
def test_a_setting_of_another_kind(call):
    wrong, message = SAID[call]
    with pytest.raises(rtamt.UsageError) as info:
        wrong()
    assert str(info.value) == message


def test_a_semantics_that_raises_is_named_with_the_predicate():
    def mine(_predicate, roles):
        return roles["w"]

    with pytest.raises(rtamt.EvaluationError) as info:
        rtamt.parse("once(x >= 3)", semantics=mine).monitor()
    assert str(info.value) == (
        "the semantics 'mine' failed for the predicate 'x >= 3': KeyError: 'w'; it is called with a predicate "
        "and the roles, and returns a formula"
    )
    assert isinstance(info.value.__cause__, KeyError)


@pytest.mark.parametrize("ask", [lambda result: result.satisfied, lambda result: result.explain()])
def test_an_operator_that_makes_nan_of_infinities_has_robustness_and_no_verdict(ask):
    avg = Operator(
        "avg", ("avg",), Fixity.PREFIX, 75, (Sort.FORMULA,), Sort.FORMULA, "The mean so far.", "avg[0:1] x",
        definition=lambda x, _a, _b: np.array([x[: i + 1].mean() for i in range(len(x))]),
        tense=Tense.PAST, bounds=Bounds.REQUIRED,
    )  # fmt: skip
    result = rtamt.parse("always(avg[0:1] x > 1)", language=STL.extend(avg)).evaluate({"x": [0, 3, 6]})
    assert result.robustness == -1.0
    with pytest.raises(rtamt.EvaluationError) as info:
        ask(rtamt.parse("always(avg[0:1](x > 1))", language=STL.extend(avg)).evaluate({"x": [0, 3, 6]}))
    assert str(info.value).startswith(
        "there is no verdict, for which true counts as +inf and false as -inf: the operator 'avg' gave NaN: "
    )


def test_a_formula_of_one_name_that_ends_like_a_file_is_read_in_parentheses():
    assert rtamt.parse("(message.stl)").input_names == ("message.stl",)
    assert rtamt.parse("x >= 3 or message.stl").input_names == ("x", "message.stl")


@pytest.mark.parametrize("take_apart", [list, lambda result: "x" in result])
def test_a_result_is_no_sequence_of_its_signals(take_apart):
    with pytest.raises(TypeError):
        take_apart(rtamt.parse("x >= 3").evaluate({"x": [1]}))
