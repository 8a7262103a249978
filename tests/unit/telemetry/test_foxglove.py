"""Layouts of Foxglove: every path is a field of a topic in the file."""

import pytest

import rtamt
from rtamt.telemetry import layout, write_mcap
from tests.unit.telemetry.results import drive, messages, topics

UNCERTAIN = {"ranges": {"x": (0, 10)}, "uncertainty": {"x": 0.5}}
RESULTS = {
    "two requirements": (drive, False),
    "bounds over time": (drive, True),
    "one requirement": (lambda: rtamt.parse("always(x >= 3)").evaluate({"x": [5, 1]}), False),
    "no variable": (lambda: rtamt.parse("true").evaluate({"time": [0, 1]}), False),
    "uncertain": (lambda: rtamt.parse("x >= 3").evaluate({"x": [1, None, 5]}, **UNCERTAIN), False),
    "other characters": (
        lambda: rtamt.parse('odom.x >= 3 and "x[0]" >= 1').evaluate({"odom.x": [5, 1], "x[0]": [1, 1]}),
        False,
    ),
}


def paths(found):
    """Yield every path of a layout."""
    for panel in found["configById"].values():
        for path in panel.get("paths", []):
            yield path["value"]
        if "topicPath" in panel:
            yield panel["topicPath"]


def leaves(node):
    """Return the names of the panels in an arrangement."""
    return [node] if isinstance(node, str) else [*leaves(node["first"]), *leaves(node["second"])]


@pytest.mark.parametrize("case", RESULTS)
def test_every_path_is_a_field_of_a_topic_that_has_messages(tmp_path, case):
    make, bounds = RESULTS[case]
    result = make()
    write_mcap(result, tmp_path / "x.mcap", bounds=bounds)
    known, rows = topics(tmp_path / "x.mcap"), messages(tmp_path / "x.mcap")
    every = list(paths(layout(result, bounds=bounds)))
    for path in every:
        topic, *fields = path.split(".")
        assert set(topic) <= set("/_-abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789")
        schema = known[topic][0]
        for field in fields:
            schema = schema["properties"][field]
            assert any(field in message or f"{field}_infinite" in message for _, message in rows[topic])
    assert len(every) >= 3


@pytest.mark.parametrize("case", RESULTS)
def test_every_panel_is_shown_once(case):
    make, bounds = RESULTS[case]
    found = layout(make(), bounds=bounds)
    shown = leaves(found["layout"])
    for name in list(shown):
        if name.startswith("Tab!"):
            shown += [leaf for tab in found["configById"][name]["tabs"] for leaf in leaves(tab["layout"])]
    assert sorted(shown) == sorted(found["configById"])


def test_several_requirements_are_in_tabs_and_the_first_violated_one_shows_its_events():
    panels = layout(drive())["configById"]
    assert [tab["title"] for tab in panels["Tab!requirements"]["tabs"]] == ["SPEED", "BRAKE"]
    assert [name for name in panels if name.startswith("RawMessages!")] == ["RawMessages!violations-SPEED"]
    assert [path["label"] for path in panels["StateTransitions!verdicts"]["paths"]] == ["SPEED", "BRAKE"]
