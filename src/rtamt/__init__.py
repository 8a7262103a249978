"""Monitor Signal Temporal Logic: compute the robustness of requirements on recorded or live signals."""

from rtamt.lazy import attributes

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


__getattr__ = attributes(__name__, _MODULES)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
