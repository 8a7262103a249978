"""Load the compiled core on first use, with a clear error if it is not built."""

from __future__ import annotations

import sys

from rtamt.errors import EvaluationError, UsageError
from rtamt.language.formula import Apply
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias
from rtamt.rewrite.desugar import written
from rtamt.signals import sampling_period

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping
    from fractions import Fraction
    from types import ModuleType

    from rtamt.compiler.program import Program
    from rtamt.engine import _core
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray

    #: A call of a custom operator: its kernel, begin and end (-1 for none), the step in seconds, and its operands.
    KernelCall: TypeAlias = tuple[Any, int, int, float, tuple[int, ...]]


def core() -> ModuleType:
    """Return the compiled core; raise :class:`UsageError` if it is not installed."""
    loaded = sys.modules.get("rtamt.engine._core")
    if loaded is not None:
        return loaded
    try:
        from rtamt.engine import _core
    except ImportError as error:
        raise UsageError(
            f"the compiled core cannot be loaded ({error}); install the package with a C++ compiler at hand, "
            f"or use backend='python'"
        ) from None
    return _core


def built_core() -> ModuleType | None:
    """Return the compiled core if it is loaded already; None where it is not built, or is not used."""
    return sys.modules.get("rtamt.engine._core")


class _TakenByPython:
    """The base of monitors if the core is not built; see ``MonitorBase`` in ``_core``."""

    _backend: Any
    _update_carefully: Callable[..., Any]
    _step_carefully: Callable[..., Any]

    def update(self, /, *time: Any, **values: float) -> Any:
        """Take one sample."""
        return self._update_carefully(*time, **values)

    def step(self, *values: float) -> Any:
        """Take one sample by position."""
        return self._step_carefully(*values)


def _read_by_python(*_given: Any) -> None:
    """Replace :func:`rtamt.engine._core.read_columns` if the core is not built."""


def has_period(times: FloatArray, period: Fraction) -> bool:
    """Return :func:`sampling_period.has_period` of timestamps in order, computed in the core if it is built."""
    built = built_core()
    if built is None:
        return sampling_period.has_period(times, period)
    gap = float(period)
    found: bool = built.has_period(times, gap, sampling_period.coarse_place(gap))
    return found


def _new_rows_by_python(rows: int, width: int) -> FloatArray:
    """Stand in for :func:`rtamt.engine._core.new_rows` where the core is not built."""
    return np.empty((rows, width))


def _class_itself(base: type) -> type:
    """Stand in for :func:`rtamt.engine._core.update_signal_class`: the Python back ends make no such signals."""
    return base


if TYPE_CHECKING:
    MonitorBase = _core.MonitorBase
    DenseMonitorBase = _core.DenseMonitorBase
    EarlyMonitorBase = _core.EarlyMonitorBase
    new_rows = _core.new_rows
    read_columns = _core.read_columns
    update_signal_class = _core.update_signal_class
else:
    try:
        from rtamt.engine._core import (
            DenseMonitorBase,
            EarlyMonitorBase,
            MonitorBase,
            new_rows,
            read_columns,
            update_signal_class,
        )
    except ImportError:
        MonitorBase = DenseMonitorBase = EarlyMonitorBase = _TakenByPython
        update_signal_class = _class_itself
        new_rows = _new_rows_by_python
        read_columns = _read_by_python


def calls_of(program: Program) -> list[KernelCall]:
    """Return the calls of a program for the core: the kernel, interval, step and operands of each."""
    if not program.calls:
        return []
    from rtamt.engine.user_operators import kernel_calls  # few programs have calls

    return kernel_calls(program)


def core_monitor(
    program: Program,
    period: float,
    tolerance: float,
    strict: bool,
    ignored: Collection[str],
    types: Mapping[str, Mapping[str, float] | None],
) -> Any:
    """Return a compiled monitor of a program; raise :class:`UsageError` if memory does not suffice.

    ``period`` in seconds; ``tolerance`` a fraction of it. A monitor that is not ``strict`` counts irregular
    gaps and takes the sample; samples of ``ignored`` variables are skipped. ``types``: see ``coding.codes_of``.
    """
    _core = core()
    code, calls = program.code(), calls_of(program)
    try:
        return _core.Monitor(
            code, list(program.inputs), period, tolerance, strict, frozenset(ignored), calls, types
        )
    except RuntimeError as error:
        raise creation_error(program, error) from None
    except MemoryError:
        timestamps = 8 * (max(program.lags) + 1)  # of the samples whose values are pending
        gibibytes = (_core.memory(code, calls) + timestamps) / 2**30
        raise UsageError(
            f"the monitor needs {gibibytes:.3g} GiB of memory, which this machine does not give; "
            f"shorten the longest bound or lengthen the period"
        ) from None


def creation_error(program: Program, error: RuntimeError) -> UsageError:
    """Return the error for a compiled kernel that could not be created."""
    names = dict.fromkeys(site.op.name for site in program.calls)
    return UsageError(f"the kernel of '{' or '.join(names)}' cannot be made: {error}")


def culprit(
    error: Exception,
    program: Program,
    asked: Iterable[Formula],
    original: Callable[[Formula], Formula] = lambda formula: formula,
) -> Formula:
    """Return the sub-formula that yielded NaN, as it is written in the formulas that are ``asked``.

    ``error``: the core's ``Undefined``. ``original``: from a formula of the program to its source.
    Raises the error of a custom operator.
    """
    from rtamt.language.printing.printer import excerpt

    formula = program.origin_of(error.args[0])
    assert formula is not None
    if error.__cause__ is not None:
        raise error.__cause__
    formula = written(original(formula), asked)
    if len(error.args) == 3 and isinstance(formula, Apply):
        raise EvaluationError(
            f"the kernel of '{formula.op.name}' failed in '{excerpt(formula)}': {error.args[2]}; mend the kernel"
        )
    return formula
