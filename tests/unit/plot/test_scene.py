"""What a scene holds: the same numbers as the result, where each formula fails, and the explanation's places."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.plot.lines import Line
from rtamt.plot.scene import scene

ANSWER = "asked = req >= 3; always(asked -> eventually[0:2](gnt >= 3))"


@pytest.fixture
def violated():
    data = {"req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 7]}
    return rtamt.parse(ANSWER).evaluate(data)


def test_every_sub_formula_has_its_values(violated):
    seen = scene(violated)
    assert [node.text for node in seen.nodes] == [
        "always(asked -> eventually[0:2](gnt >= 3))",
        "asked -> eventually[0:2](gnt >= 3)",
        "req >= 3",
        "eventually[0:2](gnt >= 3)",
        "gnt >= 3",
    ]
    assert [node.name for node in seen.nodes] == [None, None, "asked", None, None]
    for node in seen.nodes:
        assert node.line.values.tolist() == violated[str(node.formula)].values.tolist()


def test_the_explanation_is_in_its_places(violated):
    seen = scene(violated)
    assert seen.verdict == "violated, robustness -2, first violation at 1 s"
    assert seen.critical == (4, 3.0)
    assert {node.text: node.because for node in seen.nodes if node.because} == {
        "req >= 3": ((0.5, 1.5),),
        "gnt >= 3": ((0.5, 3.5),),
    }
    assert [[line.name for line in panel.lines] for panel in seen.panels] == [["req"], ["gnt"]]
    assert [panel.because for panel in seen.panels] == [((0.5, 1.5),), ((0.5, 3.5),)]


def test_a_formula_with_robustness_0_is_shaded_by_its_truth():
    result = rtamt.parse("x > 3").evaluate({"x": [4, 3, 5]})
    assert scene(result).nodes[0].fails == ((0.5, 1.5),)
    result = rtamt.parse("x >= 3").evaluate({"x": [4, 3, 5]})
    assert scene(result).nodes[0].fails == ()


def test_dense_stretches_are_exact_and_the_last_value_holds():
    spec = rtamt.parse("once[0:1](x >= 3)", time="dense")
    seen = scene(spec.evaluate({"x": ([0.0, 2.0, 2.5, 6.0], [0, 5, 0, 0])}))
    assert seen.nodes[0].fails == ((0.0, 2.0), (3.5, 6.0))


@pytest.mark.parametrize(
    ("timestamps", "origin", "told"),
    [
        (np.array([0, 2, 5], "datetime64[s]"), np.datetime64(0, "ns"), "1970-01-01 00:00:02 (+2 s)"),
        (
            np.array([10**18, 10**18 + 2 * 10**9, 10**18 + 5 * 10**9], "m8[ns]"),
            np.datetime64(10**18, "ns"),
            "2001-09-09 01:46:42 (+2 s)",
        ),
        ([0.0, 2.0, 5.0], 0.0, "2 s"),
        (np.array([0, 2, 5], "timedelta64[s]"), 0.0, "2 s"),
    ],
)
def test_times_of_every_kind_have_positions(timestamps, origin, told):
    result = rtamt.parse("always(x >= 3)").evaluate({"time": timestamps, "x": [5, 1, 4]}, time="dense")
    seen = scene(result)
    assert seen.x_axis.origin == origin
    assert seen.x_axis.text(seen.critical[1]) == told
    assert seen.nodes[1].fails == ((2.0, 5.0),)


def test_dates_in_discrete_time_are_dates():
    timestamps = np.datetime64("2026-03-01T12:00") + np.arange(3) * np.timedelta64(1, "s")
    result = rtamt.parse("always(x >= 3)").evaluate({"time": timestamps, "x": [5, 1, 4]})
    seen = scene(result)
    assert seen.verdict == ("violated, robustness -2, first violation at 2026-03-01 12:00:01 (+1 s)")
    assert seen.explanation.summary[2].startswith(
        "critical point at 2026-03-01 12:00:01 (+1 s): 'x >= 3' is -2"
    )


def test_a_long_chain_is_one_node_and_a_huge_formula_is_cut():
    chain = " and ".join(f"always(x >= {i})" for i in range(300))
    seen = scene(rtamt.parse(chain).evaluate({"x": [1.0]}))
    assert len(seen.nodes) == 200
    assert seen.nodes[0].hidden
    assert seen.nodes[0].label == "φ and ψ and …"
    assert len(seen.chosen(6)) == 6


def test_of_more_requirements_than_have_room_the_violated_ones_are_chosen():
    text = "; ".join(f"require R{i}: always(x >= {i})" for i in range(9))
    seen = scene(rtamt.parse(text).evaluate({"x": [7.5, 6.5]}))
    assert [seen.nodes[i].name for i in seen.chosen(6)] == [None, "R0", "R1", "R2", "R7", "R8"]


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=400), st.integers(1, 20))
@settings(max_examples=50)
def test_decimation_keeps_every_peak_and_both_ends(values, columns):
    line = Line("x", np.arange(len(values), dtype=float), np.array(values))
    small = line.decimated(columns)
    assert len(small.positions) <= max(4 * columns, 1)
    assert (small.values.min(), small.values.max()) == (line.values.min(), line.values.max())
    assert small.positions[[0, -1]].tolist() == line.positions[[0, -1]].tolist()
    assert small.values.tolist() == line.values[small.positions.astype(int)].tolist()


def test_signals_whose_units_are_known_to_differ_have_panels_of_their_own():
    spec = rtamt.parse("always(gap >= 2 * speed and near <= gap)")
    values = {"gap": [40, 30], "speed [m/s]": [10, 12], "near": [5, 6]}
    panels = scene(spec.evaluate(rtamt.read(values))).panels
    assert [[line.label for line in panel.lines] for panel in panels] == [["gap", "speed [m/s]", "near"]]
    known = rtamt.read(values, units={"gap": "m"})
    for time in ("discrete", "dense"):
        stamped = rtamt.read({"time": [0, 1], **values}, units={"gap": "m"}) if time == "dense" else known
        panels = scene(spec.evaluate(stamped, time=time)).panels
        labels = [[line.label for line in panel.lines] for panel in panels]
        assert labels == [["gap [m]", "near"], ["speed [m/s]"]]


def test_signals_are_marked_where_a_predicate_reads_them():
    data = {"x": [5, 1, 1], "z": [0, 0, 1]}
    spec = rtamt.parse("input float x [m]; input float z [s]; (if z > 0 then 9 else delay[2](x)) > 9")
    seen = scene(spec.evaluate(data), 2)
    marked = {line.name: panel.because for panel in seen.panels for line in panel.lines}
    assert marked == {"x": (), "z": ((1.5, 2.5),)}


def test_of_very_many_readings_the_interval_of_the_cause_is_marked():
    x = np.arange(1, 3001) % 2
    seen = scene(rtamt.parse("always(maximum[0:1](x) > 0)").evaluate({"x": x}))
    (panel,) = seen.panels
    assert panel.because == ((-0.5, 2999.5),)
