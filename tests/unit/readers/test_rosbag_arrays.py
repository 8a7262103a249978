"""Arrays of a bag whose length changes from message to message: obstacles, detections, joints."""

from __future__ import annotations

import json

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg

import rtamt
from rtamt.cli import main
from tests.unit.readers.bags import Bag

START = 1_700_000_000
SECOND = 10**9
OBSTACLES = 'group obs = "/o.obs[*]"\nalways(forall o in obs: o.d >= 0)'


def obstacles(folder, kind, rows, element="float64 d"):
    """Write a message each second, with an obstacle for each number of a row."""
    with Bag(folder, kind) as bag:
        for name, text in (("Ob", element), ("Obs", "my_msgs/Ob[] obs\nfloat64 x")):
            bag.store.register(get_types_from_msg(text, f"my_msgs/msg/{name}"))
        types = bag.store.types
        for at, row in enumerate(rows):
            obs = [types["my_msgs/msg/Ob"](d=value) for value in row]
            message = types["my_msgs/msg/Obs"](obs=obs, x=1.0)
            bag.write("/o", "my_msgs/msg/Obs", (START + at) * SECOND, message)
    return str(bag.path)


@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
@pytest.mark.parametrize(
    "options",
    [
        ["--time", "dense"],
        ["--time", "dense", "--early"],
        ["--time", "dense", "--engine", "local"],
        ["--period", "1s"],
        ["--period", "1s", "--engine", "local"],
    ],
    ids=" ".join,
)
@pytest.mark.parametrize(
    "rows", [[[5], [5, 4], [5, -3], [6]], [[], [], [5, -3], [6]], [[5, 4], [5], [5, -3], [6]]], ids=str
)
def test_an_obstacle_that_the_first_message_lacks_was_left_out(tmp_path, capsys, kind, options, rows):
    path = obstacles(tmp_path, kind, rows)
    assert main(["check", OBSTACLES, path, "--json", *options]) == 1
    row = json.loads(capsys.readouterr().out)
    assert (row["robustness"], row["first_violation"]) == (-3, START + 2)


def test_an_element_is_read_by_its_name_and_only_where_it_is(tmp_path):
    path = obstacles(tmp_path, "mcap", [[5], [5, 4], [], [6, 7]])
    trace = rtamt.read(path)
    assert trace.names == ("/o.obs[0].d", "/o.obs[1].d", "/o.x")
    for found in (trace, rtamt.read(path, columns=["/o.obs[1].d"])):
        signal = found["/o.obs[1].d"]
        assert signal.values.tolist() == [4, 7]
        assert ((signal.times - trace.start) / np.timedelta64(1, "s")).tolist() == [1, 3]


def test_a_variable_that_recordings_may_lack_was_not_found_in_later_messages(tmp_path, capsys):
    path = obstacles(tmp_path, "mcap", [[5], [5, -3], [6, 1]])
    text = 'optional input float v = "/o.obs[1].d"\nrequire R: always(v >= 0)'
    for options in (["--time", "dense"], ["--time", "dense", "--engine", "local"]):
        assert main(["check", text, path, "--json", *options]) == 1
        assert json.loads(capsys.readouterr().out)["robustness"] == -3


def test_members_of_an_enumeration_are_read_in_elements_that_the_first_message_lacks(tmp_path):
    path = obstacles(tmp_path, "mcap", [[], [7], [3, 7]], element="uint8 d\nuint8 NEAR=7\nuint8 FAR=3\n")
    spec = rtamt.parse('enum Range { FAR, NEAR }\ninput Range r = "/o.obs[0].d"\nalways(r == FAR)')
    trace = rtamt.read(path, columns=["/o.obs[0].d"], types={"/o.obs[0].d": spec.types["r"]})
    assert trace["/o.obs[0].d"].values.tolist() == [1, 0]


def test_an_array_that_is_too_long_in_some_messages_has_a_note_and_no_columns(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        bag.scan("/scan", 1, np.ones(999))
        bag.scan("/scan", 2, np.zeros(1001))
        bag.scan("/image", 1, np.ones(5000))
    trace = rtamt.read(bag.path)
    assert not [name for name in trace if ".ranges[" in name]
    assert trace.losses == (
        "left out: /scan.ranges, which is too long in some messages: more than 1000 elements, or 10000 numbers",
    )
    one = rtamt.read(bag.path, columns=["/scan.ranges[0]"])
    assert one["/scan.ranges[0]"].values.tolist() == [1, 0]


def test_a_group_of_elements_of_an_array_that_is_too_long_in_some_messages_has_no_members(tmp_path, capsys):
    """Its first elements alone could satisfy a requirement that the others violate."""
    path = obstacles(tmp_path, "mcap", [[5], [5] * 1000 + [-3]])
    assert main(["check", OBSTACLES, path, "--time", "dense"]) == 2
    assert "has no member of the group 'obs'" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--time", "dense"], ["--period", "1s"]], ids=" ".join)
@pytest.mark.parametrize("engine", [[], ["--engine", "local"]], ids=["one", "many"])
def test_a_requirement_over_members_began_with_the_first_sample_of_another_requirement(
    tmp_path, capsys, options, engine
):
    with Bag(tmp_path, "mcap") as bag:
        for name, text in (("Ob", "float64 d"), ("Obs", "my_msgs/Ob[] obs")):
            bag.store.register(get_types_from_msg(text, f"my_msgs/msg/{name}"))
        types = bag.store.types
        for at, value in enumerate([-5.0, 5, 5, 5, 5]):
            message = types["my_msgs/msg/Obs"](obs=[types["my_msgs/msg/Ob"](d=value)])
            bag.write("/o", "my_msgs/msg/Obs", (START + at) * SECOND, message)
            if at > 1:
                bag.plain("/late", START + at, 1.0)
    specification = (
        'group obs = "/o.obs[*]"\ngroup others = "/p.obs[*]"\nrequire A: always(forall o in obs: o.d >= 0)\n'
        'require B: always("/late.data" >= 0)\nrequire C: always(forall o in others: o.d >= 0)\n'
    )
    (tmp_path / "a.stl").write_text(specification)
    assert main(["check", str(tmp_path / "a.stl"), str(bag.path), "--json", *options, *engine]) == 2
    a, b, c = map(json.loads, capsys.readouterr().out.splitlines())
    assert (a["robustness"], a["first_violation"]) == (-5, START)
    assert b["robustness"] == 1
    assert "no member of the group 'others'" in c["error"]


def test_an_array_of_arrays_with_many_numbers_has_no_columns(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for name, text in (("Row", "float64[] v"), ("Grid", "my_msgs/Row[] rows\nfloat64 x")):
            bag.store.register(get_types_from_msg(text, f"my_msgs/msg/{name}"))
        types = bag.store.types
        for topic, count in (("/large", 101), ("/small", 3)):
            rows = [types["my_msgs/msg/Row"](v=np.zeros(100)) for _ in range(count)]
            bag.write(topic, "my_msgs/msg/Grid", START * SECOND, types["my_msgs/msg/Grid"](rows=rows, x=1.0))
    names = rtamt.read(bag.path).names
    assert [name for name in names if name.startswith("/large")] == ["/large.x"]
    assert "/small.rows[2].v[99]" in names


def test_topics_that_no_requirement_reads_are_not_searched(tmp_path, monkeypatch):
    """Point clouds and images are most of a bag."""
    with Bag(tmp_path, "mcap") as bag:
        for i in range(50):
            bag.scan("/scan", i + 1, np.ones(i + 1))
            bag.plain("/y", i + 1, 1.0)
    from rtamt.readers import rosbag

    read = []
    message = rosbag._message
    monkeypatch.setattr(rosbag, "_message", lambda *given: read.append(given[1].topic) or message(*given))
    rtamt.read(bag.path, columns=["/y.data"])
    assert read.count("/scan") == 1
    rtamt.read(bag.path, columns=["/scan.ranges[0]"])
    assert read.count("/scan") == 2 + 50
    rtamt.read(bag.path, columns=["/scan.ranges[49]"])
    assert read.count("/scan") == 3 + 50 + 100


@pytest.mark.parametrize("engine", [[], ["--engine", "local"]], ids=["one", "many"])
def test_topics_with_headers_are_members_without_their_timestamps(tmp_path, capsys, engine):
    """The pattern also matched "/s/a stamp", the name of the timestamps, so that "/s/a stamp.value" was missing."""
    with Bag(tmp_path, "mcap") as made:
        for i in range(3):
            made.stamped("/s/a", 1 + i, 2.0)
            made.stamped("/s/b", 1 + i, 1.0)
    text, spec = 'group g = "/s/*"\nalways(forall f in g: f.value >= 0)\n', tmp_path / "a.stl"
    spec.write_text(text)
    assert main(["check", str(spec), str(made.path), "--json", "--time", "dense", *engine]) == 0
    assert json.loads(capsys.readouterr().out)["robustness"] == 1
