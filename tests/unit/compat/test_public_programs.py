"""Programs as RTAMT's users write them, where RTAMT accepts what our own monitors reject."""

from __future__ import annotations

import copy
from importlib import import_module

import pytest
from matplotlib.figure import Figure

import rtamt

ONLINE = [
    rtamt.StlDiscreteTimeSpecification,
    rtamt.StlDiscreteTimeOnlineSpecification,
    rtamt.StlDiscreteTimeOnlineSpecificationCpp,
]


def declared(made, text):
    spec = made()
    spec.declare_var("req", "float")
    spec.declare_var("out", "float")
    spec.spec = text
    spec.parse()
    return spec


@pytest.mark.parametrize("made", ONLINE)
def test_two_updates_at_the_same_time_are_two_samples(made):
    spec = declared(made, "out = once[0:1](req)")
    assert [spec.update(0, [("req", x)]) for x in (3.0, 1.0, 2.0)] == [3.0, 3.0, 2.0]
    assert spec.sampling_violation_counter == 2
    assert spec.update(1, [("req", 0.0)]) == 2.0
    assert spec.sampling_violation_counter == 2


def test_two_updates_at_the_same_time_are_two_samples_of_the_definition_in_python(monkeypatch):
    from rtamt.compat import backends

    monkeypatch.setattr(backends, "is_compiled", lambda: False)
    spec = declared(rtamt.StlDiscreteTimeSpecification, "out = once[0:1](req)")
    assert [spec.update(0, [("req", x)]) for x in (3.0, 1.0, 2.0)] == [3.0, 3.0, 2.0]
    assert spec.sampling_violation_counter == 2


@pytest.mark.parametrize("made", ONLINE)
def test_a_time_before_the_last_one_is_refused_and_a_wrong_value_at_the_same_time_is_told_as_such(made):
    spec = declared(made, "out = req >= 0")
    spec.update(1, [("req", 1.0)])
    with pytest.raises(rtamt.RTAMTException, match="time does not increase at sample 1: 0 s comes after 1 s"):
        spec.update(0, [("req", 1.0)])
    with pytest.raises(rtamt.RTAMTException, match="'req' is NaN"):
        spec.update(1, [("req", float("nan"))])
    assert spec.update(1, [("req", 2.0)]) == 2.0


def test_our_own_monitors_refuse_the_same_time_again():
    monitor = rtamt.parse("once[0:1](x)").monitor()
    monitor.update(0.0, x=1.0)
    with pytest.raises(rtamt.TraceError):
        monitor.update(0.0, x=1.0)


def test_explanations_are_kept_by_the_names_of_nodes():
    spec = declared(rtamt.StlDiscreteTimeOfflineSpecification, "out = eventually[0,1] req")
    assert spec.explainer.explanations == {}
    spec.evaluate({"time": [0, 1, 2, 3], "req": [-1, -1, -2, 5]})
    spec.explain()
    assert spec.explainer.explanations == {"eventually[0,1](req)": [[0, 0]], "req": [[0, 1]]}
    spec.evaluate({"time": [0, 1, 2, 3], "req": [1, -1, -2, 5]})
    spec.explain()
    assert spec.explainer.explanations == {}


def test_explanations_of_a_predicate_name_it_and_its_variables():
    spec = declared(rtamt.StlDiscreteTimeOfflineSpecification, "out = always(req >= 3)")
    spec.evaluate({"time": [0, 1, 2], "req": [5, 1, 4]})
    spec.explain()
    assert spec.explainer.explanations == {
        "always((req)>=(3.0))": [[0, 0]],
        "(req)>=(3.0)": [[1, 1]],
        "req": [[1, 1]],
    }


def test_explanations_in_dense_time_are_intervals_of_time():
    spec = declared(rtamt.StlDenseTimeOfflineSpecification, "out = always[0,2](req >= 3)")
    spec.evaluate(["req", [[0, 5.0], [1, 1.0], [1.5, 4.0]]])
    spec.explain()
    assert spec.explainer.explanations["always[0,2]((req)>=(3.0))"] == [[0.0, 0.0]]
    ((start, end),) = spec.explainer.explanations["req"]
    assert 1.0 <= start <= end <= 1.5


@pytest.mark.parametrize(
    ("made", "data"),
    [
        (rtamt.StlDiscreteTimeOfflineSpecification, ({"time": [0, 1, 2, 3], "req": [-1, -1, -2, 5]},)),
        (rtamt.StlDenseTimeOfflineSpecification, (["req", [[0, 5.0], [1, 1.0]]],)),
    ],
)
def test_what_was_evaluated_is_plotted(made, data):
    spec = declared(made, "out = eventually[0,1] (req >= 3)")
    with pytest.raises(rtamt.RTAMTException, match="nothing to plot yet"):
        spec.plot()
    spec.evaluate(*data)
    figure = spec.plot(figure=Figure())
    titles = [axis.get_title(loc="left") for axis in figure.axes]
    assert titles == ["", "out = eventually[0,1] (req >= 3)", "req >= 3"]


# ---- points of dense-time results, where nothing changes --------------------------------------------------

STEPS = [[0, -1], [1, 1], [2, 1], [3, -4], [4, 4], [5, 4], [6, 5]]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("req", [-1, 1, 1, -4, 4, 4, 5]),
        ("not req", [1, -1, -1, 4, -4, -4, -5]),
        ("once req", [-1, 1, 1, 1, 4, 4, 5]),
        ("historically(abs(req))", [1, 1, 1, 1, 1, 1, 1]),
    ],
)
def test_operators_with_one_operand_keep_its_points_in_every_chunk_online(text, values):
    expected = [[time, value] for (time, _), value in zip(STEPS, values, strict=True)]
    spec = declared(rtamt.StlDenseTimeOnlineSpecification, text)
    assert spec.update(["req", STEPS]) == expected
    for size in (1, 2, 3):
        spec.reset()
        parts = [spec.update(["req", STEPS[i : i + size]]) for i in range(0, 7, size)]
        assert [point for part in parts for point in part] == expected
    spec.reset()
    assert spec.update(["req", STEPS[:3]]) + spec.final_update(["req", STEPS[3:]]) == expected


def test_points_are_those_of_the_operand_where_it_has_fewer_than_its_signals():
    spec = declared(rtamt.StlDenseTimeOnlineSpecification, "once(req > 0)")
    assert spec.update(["req", STEPS]) == [[0, -1], [1, 1], [3, 1], [4, 4], [6, 5]]
    spec = declared(rtamt.StlDenseTimeOnlineSpecification, "(once req) or (once req)")
    assert spec.update(["req", STEPS]) == [[0, -1], [1, 1], [4, 4], [6, 5]]


def test_times_between_two_ticks_are_kept_as_the_ticks_that_count_them():
    spec = declared(rtamt.StlDenseTimeOnlineSpecification, "once req")
    assert spec.update(["req", [[0, 1], [1 / 3, 1], [2 / 3, 2], [1, 0]]]) == [
        [0, 1],
        [0.333333333, 1],
        [0.666666667, 2],
        [1, 2],
    ]


def test_signals_without_samples_have_a_robustness_without_points():
    spec = declared(rtamt.StlDenseTimeSpecification, "out = always[0,1] req")
    assert spec.evaluate(["req", []]) == []
    assert spec.get_value("out") == []
    both = declared(rtamt.StlDenseTimeSpecification, "req and out")
    assert both.evaluate(["req", []], ["out", []]) == []
    with pytest.raises(rtamt.RTAMTException, match="'out' has no samples: give at least one"):
        both.evaluate(["req", [[0, 1]]], ["out", []])
    with pytest.raises(rtamt.RTAMTException, match="nothing to explain yet"):
        spec.explain()


# ---- module paths, trees and interpreters -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "names"),
    [
        ("spec.stl.discrete_time.specification", "StlDiscreteTimeSpecification Semantics Language"),
        ("spec.stl.dense_time.specification", "StlDenseTimeSpecification Semantics Language"),
        ("semantics.enumerations.options", "Semantics Language TimeInterpretation"),
        ("semantics.enumerations.io_type", "StlIOType"),
        ("semantics.enumerations.comp_op", "StlComparisonOperator"),
        ("semantics.stl.dense_time.online.interpreter", "StlDenseTimeOnlineInterpreter"),
        ("syntax.ast.parser.stl.specification_parser", "StlAst"),
        ("pastifier.stl.pastifier", "StlPastifier"),
        ("pastifier.ltl.horizon", "LtlHorizon"),
        ("exception.exception", "RTAMTException"),
    ],
)
def test_names_are_imported_from_the_modules_of_rtamt(module, names):
    found = import_module(f"rtamt.{module}")
    for name in names.split():
        assert getattr(found, name) is getattr(rtamt, name, getattr(found, name))


def test_a_module_below_a_package_of_rtamt_that_is_not_provided_does_not_exist():
    with pytest.raises(ModuleNotFoundError):
        import_module("rtamt.semantics.stl.dense_time.online.and_operation")


def tree(text):
    made = import_module("rtamt.syntax.ast.parser.stl.specification_parser").StlAst
    return declared(made, text)


@pytest.mark.parametrize(
    ("text", "unit", "horizon"),
    [
        ("always[0,2](eventually[1,3] req)", "s", 5),
        ("historically[0,2] req", "s", 0),
        ("eventually[0,0.5] req", "s", 0.5),
        ("eventually[0,500] req", "ms", 500),
        ("eventually[0,500ms] req", "s", 0.5),
    ],
)
def test_the_horizon_of_a_formula_is_in_the_unit_of_its_specification(text, unit, horizon):
    visitor = import_module("rtamt.pastifier.stl.horizon").StlHorizon()
    spec = rtamt.StlDenseTimeSpecification()
    spec.unit = unit
    spec.declare_var("req", "float")
    spec.spec = text
    spec.parse()
    (node,) = spec.ast.specs
    assert visitor.visit(node, None) == horizon
    assert visitor.horizons[node] == horizon


def test_next_counts_one_sampling_period_in_a_horizon():
    spec = declared(rtamt.StlDiscreteTimeSpecification, "next req")
    spec.set_sampling_period(200, "ms", 0.1)
    assert import_module("rtamt.pastifier.stl.horizon").StlHorizon().visit(spec.ast.specs[0]) == 0.2


def test_an_unbounded_future_has_no_horizon():
    visitor = import_module("rtamt.pastifier.stl.horizon").StlHorizon()
    with pytest.raises(rtamt.RTAMTException, match=r"'always\(req\)' has an unbounded future operator"):
        visitor.visit(tree("always req").specs[0])


def test_a_tree_is_pastified_in_place():
    ast = tree("eventually[0,1](req >= 3)")
    pastifier = import_module("rtamt.pastifier.stl.pastifier").StlPastifier()
    assert pastifier.pastify(ast) is ast
    assert [node.name for node in ast.specs] == ["once[0,1]((req)>=(3.0))"]


def test_interpreters_evaluate_a_tree_in_their_time_domain():
    offline = "rtamt.semantics.stl.{}_time.offline.interpreter"
    online = "rtamt.semantics.stl.{}_time.online.interpreter"
    ast = tree("once[0,1](req >= 3)")
    discrete = import_module(offline.format("discrete")).StlDiscreteTimeOfflineInterpreter()
    discrete.set_ast(ast)
    assert discrete.evaluate({"time": [0, 1, 2], "req": [5, 1, 1]}) == [[0, 2], [1, 2], [2, -2]]
    dense = import_module(offline.format("dense")).StlDenseTimeOfflineInterpreter()
    dense.set_ast(ast)
    assert dense.evaluate([["req", [[0, 5], [1, 1], [3, 1]]]]) == [[0, 2], [2, -2], [3, -2]]
    stepping = import_module(online.format("discrete")).StlDiscreteTimeOnlineInterpreter()
    stepping.set_sampling_period(500, "ms", 0.1)
    stepping.set_ast(ast)
    for _ in range(2):
        assert [stepping.update(0.5 * i, [("req", x)]) for i, x in enumerate([5, 1, 1, 1])] == [2, 2, 2, -2]
        stepping.reset()
    streaming = import_module(online.format("dense")).StlDenseTimeOnlineInterpreter()
    streaming.set_ast(ast)
    for _ in range(2):
        assert streaming.update([["req", [[0, 5], [1, 1]]]]) == [[0, 2], [1, 2]]
        assert streaming.update([["req", [[3, 1]]]]) == [[2, -2], [3, -2]]
        streaming.reset()
    ast.spec = "req"
    ast.parse()
    assert discrete.evaluate({"time": [0], "req": [5]}) == [[0, 2]]


def test_a_copy_of_a_tree_is_independent_of_it():
    ast = tree("once req")
    other = copy.deepcopy(ast)
    assert other.specs == ast.specs
    other.spec = "historically req"
    other.parse()
    assert [node.name for node in ast.specs] == ["once(req)"]
