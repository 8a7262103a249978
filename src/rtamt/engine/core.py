"""The door to the compiled core: asked for when it is needed, with a clear answer where it is not built."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Collection
    from types import ModuleType

    from rtamt.engine.program import Program


def core() -> ModuleType:
    """Return the compiled core; raise :class:`UsageError` where it is not installed."""
    try:
        from rtamt.engine import _core
    except ImportError as error:
        raise UsageError(
            f"the compiled core cannot be loaded ({error}); install the package with a C++ compiler at hand, "
            f"or use backend='python'"
        ) from None
    return _core


def core_monitor(
    program: Program, period: float, tolerance: float, strict: bool = True, ignored: Collection[str] = ()
) -> Any:
    """Return a compiled monitor of a program; raise :class:`UsageError` where memory does not suffice.

    ``period`` in seconds; ``tolerance`` a fraction of it; a monitor that is not ``strict`` counts the
    gaps that miss the period and takes the sample; samples of ``ignored`` variables are skipped.
    """
    _core = core()
    code = program.to_bytes()
    try:
        return _core.Monitor(code, list(program.inputs), period, tolerance, strict, frozenset(ignored))
    except MemoryError:
        raise UsageError(
            f"the monitor needs {_core.memory(code) / 2**30:.3g} GiB of memory, which this machine does not give; "
            f"shorten the longest bound or lengthen the period"
        ) from None
