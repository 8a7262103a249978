"""Variables that are objects: their classes, the variable of a field, and the fields that hold numbers."""

from __future__ import annotations

import builtins
from numbers import Real
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, did_you_mean, with_article
from rtamt.language.parsing.declarations import TYPES
from rtamt.signals.arrays import field

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType

#: The types of variables that need no import, and their classes; ``long`` is from Python 2.
SCALARS: dict[str, type] = {name: getattr(builtins, name, int) for name in TYPES}


def head_of(name: str) -> str:
    """Return the variable to which a name belongs: for a field, the part before the first dot."""
    return name.partition(".")[0]


def numbers_in(held: Any) -> list[str]:
    """Return the names of an object's public fields that hold numbers."""
    return [name for name in dir(held) if name[0] != "_" and isinstance(getattr(held, name, None), Real)]


def lacks(name: str, held: Any, kind: str) -> str:
    """Return why an object of a ``kind`` has no number called ``name``, or an empty string."""
    head, *path = name.split(".")
    try:
        if any(step.startswith("__") for step in path):  # Python's own, such as __class__
            raise AttributeError
        value = field(held, path)
    except AttributeError:
        missing = ".".join(path)
        hint = did_you_mean(missing, numbers_in(held))
        return f"'{head}' is {with_article(kind)} and has no field '{missing}'{hint}"
    if path or isinstance(value, Real):
        return ""
    such = [f", such as {head}.{number}" for number in numbers_in(held)[:1]]
    return f"'{head}' is {with_article(kind)} and no number; name one of its fields{''.join(such)}"


def new_object(name: str, type_name: str, modules: Mapping[str, ModuleType]) -> Any:
    """Return the first value of a variable: zero, or an object of a class from one of the modules that define it."""
    if type_name in SCALARS:
        return SCALARS[type_name]()
    if type_name not in modules:
        raise UsageError(
            f"the type '{type_name}' of '{name}' is neither built in ({', '.join(SCALARS)}) nor imported"
            f"{did_you_mean(type_name, [*SCALARS, *modules])}; import it with import_module(module, "
            f"'{type_name}') first"
        )
    cls = getattr(modules[type_name], type_name)
    try:
        return cls()
    except TypeError as error:
        raise UsageError(
            f"'{name}' cannot start as {with_article(type_name)} without arguments: {error}"
        ) from error
