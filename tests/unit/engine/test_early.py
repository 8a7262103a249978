"""Back ends offer the sessions of early verdict modes, and monitors use nothing else of them."""

from __future__ import annotations

import copy
import math

import pytest

import rtamt
from rtamt.engine.dense.backends import BACKENDS as DENSE
from rtamt.engine.discrete.backends import BACKENDS as DISCRETE

TEXT = "always[0:2](x >= 0 -> eventually[0:1](y >= 1))"
SAMPLES = [{"x": 1, "y": 0}, {"x": 2, "y": 0}, {"x": 1, "y": 3}, {"x": -1, "y": 2}, {"x": -1, "y": 0}]
MODES = ("eager", "interval", "causation")

modes = pytest.mark.parametrize("verdict", MODES)
domains = pytest.mark.parametrize(("time", "backends"), [("discrete", DISCRETE), ("dense", DENSE)])


class Recorder:
    """A back end that can be asked for early sessions alone: those of another one."""

    def __init__(self, answering):
        self.answering = answering
        self.queries = []

    def early_session(self, query, domain):
        self.queries.append(query)
        return self.answering.early_session(query, domain)


def reports(monitor):
    found = [(monitor.update(t, **row), _state(monitor)) for t, row in enumerate(SAMPLES)]
    return [*found, (monitor.finish(), _state(monitor))]


def _state(monitor):
    if hasattr(monitor, "causation"):
        return monitor.causation(), monitor.runs()
    return (monitor.interval(), monitor.changes()) if hasattr(monitor, "interval") else None


@domains
@modes
def test_a_monitor_uses_what_its_back_end_offers_whatever_its_name(time, backends, verdict, monkeypatch):
    expected = reports(rtamt.parse(TEXT, backend="python").monitor(verdict=verdict, time=time))
    recorder = Recorder(backends["python"])
    monkeypatch.setitem(backends, "cpp", recorder)
    monitor = rtamt.parse(TEXT).monitor(verdict=verdict, time=time)
    assert reports(monitor) == expected
    assert len(recorder.queries) == 1
    opened = type(monitor._backend)
    assert opened.__module__ == f"rtamt.engine.{time}.early_python_backend"


@domains
@modes
def test_copies_and_resets_open_monitors_of_the_same_session(time, backends, verdict, monkeypatch):
    recorder = Recorder(backends["cpp"])
    monkeypatch.setitem(backends, "cpp", recorder)
    monitor = rtamt.parse(TEXT).monitor(verdict=verdict, time=time)
    monitor.update(0, x=1, y=0)
    twin = copy.copy(monitor)
    monitor.reset()
    assert (monitor.samples, twin.samples) == (0, 1 if time == "discrete" else 2)
    assert twin._session is monitor._session
    assert len(recorder.queries) == 1


@domains
@pytest.mark.parametrize(
    ("settings", "asked"),
    [
        (
            {"verdict": "eager"},
            {"verdicts": True, "causes": False, "start": False, "hidden": 0, "late": None},
        ),
        (
            {"verdict": "interval"},
            {"verdicts": False, "causes": False, "start": True, "hidden": 0, "late": None},
        ),
        ({"verdict": "interval", "at": "start"}, {"start": True, "hidden": 1}),
        (
            {"verdict": "interval", "lateness": "3s", "on_correction": "replay", "ranges": {"x": (0, 9)}},
            {"replays": True, "inputs": ("x", "y"), "ranges": [(0.0, 9.0), (-math.inf, math.inf)]},
        ),
        (
            {"verdict": "causation"},
            {"verdicts": False, "causes": True, "start": True, "hidden": 0, "late": None},
        ),
    ],
)
def test_a_query_holds_the_settings_of_the_monitor(time, backends, settings, asked, monkeypatch):
    recorder = Recorder(backends["cpp"])
    monkeypatch.setitem(backends, "cpp", recorder)
    rtamt.parse(TEXT).monitor(time=time, **settings)
    (query,) = recorder.queries
    assert {name: getattr(query, name) for name in asked} == asked


@pytest.mark.parametrize("verdict", ["eager", "interval"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_watched_formula_that_is_the_whole_has_the_trace_of_all_variables(backend, verdict):
    spec = rtamt.parse("require A: x >= 0\nrequire B: y >= 0", time="dense", backend=backend)
    monitor = spec.monitor(verdict=verdict, watch=[spec.formula])
    monitor.update(0, x=1)
    monitor.update(1, y=2)
    monitor.update(3, x=-1, y=2)
    first = monitor[spec.formula][0]
    assert first.begin == 1.0
