"""The elevators beside their monitor as an FMU, step by step: ``python examples/elevator/beside_fmu.py``.

The monitor is what Simulink, Dymola or OpenModelica would import; here fmpy runs it. Every value is
compared with that of the monitor in Python: they are equal to the last bit.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import TYPE_CHECKING, Any

import fmpy
from fmpy.fmi2 import FMU2Slave

import rtamt
from elevator import STEP, Elevators
from rtamt import fmi
from rtamt.search import Pulse

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
COMMAND = Pulse(amplitude=1.7, frequency=0.95, delay=0.5)


def specification() -> rtamt.Specification:
    """Return what is monitored."""
    return rtamt.load(HERE / "monitor.stl", period="20ms", semantics="output_robustness")


def beside(plant: Iterator[tuple[float, dict[str, float]]], unit: Path) -> Iterator[tuple[float, float]]:
    """Step the plant and the unit together; yields (time, robustness) as the unit reports them."""
    folder = fmpy.extract(str(unit), mkdtemp())
    description = fmpy.read_model_description(str(unit))
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = _started(description, folder)
    try:
        for time, values in plant:
            slave.setReal([reference[name] for name in values], list(values.values()))
            slave.doStep(currentCommunicationPoint=time, communicationStepSize=STEP)
            if slave.getBoolean([reference["known"]])[0]:
                since, robustness = slave.getReal([reference["known_since"], reference["robustness"]])
                yield since, robustness
    finally:
        slave.terminate()
        slave.freeInstance()
        shutil.rmtree(folder)


def _started(description: Any, folder: str) -> FMU2Slave:
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="monitor",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def main() -> None:
    """Simulate a failure of the first hydraulic circuit, and print when the monitors report the violation."""
    plant = Elevators(duration=10, faults={"H1": 2.0})
    spec = specification()
    with TemporaryDirectory() as folder:
        unit = Path(folder, "monitor.fmu")
        fmi.export(spec, unit)
        reported = list(beside(plant(COMMAND), unit))
    monitor = spec.monitor()
    answers = [monitor.update(time, **values) for time, values in plant(COMMAND)]
    if [robustness for _, robustness in reported] != [answer for answer in answers if answer is not None]:
        sys.exit("the unit and the monitor in Python differ")
    print(f"{len(reported)} values, each equal to that of the monitor in Python")
    since = next((time for time, robustness in reported if robustness < 0), None)
    print("no violation" if since is None else f"violated by the step at {since:.2f} s")


if __name__ == "__main__":
    main()
