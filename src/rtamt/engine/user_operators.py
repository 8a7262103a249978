"""Drivers that call custom operators from the core.

A driver belongs to one call of a program. It creates an object of the user's class for each trace, passes
it the operands, and checks the results, so that the core can trust a driver. A checkpoint is a deep copy of
the object, so that a failed update leaves it unchanged, too; a class may define a cheaper
``__deepcopy__``.
"""

from __future__ import annotations

import copy
from functools import partial

from rtamt.errors import EvaluationError, StlError, UsageError
from rtamt.language.definitions.dense import QUARTERS, Steps
from rtamt.language.operators import Blocks, Bounds, Compiled
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar
from rtamt.reference.definition_adapter import (
    DefinedEvents,
    DefinedSamples,
    arguments_of,
    check_dense_meaning,
    numbers_of,
    raised,
    signal_of,
    values_of,
)
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.compiler.program import CallSite, Program
    from rtamt.engine.native import KernelCall
    from rtamt.language.formula import Apply
    from rtamt.language.operators import Operator
    from rtamt.signals.time_domain_interface import TimeDomain

    Array = NDArray[np.float64]
    Events = tuple[NDArray[np.int64], Array]


def kernel_calls(program: Program) -> list[KernelCall]:
    """Return the calls of a program for the core."""
    driver = EventDriver if program.domain.continuous else SampleDriver
    return [
        (
            _kernel(site, driver, program.period),
            site.begin,
            -1 if site.end is None else site.end,
            float(program.period),
            site.operands,
        )
        for site in program.calls
    ]


def _kernel(site: CallSite, driver: type[_Driver], step: Fraction) -> Any:
    """Return the capsule of a compiled kernel, or a factory of drivers."""
    kernel, name = site.op.kernel, driver.domain.name
    if isinstance(kernel, Compiled):
        symbol = getattr(kernel, name)
        if symbol is not None:
            return _capsule(site.op, kernel.library, symbol)
    blocks = getattr(kernel, name) if isinstance(kernel, Blocks) else None
    if blocks is not None:
        make = blocks if site.op.bounds is Bounds.NONE else partial(blocks, site.begin, site.end)
    else:
        driver.check_defined(site.op)
        make = partial(driver.defined, site.node, site.begin, site.end, site.ahead, step)
    return partial(driver, site.node, len(site.operands), make, site.ahead)


def _capsule(op: Operator, library: str, name: str) -> Any:
    """Load a shared library and return the address of one of its kernels."""
    import ctypes  # few programs have a compiled kernel

    try:
        function = getattr(ctypes.CDLL(str(library)), name)
    except OSError as error:
        raise UsageError(f"the kernel of '{op.name}' cannot be loaded: {error}") from error
    except AttributeError as error:
        raise UsageError(
            f"the kernel of '{op.name}' cannot be loaded: '{library}' has no kernel '{name}'; "
            f"name it there with RTAMT_KERNEL({name}, ...)"
        ) from error
    function.restype = ctypes.c_void_p
    new = ctypes.pythonapi.PyCapsule_New
    new.restype = ctypes.py_object
    new.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    return new(function(), b"rtamt.kernel", None)


class _Driver:
    """The base of both drivers: the user's object, its checkpoint, and its errors."""

    #: The time domain of its operands.
    domain: ClassVar[type[TimeDomain]]
    #: The class that evaluates an operator without a kernel by its definition.
    defined: ClassVar[Callable[..., Any]]

    @staticmethod
    def check_defined(op: Operator) -> None:
        """Raise :class:`UsageError` for an operator that has no definition in the time domain."""

    def __init__(self, node: Apply, operands: int, make: Callable[[], Any], ahead: int) -> None:
        self.operands = operands
        self._node = node
        self._make = make
        self._ahead = ahead
        self._begin()

    def _begin(self) -> None:
        self._fault: Exception | None = None
        self._saved: tuple[Any, ...] | None = None
        self._object = self._call(self._make)

    def reset(self) -> None:
        """Start a new trace. Errors here and in a checkpoint are raised by the next call."""
        try:
            self._begin()
        except StlError as error:
            self._fault = error

    def checkpoint(self) -> None:
        """Save the state."""
        try:
            self._saved = (self._call(copy.deepcopy, self._object), self._progress())
        except StlError as error:
            self._fault = error

    def rollback(self) -> None:
        """Go back to the checkpoint."""
        self._fault = None
        if self._saved is not None:
            self._object, progress = self._saved
            self._saved = None
            self._return_to(progress)

    def _progress(self) -> Any:
        raise NotImplementedError

    def _return_to(self, progress: Any) -> None:
        raise NotImplementedError

    def _call(self, function: Callable[..., Any], *args: Any, **more: Any) -> Any:
        """Call the user's code; name the operator in its errors."""
        try:
            with np.errstate(all="ignore"):  # the core detects and reports NaN
                return function(*args, **more)
        except StlError:
            raise
        except Exception as error:
            raise raised(self._node, error) from error

    def _wrong(self, sentence: str) -> EvaluationError:
        return EvaluationError(f"the kernel of '{self._node.op.name}' {sentence}")


class SampleDriver(_Driver):
    """A call in discrete time."""

    domain = Discrete
    defined = DefinedSamples

    def _begin(self) -> None:
        super()._begin()
        self._return_to((0, 0, np.empty(0), False))

    def _progress(self) -> Any:
        return self._taken, self._given, self._waiting, self._ended

    def _return_to(self, progress: Any) -> None:
        self._taken, self._given, self._waiting, self._ended = progress

    def run(self, operands: Sequence[Array], last: bool, due: int) -> Array:
        """Take a block of each operand; return the next ``due`` values. ``last``: the trace ends."""
        if self._fault is not None:
            raise self._fault
        if len(operands[0]):
            self._taken += len(operands[0])
            self._add(self._call(self._object.push, *operands), max(0, self._taken - self._ahead))
        if last and not self._ended:
            self._ended = True
            if self._given < self._taken:
                self._add(self._call(self._object.finish), self._taken)
        values, self._waiting = self._waiting[:due], self._waiting[due:]
        return np.ascontiguousarray(values)

    def _add(self, values: Any, known: int) -> None:
        """Store the values that the object returned; ``known`` values must be available by now."""
        block = self._call(numbers_of, self._node, values)
        if block.shape != (known - self._given,):
            raise self._wrong(
                f"returned an array of shape {block.shape}, expected ({known - self._given},): after {self._taken} "
                f"samples of its operands {known} values are known, and it has given {self._given}"
            )
        self._given = known
        self._waiting = np.concatenate((self._waiting, block))


class EventDriver(_Driver):
    """A call in dense time; the core checks its results."""

    domain = Dense
    defined = DefinedEvents
    check_defined = staticmethod(check_dense_meaning)

    def _progress(self) -> Any:
        return None

    def _return_to(self, progress: Any) -> None:
        pass

    def advance(self, operands: Sequence[Events], _start: int, until: int, _due: int) -> Events:
        """Take the events of each operand up to ``until``; return those that are known by then."""
        if self._fault is not None:
            raise self._fault
        given = self._call(self._object.push, *operands, until=until)
        events: Events = self._call(self._events, given)
        return events

    def _events(self, given: Any) -> Events:
        times, values = given
        ticks, numbers = np.ascontiguousarray(times), np.ascontiguousarray(numbers_of(self._node, values))
        if ticks.shape != numbers.shape or ticks.ndim != 1 or (len(ticks) and ticks.dtype.kind != "i"):
            raise self._wrong(
                f"returned times of shape {ticks.shape} ({ticks.dtype}) and values of shape {numbers.shape}, "
                f"expected as many ticks (int64) as values"
            )
        return ticks.astype(np.int64), numbers


# ---- unbounded future: the definition, once, over a whole trace ----------------------------------


def defined_column(node: Apply, period: Fraction, operands: Sequence[Array]) -> Array:
    """Return the values of an operator of unbounded future over whole columns."""
    arguments = arguments_of(node, _begin(node, period), None, period)
    with np.errstate(all="ignore"):
        return values_of(node, operands, len(operands[0]), arguments, "sample")


def defined_signal(node: Apply, tick: Fraction, operands: Sequence[Events]) -> Events:
    """Return the values of an operator of unbounded future over whole step functions, in ticks."""
    check_dense_meaning(node.op)
    start = max(int(times[0]) for times, _ in operands)
    signals = []
    for times, values in operands:
        at_start = int(np.searchsorted(times, start, side="right")) - 1
        ticks = (start, *times[at_start + 1 :].tolist())
        signals.append(Steps(tuple(t * QUARTERS for t in ticks), tuple(values[at_start:].tolist())))
    with np.errstate(all="ignore"):
        result = signal_of(node, tuple(signals), _begin(node, tick) * QUARTERS, None, tick)
    return np.array([t // QUARTERS for t in result.times], np.int64), np.array(result.values, float)


def _begin(node: Apply, step: Fraction) -> int:
    return 0 if node.interval is None else int(node.interval.begin / step)
