"""Monitor Signal Temporal Logic: compute the robustness of requirements on recorded or live signals."""

from rtamt.lazy import import_module
from rtamt.lazy.typing import Any

__version__ = "1.0.0.dev0"


def _modules() -> dict[str, str]:
    """Return each public name with the module that defines it, from the stub: they are listed there alone."""
    with open(f"{__file__}i", encoding="utf-8") as stub_file:
        imports = stub_file.read().split("\nfrom ")[
            1:
        ]  # of one name each; to import `ast` takes longer than the rest
    parts = [statement.partition(" import ") for statement in imports]
    return {names.lstrip("(\n ").partition(" as ")[0]: module for module, _, names in parts}


_MODULES = _modules()

__all__ = sorted(_MODULES)  # noqa: PLE0605 - type checkers read the stub


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'rtamt' has no attribute '{name}'")
    found = globals()[name] = getattr(import_module(_MODULES[name]), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
