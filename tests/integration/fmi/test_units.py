"""Units that ``rtamt.fmi`` exports, as fmpy validates, runs and couples them."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import rtamt
from rtamt import fmi
from rtamt.language.parser import parse_formula

RESPONSE = (
    "specification response  const float limit = 3\n"
    "always[0:200ms]((req >= limit) -> eventually[0:300ms](gnt / scale >= limit))"
)
PERIOD = 0.1
BOTH = pytest.mark.parametrize("version", [2, 3])


def bits(values: Any) -> list[int]:
    return np.array(values, np.float64).view(np.int64).tolist()


@pytest.fixture
def exported(tmp_path):
    """Export a requirement, return the file."""

    def export(text: str, version: int, **settings: Any) -> Path:
        path = tmp_path / f"unit{version}.fmu"
        fmi.export(rtamt.parse(text), path, version=version, **settings)
        assert validate_fmu(str(path)) == []
        return path

    return export


class Unit:
    """An instance of a unit, by the names of its variables."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.folder = fmpy.extract(str(path), str(folder))
        self.description = fmpy.read_model_description(str(path))
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self.version = int(self.description.fmiVersion[0])
        self.said: list[tuple[int, str]] = []
        self.slave = self.make()

    def make(self, name: str = "monitor") -> Any:
        kind = FMU2Slave if self.version == 2 else FMU3Slave
        identifier = self.description.coSimulation.modelIdentifier
        slave = kind(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=identifier,
            instanceName=name,
        )
        if self.version == 2:
            self.callbacks = fmpy.fmi2.fmi2CallbackFunctions()
            self.callbacks.logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(
                lambda _env, _name, status, _category, said: self.said.append((status, said.decode()))
            )
            slave.instantiate(callbacks=self.callbacks)
        else:
            self.callbacks = fmpy.fmi3.fmi3LogMessageCallback(
                lambda _env, status, _category, said: self.said.append((status, said.decode()))
            )
            slave.instantiate(logMessage=self.callbacks)
        return slave

    def begin(self, start: float = 0.0, **parameters: float) -> Unit:
        if self.version == 2:
            self.slave.setupExperiment(startTime=start, tolerance=1e-6, stopTime=start + 10)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=start, tolerance=1e-6, stopTime=start + 10)
        self.set(**parameters)
        self.slave.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        references = [self.reference[name] for name in values]
        setter = self.slave.setReal if self.version == 2 else self.slave.setFloat64
        setter(references, list(values.values()))

    def get(self, name: str) -> Any:
        reference = [self.reference[name]]
        if name.startswith("verdict"):
            return (self.slave.getInteger if self.version == 2 else self.slave.getInt32)(reference)[0]
        if name.partition(".")[0] == "known":
            return bool(self.slave.getBoolean(reference)[0])
        return (self.slave.getReal if self.version == 2 else self.slave.getFloat64)(reference)[0]

    def step(self, time: float, length: float = PERIOD) -> None:
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=length)

    def refusal(self, time: float, length: float = PERIOD) -> str:
        self.said.clear()
        with pytest.raises(FMICallException):
            self.step(time, length)
        ((status, sentence),) = self.said
        assert status == 2  # discard: the unit is as it was
        return sentence

    def close(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()


@pytest.fixture
def unit(exported, tmp_path):
    """Make an instance of a unit, which is closed at the end."""
    units = []

    def make(text: str, version: int, **settings: Any) -> Unit:
        units.append(Unit(exported(text, version, **settings), tmp_path / f"unit{version}"))
        return units[-1]

    yield make
    for each in units:
        each.close()


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
def test_names_are_those_of_the_requirement(exported, version):
    path = exported('req.value >= 1 and "a b" >= 0', version)
    description = fmpy.read_model_description(str(path))
    assert [v.name for v in description.modelVariables if v.causality == "input"] == ["req.value", "a b"]
    assert description.variableNamingConvention == "flat"
    plain = fmpy.read_model_description(str(exported("req.value >= 1", version)))
    assert plain.variableNamingConvention == "structured"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "known >= 3",
            "the output 'known' has the name that an input of the unit has already: rename it in the specification",
        ),
        (
            "time >= 3",
            "the input 'time' has the name that the time of the unit has already: rename it in the specification",
        ),
        ("always(x >= 3)", None),
    ],
)
def test_what_cannot_be_a_unit_is_refused_and_nothing_is_written(tmp_path, text, sentence):
    path = tmp_path / "unit.fmu"
    with pytest.raises(rtamt.StlError) as refused:
        fmi.export(rtamt.parse(text), path)
    assert sentence is None or str(refused.value) == sentence
    assert not path.exists()


def test_a_version_that_does_not_exist_and_a_folder_that_does_not(tmp_path):
    spec = rtamt.parse("x >= 3")
    with pytest.raises(rtamt.UsageError) as refused:
        fmi.export(spec, tmp_path / "unit.fmu", version=1)
    assert str(refused.value) == "there is no FMI version 1 to write, only 2 and 3"
    path = tmp_path / "nowhere" / "unit.fmu"
    with pytest.raises(rtamt.UsageError) as refused:
        fmi.export(spec, path)
    assert str(refused.value) == f"cannot write the unit '{path}': No such file or directory"


@BOTH
def test_a_program_that_was_changed_afterwards_is_refused(unit, exported, tmp_path, version):
    path = exported("x >= 3", version)
    folder = Path(fmpy.extract(str(path), str(tmp_path / "changed")))
    program = folder / "resources" / "program.rtamt"
    code = bytearray(program.read_bytes())
    code[60] ^= 1
    program.write_bytes(code)
    there = unit("x >= 3", version)
    there.folder = str(folder)
    with pytest.raises(Exception, match="instantiate"):
        there.make()
    assert there.said[-1][1] == (
        "This is not a program that can be run: its checksum does not match, so it was damaged on the way."
    )


def test_equal_requirements_make_equal_archives_with_the_library_and_the_program(exported, tmp_path):
    path = exported("x >= 3", 2)
    again = tmp_path / "again.fmu"
    shutil.copy(path, again)
    fmi.export(rtamt.parse("x >= 3"), path)
    assert path.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == [
            "modelDescription.xml",
            f"binaries/{fmi.platform(2)}/unit2.so",
            "resources/program.rtamt",
        ]
    assert parse_formula("x >= 3") == rtamt.parse("x >= 3").formula


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
def test_declared_units_are_in_the_model_description(exported, version):
    text = """input float v [m/s]  float "q[2]" [rad]  float free  const float limit = 3 [m/s]
    always[0:1s](v >= limit and "q[2]" <= free)"""
    described = fmpy.read_model_description(str(exported(text, version, period="1s")))
    units = {variable.name: variable.unit for variable in described.modelVariables if variable.unit}
    assert units == {"v": "m/s", "q[2]": "rad", "limit": "m/s", "known_since": "s"}
    assert [unit.name for unit in described.unitDefinitions] == ["m/s", "rad", "s"]
