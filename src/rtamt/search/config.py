"""Problem files (TOML): the requirement, the plant, its inputs, and the search settings.

::

    specification = "speed.stl"            # next to this file; or formula = "always[0:30](speed <= 120)"
    plant = "plants:transmission"          # module:function, also next to this file; or "plant.fmu"
    duration = 30                          # seconds
    period = "10ms"                        # time = "dense" and semantics = "..." likewise, as for parse

    [inputs]
    brake = { low = 0, high = 325 }                                    # a Range
    throttle = { kind = "piecewise_constant", points = 7, low = 0, high = 100 }
    pitch = { kind = "pulse", amplitude = { low = 1, high = 1.75 }, frequency = 0.2 }

    [parameters]                           # of the specification
    limit = 100

    [search]
    optimizer = "cma"
    budget = 300
    seed = 1
    workers = 2
    record = "run.jsonl"
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError, choices, did_you_mean, shown
from rtamt.extras import library
from rtamt.files import open_text
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern
from rtamt.search.inputs import PiecewiseConstant, PiecewiseLinear, Pulse, Range, Sine, Step
from rtamt.search.problem import Problem
from rtamt.specification_loader import load, parse

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Collection, Mapping
    from types import ModuleType

#: The values of ``kind``.
KINDS: Mapping[str, Any] = MappingProxyType({
    "range": Range,
    "piecewise_constant": PiecewiseConstant,
    "piecewise_linear": PiecewiseLinear,
    "step": Step,
    "pulse": Pulse,
    "sine": Sine,
})  # fmt: skip

_TOP = ("specification", "formula", "plant", "duration", "inputs", "parameters", "search", "outputs", "step")
_SPECIFICATION = ("period", "unit", "time", "resolution", "semantics", "backend", "constants")
#: A key of more parts than any setting has: parsers of TOML take quadratic time for it.
_DEEP_KEY = lazy_pattern(r"""(?:\.[ \t]*(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*){64}""")
_SEARCH = ("optimizer", "budget", "seed", "workers", "record", "stop")


@dataclass(frozen=True, slots=True)
class Search:
    """The content of a problem file: the problem, and the settings of ``falsify``."""

    problem: Problem
    settings: Mapping[str, Any]


def load_search(path: str | os.PathLike[str]) -> Search:
    """Read a problem file; raise :class:`UsageError` with the file and the key."""
    place = Path(path)
    try:
        with open_text(place, "utf-8") as file:
            text = file.read()
        if _DEEP_KEY.search(text):
            raise UsageError(f"{path}: it has a key of more than 64 parts")
        data = _toml().loads(text)
    except OSError as error:
        raise UsageError(f"cannot read '{path}': {error.strerror}") from error
    except RecursionError:
        raise UsageError(f"{path}: it is nested too deeply") from None
    except ValueError as error:
        raise UsageError(f"{path}: {error}") from error
    try:
        return _search(data, place.parent)
    except (StlError, TypeError) as error:
        raise UsageError(f"{path}: {error}") from error


def _search(data: dict[str, Any], folder: Path) -> Search:
    _known(data, (*_TOP, *_SPECIFICATION), "")
    settings = {key: data[key] for key in _SPECIFICATION if key in data}
    if ("specification" in data) == ("formula" in data):
        raise UsageError("give either 'specification', a file, or 'formula', its text")
    text = data.get("formula")
    spec = load(folder / data["specification"], **settings) if text is None else parse(text, **settings)
    spec = spec.with_parameters(**data.get("parameters", {}))
    inputs = {name: _input(name, given) for name, given in data.get("inputs", {}).items()}
    chosen = dict(data.get("search", {}))
    _known(chosen, _SEARCH, "search.")
    if "record" in chosen:
        chosen["record"] = folder / chosen["record"]
    plant = _plant(data, folder)
    return Search(Problem(spec, plant, inputs, data.get("duration")), MappingProxyType(chosen))


def _input(name: str, given: Any) -> Any:
    if not isinstance(given, dict):
        return given
    kind = given.get("kind", "range")
    maker = KINDS.get(kind)
    if maker is None:
        hint = did_you_mean(str(kind), KINDS)
        raise UsageError(f"the input '{name}' is of kind {shown(kind)}, not one of {', '.join(KINDS)}{hint}")
    numbers = {
        key: Range(**value) if isinstance(value, dict) else value
        for key, value in given.items()
        if key != "kind"
    }
    try:
        return maker(**numbers)
    except TypeError as error:
        raise UsageError(f"the input '{name}': {str(error).partition('() ')[2]}") from error


def _plant(data: dict[str, Any], folder: Path) -> Callable[..., Any]:
    plant = data.get("plant")
    if not isinstance(plant, str):
        raise UsageError("give the plant: 'module:function', or an FMU file")
    if plant.endswith(".fmu"):
        from rtamt.search.fmu import FmuPlant

        return FmuPlant(folder / plant, data.get("duration"), step=data.get("step"))
    module, colon, name = plant.partition(":")
    if not (module and colon and name):
        raise UsageError(f"the plant is '{plant}'; write it as 'module:function', or name an FMU file")
    try:
        made = _module(module, folder.resolve())
    except ImportError as error:
        raise UsageError(f"the plant's module '{module}' cannot be imported: {error}") from error
    found = getattr(made, name, None)
    if not callable(found):
        raise UsageError(f"the module '{module}' has no function '{name}'{did_you_mean(name, dir(made))}")
    function: Callable[..., Any] = found
    return function


def _module(name: str, folder: Path) -> ModuleType:
    """Import a module, preferably from the folder, even if another one of that name was imported before."""
    beside = folder / f"{name}.py"
    before = sys.modules.get(name)
    if beside.exists() and before is not None and getattr(before, "__file__", None) != str(beside):
        del sys.modules[name]
    sys.path.insert(0, str(folder))
    try:
        return import_module(name)
    finally:
        sys.path.remove(str(folder))


def _known(data: dict[str, Any], keys: Collection[str], where: str) -> None:
    for key in data:
        if key not in keys:
            raise UsageError(f"'{where}{key}' is not a setting{choices(key, keys, 'settings')}")


def _toml() -> Any:
    name = "tomllib" if sys.version_info >= (3, 11) else "tomli"
    return library(name, "a problem file", "falsify")
