"""An FMU (FMI 2.0 or 3.0, co-simulation) as a plant, simulated step by step so that it can be stopped."""

from __future__ import annotations

import ctypes
import shutil
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, did_you_mean
from rtamt.extras import library
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator


@dataclass(frozen=True)
class FmuPlant:
    """Simulates an FMU: called with its inputs and parameters by name, it yields a sample at every step.

    ``duration`` and ``step`` are in seconds; the default step is that of the FMU's default experiment. Numbers
    are set once, before the simulation; functions of time are set at every step. A sample holds the FMU's real
    outputs at that time, and the inputs given as functions (a requirement may read both); the first is at 0.
    """

    path: str | os.PathLike[str]
    duration: float | None
    step: float | None = None

    def __call__(self, /, **inputs: Any) -> Iterator[tuple[float, dict[str, float]]]:
        """Simulate; yields ``(time, {output: value})``."""
        fmpy = library("fmpy", "an FMU", "fmi")
        if not Path(self.path).is_file():
            raise UsageError(f"there is no unit '{self.path}'")
        try:
            description = fmpy.read_model_description(str(self.path))
        except Exception as error:  # fmpy passes on errors of zip and XML readers
            raise UsageError(f"'{self.path}' cannot be read as an FMU: {error}") from error
        if description.coSimulation is None:
            raise UsageError(f"'{self.path}' is no unit for co-simulation")
        variables = {variable.name: variable for variable in description.modelVariables}
        for name in inputs:
            if name not in variables:
                raise UsageError(f"'{self.path}' has no variable '{name}'{did_you_mean(name, variables)}")
        step = self._step(description)
        duration = self.duration or float(getattr(description.defaultExperiment, "stopTime", 0) or 0)
        if duration <= 0:
            raise UsageError(f"'{self.path}' does not say how long to simulate; give the duration")
        folder = mkdtemp()
        try:
            fmpy.extract(str(self.path), folder)
            said: list[str] = []
            unit = self._instance(description, folder, said)
            try:
                yield from _simulate(unit, description, variables, inputs, step, round(duration / step))
            except library("fmpy.fmi1", "an FMU", "fmi").FMICallException as error:
                raise UsageError(f"the unit '{self.path}' says: {' '.join(said) or error}") from error
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _step(self, description: Any) -> float:
        step = self.step or getattr(description.defaultExperiment, "stepSize", None)
        if step is None:
            raise UsageError(f"'{self.path}' has no default step size; give the step in seconds")
        return float(step)

    def _instance(self, description: Any, folder: str, said: list[str]) -> Any:
        third = description.fmiVersion.startswith("3")
        module = library("fmpy.fmi3" if third else "fmpy.fmi2", "an FMU", "fmi")
        unit = (module.FMU3Slave if third else module.FMU2Slave)(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="plant",
        )
        # Without this logger, fmpy would print messages of the FMU among the results.
        if third:
            unit.instantiate(logMessage=lambda _env, status, _kind, text: _note(said, status, text))
        else:
            unit.instantiate(callbacks=_callbacks(module, said))
        return unit


def _callbacks(module: Any, said: list[str]) -> Any:
    """Return the callbacks of FMI 2.0: a logger, which receives formatted messages from fmpy's proxy, and memory."""
    callbacks = module.fmi2CallbackFunctions()
    callbacks.logger = module.fmi2CallbackLoggerTYPE(
        lambda _env, _name, status, _kind, text: _note(said, status, text)
    )
    callbacks.allocateMemory = module.defaultCallbacks.allocateMemory
    callbacks.freeMemory = module.defaultCallbacks.freeMemory
    library("fmpy.logging", "an FMU", "fmi").addLoggerProxy(ctypes.byref(callbacks))
    return callbacks


def _note(said: list[str], status: int, text: bytes) -> None:
    """Keep the FMU's messages above the warning level (status 2 or higher)."""
    if status > 1:
        said.append(text.decode("utf-8", "replace"))


def _simulate(
    unit: Any, description: Any, variables: dict[str, Any], inputs: dict[str, Any], step: float, steps: int
) -> Iterator[tuple[float, dict[str, float]]]:
    third = description.fmiVersion.startswith("3")
    outputs = [
        v for v in description.modelVariables if v.causality == "output" and v.type in ("Real", "Float64")
    ]
    references = [variable.valueReference for variable in outputs]
    write = unit.setFloat64 if third else unit.setReal
    read = unit.getFloat64 if third else unit.getReal
    moving = {name: given for name, given in inputs.items() if callable(given)}
    places = [variables[name].valueReference for name in moving]
    fixed = {
        variables[name].valueReference: float(given) for name, given in inputs.items() if not callable(given)
    }
    try:
        if fixed:
            write(list(fixed), list(fixed.values()))
        if not third:
            unit.setupExperiment(startTime=0.0)
        unit.enterInitializationMode()
        now = {name: float(signal(0.0)) for name, signal in moving.items()}
        if moving:
            write(places, list(now.values()))
        unit.exitInitializationMode()
        for k in range(steps + 1):
            if k:
                unit.doStep(currentCommunicationPoint=(k - 1) * step, communicationStepSize=step)
                now = {name: float(signal(k * step)) for name, signal in moving.items()}
            values = map(float, read(references))
            yield k * step, {**now, **dict(zip((v.name for v in outputs), values, strict=True))}
            if moving:
                write(places, list(now.values()))
        unit.terminate()
    finally:  # allowed at any time, also after a stopped or failed simulation
        unit.freeInstance()
