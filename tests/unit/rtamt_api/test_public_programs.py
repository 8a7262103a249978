"""Programs as RTAMT's users write them, where RTAMT accepts what our own monitors reject."""

from __future__ import annotations

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
    from rtamt.rtamt_api import backends

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
