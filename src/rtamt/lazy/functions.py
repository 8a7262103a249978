"""Functions of modules that are imported when one of them is first called.

The operator table refers to hundreds of functions, of which a monitor that the core computes calls none.

>>> fractions = Functions("fractions")
>>> fractions.Fraction
<function fractions.Fraction>
>>> fractions.Fraction("0.5")
Fraction(1, 2)
"""

from __future__ import annotations

from rtamt.lazy import import_module
from rtamt.lazy.typing import Any

__all__ = ["Function", "Functions"]


class Functions:
    """Stands for a module: its attributes are the functions of that module, each of them the same object every time."""

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Function:
        if name.startswith("__"):
            raise AttributeError(name)
        made = self.__dict__[name] = Function(self._module, name)
        return made


class Function:
    """A function by its module and name; :mod:`inspect` and pickle read those of the function itself."""

    __slots__ = ("_found", "_module", "_name")

    def __init__(self, module: str, name: str) -> None:
        self._module = module
        self._name = name
        self._found: Any = None

    @property
    def __wrapped__(self) -> Any:
        """The function."""
        if self._found is None:
            self._found = getattr(import_module(self._module), self._name)
        return self._found

    def __call__(self, *args: Any, **given: Any) -> Any:
        """Call the function."""
        return (self._found or self.__wrapped__)(*args, **given)

    def __repr__(self) -> str:
        return f"<function {self._module}.{self._name}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Function, (self._module, self._name))
