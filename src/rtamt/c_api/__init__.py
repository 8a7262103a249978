"""Locate the shared library and the header of the C API, which run compiled programs without Python."""

from __future__ import annotations

from pathlib import Path

from rtamt.errors import UsageError

_LIBRARIES = ("rtamt_runtime.so", "rtamt_runtime.dll")


def library() -> Path:
    """Return the shared library; it needs nothing but the C library of the system.

    Raises :class:`UsageError` if the package was installed without it.
    """
    return _find_installed(_LIBRARIES)


def header() -> Path:
    """Return the C header of the library."""
    return _find_installed(("rtamt.h",))


def _find_installed(names: tuple[str, ...]) -> Path:
    for folder in __path__:  # an editable install has two: the source, and what was built
        for name in names:
            path = Path(folder, name)
            if path.is_file():
                return path
    raise UsageError(
        f"the runtime ({names[0]}) was not built; install the package with a C++ compiler at hand"
    )
