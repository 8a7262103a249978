"""Units that ``rtamt.fmi`` exports, as fmpy runs and couples them."""

from __future__ import annotations

import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

import rtamt
from rtamt import fmi
from rtamt.verdicts.early.at_start import StartMonitor
from tests.integration.fmi.instance import PERIOD, Unit
from tests.unit.fmi import BOTH

RESPONSE = (
    "specification response  const float limit = 3\n"
    "always[0:200ms]((req >= limit) -> eventually[0:300ms](gnt / scale >= limit))"
)


def bits(values: Any) -> list[int]:
    return np.array(values, np.float64).view(np.int64).tolist()


def wave(n: int) -> list[dict[str, float]]:
    rng = np.random.default_rng(7)
    return [
        {"req": float(r), "gnt": float(g), "scale": float(s)}
        for r, g, s in zip(rng.normal(3, 2, n), rng.normal(4, 3, n), rng.uniform(0.5, 2, n), strict=True)
    ]


@BOTH
def test_every_sample_gives_the_bits_that_the_monitor_in_python_gives(unit, version):
    monitor = rtamt.parse(RESPONSE.replace("= 3", "= 2.5")).monitor(period=PERIOD)
    truth = rtamt.parse(RESPONSE.replace("= 3", "= 2.5")).monitor(period=PERIOD, semantics="boolean")
    there = unit(RESPONSE, version, period=PERIOD).begin(start=5.0, limit=2.5)
    assert there.get("limit") == 2.5
    for i, row in enumerate(wave(60)):
        there.set(**row)
        there.step(5.0 + i * PERIOD)
        expected, holds = monitor.update(i * PERIOD, **row), truth.update(i * PERIOD, **row)
        if expected is None:
            assert (there.get("robustness"), there.get("verdict"), there.get("known")) == (0.0, 0, False)
        else:
            assert bits([there.get("robustness")]) == bits([expected])
            assert there.get("verdict") == (1 if holds > 0 else -1)
            assert there.get("known")
            assert there.get("known_since") == pytest.approx(5.0 + i * PERIOD - monitor.horizon)


@BOTH
def test_several_periods_in_one_step_hold_the_input_and_a_step_of_nothing_does_nothing(unit, version):
    monitor = rtamt.parse(RESPONSE).monitor(period=PERIOD)
    there = unit(RESPONSE, version, period=PERIOD).begin()
    time = 0
    for length, row in zip((3, 1, 0, 7, 2, 300), wave(6), strict=True):
        there.set(**row)
        there.step(time * PERIOD, length * PERIOD)
        known = [monitor.step(*(row[name] for name in monitor.input_names)) for _ in range(length)]
        time += length
        if known and known[-1] is not None:
            assert bits([there.get("robustness")]) == bits([known[-1]])
    assert there.get("known")


@BOTH
def test_what_a_plant_does_wrong_is_said_and_the_unit_goes_on(unit, version):
    there = unit("always[0:100ms](x / y >= 1)", version, period=PERIOD).begin()
    there.set(x=3.0, y=1.0)
    there.step(0.0)
    assert there.refusal(0.1, 0.25) == (
        "The communication point 0.35 s is no sampling instant: points must be 0 s plus a multiple of the "
        "period, 0.1 s."
    )
    assert there.refusal(0.4) == "The step begins at 0.4 s, but the last one ended at 0.1 s."
    there.set(x=float("nan"))
    assert there.refusal(0.1) == "'x' is NaN at sample 1, time 0.1 s: fill the gap or leave the sample out."
    there.set(x=0.0, y=0.0)
    assert there.refusal(0.1, 0.3).startswith("'x / y' has no value at sample 1, time 0.1 s: it is 0/0")
    there.set(x=2.0, y=1.0)
    there.step(0.1)
    assert there.get("robustness") == 1.0


@BOTH
def test_states_are_kept_serialised_and_taken_over_by_another_instance(unit, version):
    there = unit(RESPONSE, version, period=PERIOD).begin(limit=1.5)
    rows = wave(40)
    for i, row in enumerate(rows[:20]):
        there.set(**row)
        there.step(i * PERIOD)
    first = there.slave
    state = first.getFMUState()
    frozen = first.serializeFMUState(state)

    def rest() -> list[float]:
        values = []
        for i, row in enumerate(rows[20:]):
            there.set(**row)
            there.step((20 + i) * PERIOD)
            values.append(there.get("robustness"))
        return values

    expected = rest()
    first.setFMUState(state)
    assert bits(rest()) == bits(expected)
    there.slave = there.make("another")  # many instances in one process, each on its own
    there.begin()
    thawed = there.slave.deserializeFMUState(frozen)
    there.slave.setFMUState(thawed)
    assert there.get("limit") == 1.5
    assert bits(rest()) == bits(expected)
    for slave, kept in ((there.slave, thawed), (first, state)):
        slave.freeFMUState(kept)
    first.terminate()
    first.freeInstance()


@BOTH
def test_reset_forgets_the_trace_and_parameters_are_what_they_were(unit, version):
    there = unit(RESPONSE, version, period=PERIOD).begin(limit=1.0)
    there.set(**wave(1)[0])
    there.step(0.0, 3.0)
    assert there.get("known")
    there.slave.reset()
    there.begin()
    assert (there.get("known"), there.get("limit"), there.get("req")) == (False, 3.0, 0.0)


@BOTH
def test_parameters_are_fixed_once_the_simulation_runs(unit, version):
    there = unit(RESPONSE, version, period=PERIOD).begin()
    with pytest.raises(FMICallException):
        there.set(limit=1.0)
    assert there.said == [(2, "The parameter 'limit' can only be set before the end of the initialisation.")]


@BOTH
def test_in_dense_time_communication_points_are_samples(unit, version):
    text = "always[0:250ms](x >= 1)"
    monitor = rtamt.parse(text).monitor(time="dense")
    there = unit(text, version, time="dense").begin()
    times = [0.0, 0.05, 0.2, 0.7, 0.75, 1.3, 1.31, 2.0]
    last = None
    for now, then in pairwise(times):
        value = np.sin(5 * now) + 2
        there.set(x=value)
        there.step(now, then - now)
        known = monitor.update(now, x=value)
        if len(known):
            last = known.times[-1], known.values[-1]
        if last is None:
            assert not there.get("known")
        else:
            assert there.get("known_since") == last[0]
            assert bits([there.get("robustness")]) == bits([last[1]])


@BOTH
def test_a_unit_in_dense_time_rejected_steps_at_unix_times(unit, version):
    text, start = "once[0:30ms](x >= 1)", 1.7e9
    monitor = rtamt.parse(text).monitor(time="dense")
    there = unit(text, version, time="dense").begin(start=start)
    for k in range(100):  # start + k * length is not what the steps add up to
        there.set(x=k)
        there.step(start + k * 0.01, 0.01)
        known = monitor.update(start + k * 0.01, x=k)
        assert there.get("robustness") == known.values[-1]


@BOTH
def test_fmpy_simulates_a_unit_from_a_recording(exported, version):
    path = exported("once[0:200ms](x >= 1)", version, period=PERIOD)
    n = 20
    x = np.cos(np.arange(n + 1))
    recording = np.array(
        list(zip(np.arange(n + 1) * PERIOD, x, strict=True)), dtype=[("time", float), ("x", float)]
    )
    result = fmpy.simulate_fmu(
        str(path),
        stop_time=n * PERIOD,
        output_interval=PERIOD,
        input=recording,
        output=["robustness", "known_since", "x"],
        fmi_type="CoSimulation",
    )
    monitor = rtamt.parse("once[0:200ms](x >= 1)").monitor(period=PERIOD)
    # Row k of the result is what the unit told after the step that ended there.
    told = [monitor.step(value) for value in x[:n]]
    assert bits(result["robustness"][1:]) == bits(told)


def test_a_monitor_beside_a_plant(unit, tmp_path):
    headers = Path(fmpy.__file__).parent / "c-code"
    binaries = tmp_path / "plant" / "binaries" / fmi.platform(2)
    binaries.mkdir(parents=True)
    source = Path(__file__).with_name("plant.c")
    compile_it = ["gcc", "-shared", "-fPIC", "-ffp-contract=off", f"-I{headers}", source, "-o"]
    subprocess.run([*compile_it, binaries / "plant.so"], check=True)
    folder = str(tmp_path / "plant")
    plant = FMU2Slave(guid="plant", unzipDirectory=folder, modelIdentifier="plant", instanceName="plant")
    plant.instantiate()
    plant.setupExperiment()
    plant.enterInitializationMode()
    plant.exitInitializationMode()
    text = "always[0:500ms](level <= full)  "
    text = f"const float full = 2  {text}"
    monitor, there = rtamt.parse(text).monitor(period=PERIOD), unit(text, 2, period=PERIOD).begin()
    verdicts = set()
    for i in range(80):
        (level,) = plant.getReal([0])
        there.set(level=level)
        plant.doStep(i * PERIOD, PERIOD)
        there.step(i * PERIOD)
        expected = monitor.update(i * PERIOD, level=level)
        assert bits([there.get("robustness")]) == bits([0.0 if expected is None else expected])
        verdicts.add(there.get("verdict"))
    plant.terminate()
    plant.freeInstance()
    assert verdicts == {0, 1, -1}


@BOTH
def test_a_program_that_was_changed_afterwards_is_refused(unit, exported, tmp_path, version):
    path = exported("x >= 3", version)
    folder = Path(fmpy.extract(str(path), str(tmp_path / "changed")))
    program = folder / "resources" / "program.rtamt"
    code = bytearray(program.read_bytes())
    code[60] ^= 1
    program.write_bytes(code)
    there = unit("x >= 3", version).begin()
    there.folder = str(folder)
    with pytest.raises(Exception, match="instantiate"):
        there.make()
    assert there.said[-1][1] == (
        "This is not a program that can be run: its checksum does not match, so it was damaged on the way."
    )


@BOTH
def test_each_of_several_requirements_has_outputs_as_soon_as_it_is_known(exported, tmp_path, version):
    text = "require R1: eventually[0:200ms](x >= 3); require R2: x <= 6"
    unit = Unit(exported(text, version, period=PERIOD), tmp_path / "unit").begin()
    for i, value in enumerate((2.0, 5.0, 7.0)):
        unit.set(x=value)
        unit.step(i * PERIOD)
        assert (unit.get("known.R2"), unit.get("known.R1"), unit.get("known")) == (True, i == 2, i == 2)
        assert unit.get("robustness.R2") == 6 - value
    assert (unit.get("robustness"), unit.get("robustness.R1"), unit.get("verdict")) == (4, 4, 1)
    assert (unit.get("verdict.R1"), unit.get("verdict.R2")) == (1, -1)
    assert (unit.get("known_since"), unit.get("known_since.R1")) == (0, 0)
    assert unit.get("known_since.R2") == pytest.approx(0.2)
    unit.close()


@BOTH
def test_bounds_and_verdict_at_the_start_are_outputs_with_units(unit, version):
    text = "always(req >= 3 -> eventually[0:200ms](gnt >= 3))"
    start = StartMonitor(rtamt.parse(text), period=PERIOD)
    there = unit(text, version, period=PERIOD, verdict="interval").begin(start=5.0)
    outputs = {v.name: v for v in there.description.modelVariables if v.causality == "output"}
    assert list(outputs) == ["lower", "upper", "verdict", "decided_since"]
    assert outputs["decided_since"].unit == "s"
    assert [there.get("lower"), there.get("upper")] == [-np.inf, np.inf]
    for i, (req, gnt) in enumerate([(0, 0), (5, 0), (0, 0), (0, 4), (7, 0), (0, 0), (0, 2), (0, 9)]):
        start.update(i * PERIOD, req=req, gnt=gnt)
        there.set(req=req, gnt=gnt)
        there.step(5.0 + i * PERIOD)
        known = start.interval()
        assert bits([there.get("lower"), there.get("upper")]) == bits([known.lower, known.upper])
        assert there.get("verdict") == {None: 0, True: 1, False: -1}[start.satisfied]
        since = 0.0 if start.decided_at is None else 5.0 + start.decided_at
        assert there.get("decided_since") == pytest.approx(since)
    assert start.satisfied is False


@BOTH
def test_a_unit_takes_booleans_and_members_as_the_monitor_does(exported, tmp_path, version):
    text = """enum Mode { MANUAL, AUTO = 4 }  input Mode mode  input bool armed
        parameter Mode start = MANUAL  parameter bool strict = false  strict -> armed and mode == start"""
    there = Unit(exported(text, version, period=PERIOD), tmp_path / "unit")
    slave, reference = there.slave, there.reference
    set_member = slave.setInteger if version == 2 else slave.setInt64
    get_member = slave.getInteger if version == 2 else slave.getInt64

    there.begin()
    slave.reset()
    if version == 2:
        slave.setupExperiment()
    slave.enterInitializationMode()
    set_member([reference["start"]], [4])
    slave.setBoolean([reference["strict"]], [True])
    slave.exitInitializationMode()
    monitor = rtamt.parse(text).with_parameters(start="AUTO", strict=True).monitor(period=PERIOD)
    for i, (mode, armed) in enumerate([("AUTO", True), ("AUTO", False), ("MANUAL", True), (4, 1)]):
        code = {"AUTO": 4, "MANUAL": 0}.get(mode, mode)
        set_member([reference["mode"]], [code])
        slave.setBoolean([reference["armed"]], [bool(armed)])
        there.step(i * PERIOD)
        assert there.get("robustness") == monitor.update(i * PERIOD, mode=mode, armed=armed)
        assert list(get_member([reference["mode"], reference["start"]])) == [code, 4]
        assert [bool(value) for value in slave.getBoolean([reference["armed"]])] == [bool(armed)]


@BOTH
def test_a_code_that_no_member_has_is_no_value_of_a_parameter(exported, tmp_path, version):
    text = """enum Mode { MANUAL, AUTO = 4 }  input Mode mode  parameter Mode wanted = AUTO
        historically(mode == wanted)"""
    there = Unit(exported(text, version, period=PERIOD), tmp_path / "unit")
    slave, wanted = there.slave, [there.reference["wanted"]]
    set_member = slave.setInteger if version == 2 else slave.setInt64
    get_member = slave.getInteger if version == 2 else slave.getInt64
    there.begin()
    slave.reset()
    there.said.clear()
    with pytest.raises(FMICallException):
        set_member(wanted, [7])
    assert [sentence for _, sentence in there.said] == [
        "The parameter 'wanted' is 7, and declared as Mode: give 0 (MANUAL) or 4 (AUTO)."
    ]
    assert list(get_member(wanted)) == [4]
    if version == 2:
        slave.setupExperiment()
    slave.enterInitializationMode()
    set_member(wanted, [0])
    slave.exitInitializationMode()
    set_member([there.reference["mode"]], [0])
    there.step(0.0)
    assert (list(get_member(wanted)), there.get("robustness")) == ([0], np.inf)
    there.close()


@BOTH
def test_a_number_in_place_of_a_boolean_is_a_rejected_step(exported, tmp_path, version):
    there = Unit(exported("input bool p  historically(p)", version, period=PERIOD), tmp_path / "unit").begin()
    there.set(p=1.0)
    there.step(0.0)
    there.set(p=0.5)
    assert there.refusal(PERIOD) == ("'p' is 0.5 at sample 1, time 0.1 s, and declared as bool: give 1 or 0.")
    assert (there.get("robustness"), there.get("verdict")) == (np.inf, 1)
    there.close()


@BOTH
def test_windows_in_dense_time_are_exact_at_unix_times(unit, version):
    text, start = "once[0:100ms](x >= 1)", 1.7e9
    monitor = rtamt.parse(text).monitor(time="dense")
    there = unit(text, version, time="dense").begin(start=start)
    at = start
    for k in range(60):
        value = 5.0 if k % 3 == 0 else 0.0
        there.set(x=value)
        there.step(at, start + (k + 1) / 10 - at)
        known = monitor.update(at, x=value)
        assert (there.get("robustness"), there.get("known_since")) == (known.values[-1], at)
        at = start + (k + 1) / 10


@BOTH
def test_variables_are_set_together_or_not_at_all(unit, version):
    there = unit("parameter float limit = 1  historically(x >= limit)", version, period=PERIOD)
    slave = there.slave
    setter = slave.setReal if version == 2 else slave.setFloat64
    references = [there.reference[name] for name in ("x", "limit", "robustness")]
    with pytest.raises(FMICallException):
        setter(references, [5.0, 3.0, 1.0])
    assert [there.get(name) for name in ("x", "limit")] == [0.0, 1.0]
    assert there.said[-1] == (2, f"The variable with the reference {references[2]} cannot be set.")
    there.begin()


@BOTH
def test_calls_at_the_wrong_time_are_errors_that_change_nothing(unit, version):
    there = unit("historically(x >= 1)", version, time="dense")
    slave = there.slave

    def start(time: float) -> None:
        if version == 2:
            slave.setupExperiment(startTime=time, tolerance=1e-6, stopTime=20.0)
        else:
            slave.enterInitializationMode(startTime=time, tolerance=1e-6, stopTime=20.0)

    def refused(call: Any, sentence: str) -> None:
        there.said.clear()
        with pytest.raises(FMICallException):
            call()
        assert there.said == [(3, sentence)]  # error

    late = "Setting the start time is only possible before the initialisation begins."
    refused(lambda: start(float("nan")), "The start time is nan: it must be finite.")
    refused(
        slave.exitInitializationMode, "The end of the initialisation is only possible after its beginning."
    )
    there.begin(start=2.0)
    refused(lambda: start(7.0), late)
    there.set(x=3.0)
    there.step(2.0)
    assert there.get("robustness") == 2.0
    slave.terminate()
    refused(
        slave.exitInitializationMode, "The end of the initialisation is only possible after its beginning."
    )
    assert there.refusal(2.1) == (
        "There is no step before the end of the initialisation, and none after the end of the simulation."
    )
    slave.reset()
    there.begin(start=7.0).set(x=4.0)
    there.step(7.0)
    assert (there.get("robustness"), there.get("known_since")) == (3.0, 7.0)


@BOTH
@pytest.mark.parametrize("verdict", ["delayed", "interval"])
def test_a_step_over_very_many_periods_is_refused_and_the_unit_goes_on(unit, version, verdict):
    there = unit("always[0:1s](x >= 1)", version, period=PERIOD, verdict=verdict).begin()
    there.set(x=3.0)
    assert there.refusal(0.0, 1e12) == (
        "The step from 0 s to 1e+12 s takes 10000000000000 samples: make steps of at most 100000000 samples."
    )
    there.step(0.0, 1000.0)
    assert there.get("robustness" if verdict == "delayed" else "lower") == 2.0
