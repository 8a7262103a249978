"""The types that a type checker infers in a user's program: ``make lint`` checks this file, pytest runs it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import rtamt
from rtamt.compiler.program import Program
from rtamt.explain.explanation import Explanation
from rtamt.language.formula import Formula
from rtamt.verdicts.early.dense_causation import DenseCausationMonitor
from rtamt.verdicts.early.dense_eager import DenseEagerMonitor
from rtamt.verdicts.early.discrete_eager import EagerMonitor
from rtamt.verdicts.early.interval import IntervalMonitor

if TYPE_CHECKING:
    from typing_extensions import assert_type
else:

    def assert_type(value: Any, _type: Any) -> Any:
        """Return the value, as ``typing.assert_type`` of Python 3.11 does."""
        return value


DATA = {"x": [4.0, 2.0, 5.0]}


def specifications() -> None:
    spec = assert_type(rtamt.parse("p = x >= 3; require A: always[0:1](p)"), rtamt.Specification)
    assert_type(spec.formula, Formula)
    assert_type(spec.input_names, tuple[str, ...])
    assert_type(spec.horizon, float)
    assert_type(spec.requirements, Mapping[str, rtamt.Specification])
    assert_type(spec.select("A"), rtamt.Specification)
    assert_type(spec.with_parameters(), rtamt.Specification)
    assert_type(spec.parameters, Mapping[str, float])
    assert_type(spec.compile(), Program)
    assert_type(rtamt.robustness("x >= 3", DATA), float)


def results() -> None:
    spec = rtamt.parse("p = x >= 3; always(p)")
    result = assert_type(spec.evaluate(DATA), rtamt.Result)
    assert_type(result.robustness, float)
    assert_type(result.satisfied, bool)
    assert_type(result.signal, rtamt.Signal)
    assert_type(result["p"], rtamt.Signal)
    assert_type(result.interval, rtamt.Interval)
    assert_type(result.requirements, Mapping[str, rtamt.Result])
    assert_type(result.explain(), Explanation)
    assert_type(rtamt.evaluate_all([spec], DATA), list[rtamt.Result])
    assert_type(rtamt.evaluate_batch(spec, [DATA]), list[rtamt.Result])
    batch = assert_type(spec.evaluate_batch({"x": [[1.0], [2.0]]}), rtamt.BatchResult)
    assert_type(batch[0], rtamt.Result)
    assert_type(rtamt.check_stream(spec, [DATA]), rtamt.StreamResult)


def monitors() -> None:
    spec = rtamt.parse("always[0:1](x >= 3)")
    monitor = assert_type(spec.monitor(watch=["x >= 3", spec.formula]), rtamt.Monitor)
    assert_type(monitor.update(0.0, x=4), float | None)
    assert_type(monitor["x >= 3"], float | rtamt.Signal | None)
    assert_type(monitor[spec.formula], float | rtamt.Signal | None)
    assert_type(monitor.update_many({"time": [1.0, 2.0], "x": [4.0, 5.0]}), rtamt.Signal)
    assert_type(monitor.finish(), rtamt.Signal)
    assert_type(spec.monitor(time=rtamt.Discrete()), rtamt.Monitor)
    dense = assert_type(spec.monitor(time="dense", watch=spec.formula), rtamt.DenseMonitor)
    assert_type(dense.update(0.0, x=4), rtamt.Signal)
    assert_type(dense[spec.formula], rtamt.Signal)
    assert_type(spec.monitor(time=rtamt.Dense()), rtamt.DenseMonitor)
    eager = assert_type(spec.monitor(verdict="eager"), EagerMonitor)
    assert_type(eager.update(0.0, x=4), list[rtamt.Verdict])
    assert_type(spec.monitor(verdict="interval"), IntervalMonitor)
    runs = assert_type(spec.monitor(time="dense", verdict="eager"), DenseEagerMonitor)
    assert_type(runs.update(0.0, x=4), list[rtamt.VerdictRun])
    bounds = assert_type(spec.monitor(time="dense", verdict="interval", lateness="1s"), IntervalMonitor)
    assert_type(bounds.interval(), rtamt.Interval)
    caused = assert_type(spec.monitor(time="dense", verdict="causation"), DenseCausationMonitor)
    assert_type(caused.update(0.0, x=4), rtamt.Causation)
    assert_type(caused.runs(), list[rtamt.CausationRun])


def fleets() -> None:
    spec = rtamt.parse("always[0:1](x >= 3)")
    suite = rtamt.Suite({"LOW": spec})
    batch: tuple[Any, Any, Any] = ([7], [0.0], {"x": [4.0]})
    assert_type(rtamt.Fleet(spec, 9).update_many(*batch), rtamt.FleetUpdate)
    assert_type(rtamt.Fleet(spec, 9, lateness="1s", gaps="hold").watermark(1), rtamt.FleetUpdate)
    assert_type(rtamt.Fleet(suite, 9).update_many(*batch), rtamt.FleetUpdate)
    assert_type(rtamt.Fleet(spec, 9, time="dense").update_many(*batch), rtamt.FleetPoints)
    assert_type(rtamt.Fleet(spec, 9, verdict="eager").update_many(*batch), rtamt.FleetVerdicts)
    bounds = assert_type(rtamt.Fleet(spec, 9, verdict="interval"), rtamt.Fleet[rtamt.FleetBounds])
    assert_type(bounds.update_many(*batch), rtamt.FleetBounds)
    assert_type(bounds.watermark(1), rtamt.FleetBounds)
    assert_type(
        rtamt.Fleet(spec, 9, time="dense", verdict="causation").update_many(*batch), rtamt.FleetCausation
    )
    eager = rtamt.Fleet(suite, 9, verdict="eager")
    assert_type(eager.update_many(*batch), rtamt.SuiteUpdate[rtamt.FleetVerdicts])
    assert_type(eager.update_many([8], [0.0], {"x": [4.0]})["LOW"], rtamt.FleetVerdicts)
    assert_type(rtamt.Fleet.restore(spec, rtamt.Fleet(spec, 9).snapshot()), rtamt.Fleet[rtamt.FleetUpdate])
    again = rtamt.Fleet.restore(suite, eager.snapshot(), verdict="eager")
    assert_type(again.update_many([9], [0.0], {"x": [4.0]}), rtamt.SuiteUpdate[rtamt.FleetVerdicts])


def recordings(path: str) -> None:
    trace = assert_type(rtamt.read(path), rtamt.Trace)
    assert_type(rtamt.scan(path), Iterator[rtamt.Trace])
    assert_type(rtamt.parse("x >= 3").evaluate(trace), rtamt.Result)
