"""A requirement that reads no variable has the same verdict everywhere: alone, in a file and beside others."""

from __future__ import annotations

import json
import pickle

import pytest

import rtamt
from rtamt.cli import main, runner

TEXT = """\
require FREE: always({free})
require READS: always(x >= 0)
require WRONG: always(sqrt(y) >= 0)
"""
DATA = {"time": [0, 1, 2], "x": [1, 2, 3], "y": [1, 4, 9]}
FREE = [("1 >= 0", 1.0), ("0 >= 1", -1.0), ("once[1:2](1 >= 0)", float("-inf"))]


@pytest.fixture(params=["discrete", "dense"])
def time(request):
    return request.param


@pytest.fixture(params=FREE)
def spec(request, time):
    return rtamt.parse(TEXT.format(free=request.param[0]), time=time)


@pytest.fixture
def expected(spec):
    return spec.evaluate(DATA).requirements["FREE"]


def test_alone_and_in_a_suite(spec, expected):
    alone = spec.requirements["FREE"]
    for each in (alone, pickle.loads(pickle.dumps(alone)), spec.select("FREE")):
        result = each.evaluate(DATA)
        assert result.robustness == expected.robustness
        assert result.satisfied == expected.satisfied
    for specs in (spec, alone):
        row, *_ = rtamt.Suite(specs).evaluate(DATA)
        assert (row.robustness, row.satisfied, row.error) == (expected.robustness, expected.satisfied, None)


def test_the_values_are_those_of_free_formulas(time):
    for text, robustness in FREE:
        spec = rtamt.parse(TEXT.format(free=text), time=time)
        assert spec.requirements["FREE"].evaluate(DATA).robustness == robustness


def test_bounds_online(spec, expected):
    monitor = spec.requirements["FREE"].monitor(verdict="interval", at="start")
    for t, x, y in zip(*DATA.values(), strict=True):
        monitor.update(t, **({"x": x, "y": y} if spec.time == "dense" else {}))
    monitor.finish()
    assert monitor.interval() == rtamt.Interval(expected.robustness, expected.robustness)


@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval", "causation"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_every_monitor_in_dense_time_starts_with_the_variables_of_the_file(verdict, backend):
    text = "require FREE: 1 >= 0; require READS: x >= 0"
    spec = rtamt.parse(text, time="dense", backend=backend).requirements["FREE"]
    found = []
    for known in (spec, rtamt.parse("1 >= 0 and (inf or x)", time="dense", backend=backend)):
        monitor = known.monitor(verdict=verdict)
        found.append([monitor.update(0.5, x=1), monitor.update(2, x=1), monitor.finish()])
    assert repr(found[0]) == repr(found[1])


@pytest.mark.parametrize("wrong", [False, True])
@pytest.mark.parametrize("how", ["whole", "moderate", "large", "early", "engine"])
def test_on_the_command_line(spec, expected, tmp_path, capsys, monkeypatch, how, wrong):
    (tmp_path / "spec.stl").write_text(spec.text)
    y = ("1", "-4", "9") if wrong else ("1", "4", "9")  # then each requirement is checked alone
    rows = (f"{t},{t + 1},{each}\n" for t, each in enumerate(y))
    (tmp_path / "log.csv").write_text("time,x,y\n" + "".join(rows))
    for limit in {"moderate": ["MODERATE"], "large": ["MODERATE", "LARGE"]}.get(how, []):
        monkeypatch.setattr(runner, limit, 0)
    options = {"early": ["--early"], "engine": ["--engine", "local"]}.get(how, [])
    given = [str(tmp_path / "spec.stl"), str(tmp_path / "log.csv"), "--time", spec.time, "--json"]
    main(["check", *given, *options])
    free, reads, undefined = map(json.loads, capsys.readouterr().out.splitlines())
    assert float(free["robustness"]) == expected.robustness
    assert free["satisfied"] == expected.satisfied
    assert reads["satisfied"]
    assert ("error" in undefined) == wrong


def test_without_any_variable_dense_time_has_no_instants(tmp_path, capsys):
    message = (
        "the formula reads no variable, so that it has no instants in dense time: let it read a variable, or "
        "evaluate it in discrete time"
    )
    spec = rtamt.parse("require A: historically(1 >= 0); require B: 0 >= 1", time="dense")
    for each in (spec, *spec.requirements.values()):
        with pytest.raises(rtamt.UsageError, match=message):
            each.evaluate(DATA)
        with pytest.raises(rtamt.UsageError, match=message):
            each.monitor()
    assert {row.error for row in rtamt.Suite(spec).evaluate(DATA)} == {message}
    for header in ("time,x", "y,x"):
        (tmp_path / "log.csv").write_text(f"{header}\n0,1\n")
        for options in ([], ["--early"], ["--engine", "local"]):
            given = ["always(1 >= 0)", str(tmp_path / "log.csv"), "--time", "dense", "--json"]
            assert main(["check", *given, *options]) == 2
            assert json.loads(capsys.readouterr().out)["error"].endswith(message)


def test_of_variables_that_recordings_may_lack_others_are_read():
    text = "optional float v; float x; require FREE: 1 >= 0; require V: v >= 0; require X: x >= 0"
    spec = rtamt.parse(text, time="dense")
    assert spec.requirements["FREE"].input_names == ("x",)
    free, v, x = rtamt.Suite(spec).evaluate({"time": [0, 1], "x": [1, 2]})
    assert (free.satisfied, v.unchecked, x.satisfied) == (True, "not checked: no 'v'", True)
