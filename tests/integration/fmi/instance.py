"""An instance of an exported unit, by the names of its variables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

if TYPE_CHECKING:
    from pathlib import Path

PERIOD = 0.1


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
