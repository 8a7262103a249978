"""The compiled back end: runs serialised programs over samples, in discrete or dense time."""

from collections.abc import Callable, Collection, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rtamt.signals.sampling_period import RegularTimes, StoredTimes
from rtamt.signals.signal import Signal

_Events: TypeAlias = tuple[NDArray[np.int64], NDArray[np.float64]]
# Of each call: a capsule "rtamt.kernel" or what makes a driver, its interval (-1: no end), seconds in a
# step, and the instructions that it reads.
_Calls: TypeAlias = list[tuple[Any, int, int, float, tuple[int, ...]]]
# Of each input that is no plain number: the codes of an enumeration's members by name; None for a Boolean.
_Types: TypeAlias = Mapping[str, Mapping[str, float] | None]

class Refused(Exception):  # noqa: N818 - a word that reads well after except
    """An update was rejected; the monitor is unchanged."""

class Undefined(Exception):  # noqa: N818 - as above
    """An operation yielded NaN; args are the instruction and the sample, or the tick in dense time.

    A discrete-time monitor also sets the ``time`` of the sample. If a call failed, a third argument is its
    message, and the cause is the exception of a Python operator.
    """

    args: tuple[int, int] | tuple[int, int, str]
    time: float

class Monitor:
    """Runs a program online, one sample or one chunk at a time."""

    def __init__(
        self,
        program: bytes,
        names: Sequence[str],
        period: float = 1.0,
        tolerance: float = ...,
        strict: bool = True,
        ignored: Collection[str] | None = None,
        calls: _Calls = ...,
        types: _Types = ...,
    ) -> None: ...
    def update(self, t: float, values: Mapping[str, Any], /) -> float | None:
        """Take the sample of time t, a dict of every input; return what became known, or None."""

    def update_pairs(self, t: float, pairs: Sequence[Sequence[Any]], /) -> float | None:
        """The same from (name, value) pairs; a variable left out keeps its value."""

    def step(self, *values: float) -> float | None:
        """Take the next sample, one value an input, a period after the last one."""

    def push(
        self,
        times: NDArray[np.float64] | None,
        columns: Sequence[NDArray[np.float64]],
        after: int | None = None,
    ) -> list[NDArray[np.float64]]:
        """Take a chunk, a column an input, unless others than ``after`` samples came before.

        Return what became known of each output.
        """

    def accepts(self, times: NDArray[np.float64], columns: Sequence[NDArray[np.float64]]) -> bool:
        """Whether a chunk may be pushed as it is.

        False for data that has to be looked at, or is wrong.
        """

    def take_columns(
        self, data: Any, time: str
    ) -> tuple[int, list[tuple[NDArray[np.float64], NDArray[np.float64]]]] | None:
        """Take a dict of columns.

        Return the number of samples so far, and times and values of what became known of each output. None for data
        that has to be converted, or is wrong.
        """

    def finish(self) -> list[NDArray[np.float64]]:
        """End the trace; return the rest of each output."""

    def reset(self) -> None:
        """Forget every sample."""

    def state(self) -> bytes:
        """What the samples so far have left behind; in dense time but for what set_time_scale() says."""

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""

    def last(self, instruction: int) -> float | None:
        """The value of an instruction at the last slot, or None before the first."""

    def latest(self, output: int) -> float | None:
        """The value of an output that the last sample made known, or None."""

    def recent(self, count: int) -> NDArray[np.float64]:
        """The times of the last samples, as many as values can be outstanding and one more."""

    @property
    def samples(self) -> int:
        """How many samples came."""

    @property
    def violations(self) -> int:
        """How many gaps were out of tolerance."""

    @property
    def last_time(self) -> float | None:
        """The time of the last sample, or None."""

    @property
    def state_bytes(self) -> int:
        """Bytes of state."""

class Fleet:
    """Runs a program for many keys; keys are an array of int64, or of characters in rows of fixed width."""

    def __init__(
        self,
        program: bytes,
        names: Sequence[str],
        period: float,
        tolerance: float,
        restart: bool,
        capacity: int,
        state: bytes | None = None,
    ) -> None: ...
    def update(
        self,
        keys: NDArray[Any],
        times: NDArray[np.float64],
        columns: Sequence[NDArray[np.float64]],
        outputs: Sequence[
            tuple[NDArray[np.float64], NDArray[np.uint8], NDArray[np.float64], NDArray[np.uint8]]
        ],
    ) -> tuple[int, str, int, float | None, int, float | None] | None:
        """Take a batch and fill the arrays of each output: values, known, when, warming.

        Return None, or why the batch was rejected: index, reason, samples of the key so far (or the sample of the
        undefined value), time of the last one, instruction or input, and time of the undefined value.
        """

    def take(
        self, keys: NDArray[Any], times: Any, columns: list[Any]
    ) -> list[tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.float64], NDArray[np.bool_]]] | None:
        """Take a batch of arrays or lists of numbers; return the same arrays of each output, which are new.

        None, with nothing changed, for data that has to be converted or rejected.
        """

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""

    def expire(self, before: float) -> int:
        """Forget keys whose last sample is before a time; return how many."""

    def contains(self, keys: NDArray[Any]) -> bool:
        """Whether the first key of an array is there."""

    def last_times(self) -> list[float]:
        """The time of the last sample of each key, in the order of keys()."""

    def keys(self) -> list[int] | list[str] | list[bytes]:
        """All keys."""

    def snapshot(self) -> bytes:
        """The state of all keys."""

    @property
    def size(self) -> int:
        """How many keys there are."""

    @property
    def capacity(self) -> int:
        """How many keys there may be."""

    @property
    def record_size(self) -> int:
        """Bytes of state a key."""

    @property
    def state_bytes(self) -> int:
        """Bytes of state by now."""

class ReorderBuffer:
    """Puts samples in the order of their times, by key; keys as for Fleet."""

    def __init__(
        self,
        names: Sequence[str],
        lateness: float | None,
        capacity: int,
        period: float,
        tolerance: float,
        filled: int,
        state: bytes | None = None,
    ) -> None: ...
    def offer(
        self,
        keys: NDArray[Any],
        times: NDArray[np.float64],
        columns: Sequence[NDArray[np.float64]],
        late: NDArray[np.uint8],
    ) -> tuple[int, str, int, float | None, int, float | None] | None:
        """Take a batch and note which samples are late. Return None, or why it was rejected, as Fleet.update does."""

    def advance(self, watermark: float) -> tuple[int, str, int, float | None, int, float | None] | None:
        """Release what is not after a time. Return None, or why it was rejected, with the place of the key."""

    def release(self, keys: NDArray[Any]) -> tuple[int, str, int, float | None, int, float | None] | None:
        """Release all that waits of some keys. Return as :meth:`advance` does."""

    def ready(
        self,
    ) -> tuple[
        NDArray[np.int64],
        NDArray[np.uint8],
        NDArray[np.uint8],
        NDArray[np.float64],
        list[NDArray[np.float64]],
    ]:
        """What was released: places in the batch (or of keys), if it is that sample, or in a gap, times, columns."""

    def accept(self) -> None:
        """Keep the batch that was offered."""

    def withdraw(self) -> None:
        """Forget the batch that was offered."""

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""

    def discard(self, key: NDArray[Any], time: float) -> bool:
        """Forget the sample of a key and a time that waits; return whether there was one."""

    def stale(self, before: float) -> list[int] | list[str] | list[bytes]:
        """The keys whose newest sample is before a time."""

    def contains(self, keys: NDArray[Any]) -> bool:
        """Whether the first key of an array is there."""

    def left(self, keys: NDArray[Any]) -> NDArray[np.uint8]:
        """By key, whether a sample of it was released."""

    def keys(self) -> list[int] | list[str] | list[bytes]:
        """All keys."""

    def keys_at(self, places: NDArray[np.int64]) -> list[int] | list[str] | list[bytes]:
        """The keys at places."""

    def snapshot(self) -> bytes:
        """What waits."""

    @property
    def size(self) -> int:
        """How many keys there are."""

    @property
    def waiting(self) -> int:
        """How many samples wait."""

    @property
    def late(self) -> int:
        """How many samples were late."""

    @property
    def state_bytes(self) -> int:
        """Bytes by now."""

class DenseMonitor:
    """Runs a program online in dense time, one instant or one chunk at a time; times are ticks."""

    def __init__(
        self,
        program: bytes,
        names: Sequence[str],
        ignored: Collection[str] | None = None,
        calls: _Calls = ...,
        types: _Types = ...,
    ) -> None: ...
    def set_time_scale(self, signal: type, scale: Any, rate: float, whole: bool = False) -> None:
        """Set the times that update() accepts: numbers of so many ticks, or only integers (``whole``).

        Its results are of the class ``signal``, their ``_scale`` is the given one and their ``_events``
        are bytes: the ticks, then the values.
        """

    def update(self, t: Any, values: Mapping[str, Any], /) -> Any:
        """Take a dict of any inputs at a time in the set time scale; return what became known."""

    def push(self, columns: Sequence[_Events]) -> _Events:
        """Take a chunk, times and values of each input; return what became known of the first output."""

    def finish(self) -> _Events:
        """End the trace; return the rest of the first output."""

    def last_output(self, output: int) -> _Events:
        """What the last update made known of an output."""

    def points(self) -> list[list[tuple[int, float]]]:
        """The same of every output: a list for each, of pairs of time and value."""

    def reset(self) -> None:
        """Forget every sample."""

    def state(self) -> bytes:
        """What the samples so far have left behind; in dense time but for what set_time_scale() says."""

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""

    def known(self, output: int) -> int | None:
        """The last tick at which an output is known, or None."""

    @property
    def known_until(self) -> int | None:
        """The last tick at which the first output is known, or None."""

    @property
    def counts(self) -> list[int]:
        """How many samples of each input came."""

    @property
    def start(self) -> int | None:
        """The tick at which the trace begins, or None."""

    @property
    def last_times(self) -> list[int | None]:
        """The tick of the last sample of each input, or None."""

    @property
    def last_possible(self) -> int:
        """The latest tick that a sample may have."""

    @property
    def state_bytes(self) -> int:
        """Bytes of state by now."""

class EarlyMonitor:
    """Verdicts or bounds before the horizon, in discrete time (``core/early/``).

    ``nodes``, ``outputs`` and ``at_start`` are those of ``compiler.early.Graph``. ``lateness``: by how many samples
    one may come late; None where all come in order. ``verdict``: the class of what update() returns, None for bounds.
    ``replays``: whether update() takes nothing by itself. ``causes``: the parts, outputs and starts of
    ``compiler.causation.Causes``, and the class of what update() returns. ``change``: the class of what reported()
    returns, and that of its bounds. ``zone``: up to how many ticks a node bounds are computed anew.
    """

    def __init__(
        self,
        nodes: Sequence[tuple[Any, ...]],
        outputs: Sequence[int],
        at_start: Sequence[tuple[Any, ...]],
        ranges: Sequence[tuple[float, float]],
        names: Sequence[str],
        ignored: Collection[str] | None,
        types: _Types,
        period: float,
        tolerance: float,
        lateness: int | None,
        verdict: type | None,
        replays: bool = False,
        causes: tuple[Any, ...] | None = None,
        change: tuple[type, type] | None = None,
        zone: int = 50,
    ) -> None: ...
    def take(self, time: float, lower: Sequence[float], upper: Sequence[float], after: int) -> Any:
        """Take bounds of every input at one time, in order."""

    def learn(self, time: float, values: Sequence[tuple[int, float, float]], after: int) -> Any:
        """Take bounds (input, lower, upper) of some inputs at one time."""

    def watermark(self, time: float) -> None:
        """Nothing at or before a time will come."""

    def finish(self) -> Any:
        """End the trace; return what that makes known."""

    def verdicts(self, output: int) -> list[Any]:
        """The verdicts of an output that the last call decided."""

    def at_start(self) -> tuple[float, float] | None:
        """The bounds at the start of the trace."""

    def bounds(self, output: int, sample: int) -> tuple[float, float] | None:
        """The bounds of an output at a sample, None where they are forgotten."""

    def changes(self, output: int) -> list[tuple[int, int, float, float]]:
        """Runs (first, last, lower, upper) that the last call changed."""

    def reported(self, output: int) -> list[Any]:
        """The same as a list of objects with times."""

    def supposed(
        self,
        output: int | None,
        sample: int,
        later: Sequence[tuple[int, int, Sequence[float], Sequence[float]]],
    ) -> tuple[float, float] | None:
        """The bounds of an output at a sample, or at the start, if later samples had these bounds of all inputs.

        ``later``: (first, last, lower, upper), counted from the sample after the newest; None as for bounds().
        """

    def causation_at_start(self) -> tuple[float, float]:
        """Violation and satisfaction that the newest sample causes at the start of the trace."""

    def causation(self, output: int, sample: int) -> tuple[float, float]:
        """Violation and satisfaction that the newest sample causes for an output at a sample."""

    def caused(self, output: int) -> list[tuple[int, int, float, float]]:
        """The same as runs (first, last, violation, satisfaction), where there is any."""

    def begin_at(self, sample: int) -> bool:
        """Number the first sample, so that earlier ones may follow. Return False where it must be 0."""

    def place(self, time: float) -> int | None:
        """The index of a time, or None."""

    def known(self, variable: int, sample: int) -> tuple[float, float]:
        """What is known of an input at a sample."""

    def time(self, sample: int) -> float:
        """The time of a sample."""

    def held(self, output: int) -> int:
        """The first sample that is held."""

    def state(self) -> bytes:
        """The state after the samples so far."""

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""

    @property
    def samples(self) -> int: ...
    @property
    def newest(self) -> int: ...
    @property
    def earliest(self) -> float:
        """The first time that may still be reported."""

    @property
    def closed(self) -> int: ...
    @property
    def finished(self) -> bool: ...
    @property
    def computes_zone(self) -> bool:
        """Whether it computes the bounds of all open samples anew."""

    @property
    def state_bytes(self) -> int: ...

class DenseEarlyMonitor:
    """The same in dense time. Times are ticks, and runs reach from ``begin`` up to but excluding ``end``.

    ``groups``: formulas whose traces start at the same instant: (nodes, outputs, at_start, inputs, causes), these as
    for EarlyMonitor and inputs the numbers of those that form the trace. The first ``required`` ones are those of
    requirements, of which the start reports the minimum. ``outputs``: where each is, (group, output); the first may be
    the minimum of several. ``lateness``: by how many ticks a sample may come late after the newest one of any input;
    None where those of each input come in order. ``verdicts``: verdicts, not bounds. What stands for no tick is
    ``compiler.graph.NEVER``.
    """

    def __init__(
        self,
        groups: Sequence[tuple[Any, ...]],
        required: int,
        outputs: Sequence[Sequence[tuple[int, int]]],
        ranges: Sequence[tuple[float, float]],
        names: Sequence[str],
        ignored: Collection[str] | None,
        types: _Types,
        lateness: int | None,
        verdicts: bool,
        replays: bool = False,
    ) -> None: ...
    def set_time_scale(self, verdict: type, rate: float) -> None:
        """Let update() take times in numbers of ``rate`` ticks each, and return objects of a class like VerdictRun."""

    def learn(self, tick: int, values: Sequence[tuple[int, float, float]], after: int) -> None:
        """Take bounds (input, lower, upper) of some inputs at one tick."""

    def watermark(self, tick: int) -> None:
        """Nothing at or before a tick will come."""

    def finish(self) -> None:
        """End the trace: every input holds its value."""

    def verdicts(self, output: int) -> list[tuple[int, int, bool, int]]:
        """Runs (begin, end, satisfied, decided at) that the last call decided or reached."""

    def changes(self, output: int) -> list[tuple[int, int, float, float]]:
        """Runs (begin, end, lower, upper) that the last call changed."""

    def runs(self, output: int) -> list[tuple[int, int, float, float]]:
        """All runs that are held, up to the newest sample."""

    def at_start(self) -> tuple[float, float] | None:
        """The bounds at the start of the trace."""

    def bounds(self, output: int, tick: int) -> tuple[float, float] | None:
        """The bounds of an output at a tick, None where they are not held."""

    def supposed(
        self, output: int | None, tick: int, later: Sequence[tuple[int, int, float, float]]
    ) -> tuple[float, float] | None:
        """The bounds of an output at a tick, or at the start, if inputs had such bounds behind their newest samples.

        ``later``: (input, from, lower, upper) in order; None as for bounds().
        """

    def causation_at_start(self) -> tuple[float, float]:
        """Violation and satisfaction that the last call caused at the start of the trace."""

    def causation(self, output: int, tick: int | None) -> tuple[float, float] | None:
        """The same of an output at a tick, or at the start; None before the trace."""

    def caused(self, output: int) -> list[tuple[int, int, float, float]]:
        """The same as runs (begin, end, violation, satisfaction), where there is any."""

    def known(self, number: int, tick: int) -> tuple[float, float]:
        """What is known of an input at a tick."""

    def place(self, tick: int) -> int:
        """The position of a time, which is the tick itself."""

    def held(self, output: int) -> int | None:
        """The first tick that is held, None before the trace has started."""

    def state(self) -> bytes:
        """The state after the samples so far."""

    def restore(self, state: bytes) -> None:
        """Restore the state of a monitor that was made with the same arguments."""

    @property
    def samples(self) -> int: ...
    @property
    def counts(self) -> list[int]: ...
    @property
    def last_times(self) -> list[int]: ...
    @property
    def newest(self) -> int: ...
    @property
    def closed(self) -> int: ...
    @property
    def complete(self) -> int: ...
    @property
    def finished(self) -> bool: ...
    @property
    def state_bytes(self) -> int: ...

def opcode_names() -> list[str]:
    """The names of the opcodes, in the order of their codes."""

def evaluate(
    program: bytes, columns: Sequence[NDArray[np.float64]], n: int, calls: _Calls = ...
) -> list[NDArray[np.float64]]:
    """Run a program over a whole trace of n samples; return n values an output."""

class Evaluator:
    """Runs a program without calls over whole traces."""

    def __init__(self, program: bytes) -> None: ...
    def run(
        self, columns: list[NDArray[np.float64]], n: int, threads: Callable[[], int] | None = None
    ) -> list[NDArray[np.float64]]:
        """Run over columns of n samples, one an input; return n values an output.

        A long trace is evaluated by at most threads() threads.
        """

class Batch:
    """Evaluates a plan on many traces of one length at a time.

    ``stages``: as for :class:`DirectEvaluator`, over so many ``variables``.
    """

    def __init__(
        self,
        stages: list[tuple[Evaluator, list[int], list[tuple[str, list[int]]]]],
        variables: int,
    ) -> None: ...
    def run(
        self,
        columns: list[NDArray[np.float64]],
        rows: NDArray[np.int64],
        n: int,
        results: NDArray[np.float64],
    ) -> bool:
        """Evaluate the first n samples of these rows of the columns; write to the same rows of the results.

        False where a value is undefined.
        """

    @property
    def joins_words(self) -> bool:
        """Whether truth values of 64 traces are joined at once."""

def new_rows(rows: int, width: int) -> NDArray[np.float64]:
    """Return a new array of this shape, of any numbers, in memory that is used again."""

def instance_maker(kind: type, slots: Sequence[str]) -> Callable[[Any, Any, Any], Any]:
    """Return a function that makes an instance of a class from the values of three slots, without ``__init__``."""

class DirectEvaluator:
    """Reads, checks and evaluates a recording in one call.

    ``given``: the ``period`` is not inferred from timestamps. ``fewest``, ``most``: numbers of samples. ``stages``: of
    each its evaluator, the places of its columns, and its scans: kinds and operands. Variables come before scans.
    """

    def __init__(
        self,
        names: Sequence[str],
        time: str,
        period: float,
        given: bool,
        tolerance: float,
        fewest: int,
        most: int,
        stages: list[tuple[Evaluator, list[int], list[tuple[str, list[int]]]]],
        threads: Callable[[], int] | None,
        signal: type[Signal],
        regular_times: type[RegularTimes],
        stored_times: type[StoredTimes],
        exact_period: Fraction,
    ) -> None: ...
    def run(self, data: Any) -> tuple[bytearray | list[NDArray[np.float64]], int, bool, Signal] | None:
        """Evaluate a dict of columns, or a tuple of an array and a dict from names to its columns.

        Return the columns, and the timestamps if there are any, as rows of a bytearray or as a list of arrays; the
        number of samples, whether there are timestamps, and the robustness. None for data that has to be converted,
        is wrong, or makes no value.
        """

class DenseDirectEvaluator:
    """Reads, checks and evaluates a recording in dense time in one call.

    ``rate``: ticks in a second. ``extra``: for how many ticks after the end stages with scans run. ``stages``: of each
    its program, the places of its signals, and its scans: kinds and operands. Variables come before scans.
    """

    def __init__(
        self,
        names: Sequence[str],
        time: str,
        rate: float,
        extra: int,
        stages: list[tuple[bytes, list[int], list[tuple[str, list[int]]]]],
        signal: type[Signal],
    ) -> None: ...
    def run(self, data: Any) -> tuple[bytearray, list[int], Signal] | None:
        """Evaluate a dict of signals.

        Return ticks and values of each variable, the numbers of their samples, and the robustness.
        None for data that has to be converted, is wrong, or makes no value.
        """

def update_signal_class(base: type) -> type:
    """Return the class of results of updates in dense time, which derives from a class that has slots alone.

    Its objects hold the points; ``_events``, ticks and then values as bytes, and ``_scale``, the format of times, give
    them to the base, whose ``_many_points()`` does what ``points()`` cannot.
    """

def read_columns(
    data: Any,
    names: Sequence[str],
    time: str,
    period: float | None,
    tolerance: float,
) -> tuple[NDArray[np.float64] | None, float, dict[str, NDArray[np.float64]], int] | None:
    """Copy the columns of a trace, a dict, or a tuple of an array and a dict from names to its columns.

    Return the timestamps (None without), the period (inferred if None), columns by name and their length. None if
    anything has to be converted, or is wrong.
    """

def has_period(times: NDArray[np.float64], period: float, coarse: float) -> bool:
    """Whether more than half of the gaps between timestamps in order are a period.

    None that a decimal with one digit less describes as well counts; ``coarse`` is one in that digit.
    """

def evaluate_bounds(
    program: bytes, columns: Sequence[NDArray[np.float64]], n: int
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Run a program without calls over bounds of a whole trace, an array of shape (n, 2) an input.

    Return lower and upper bounds of each output.
    """

def scan(
    kind: str, a: NDArray[np.float64], b: NDArray[np.float64] | None = None, n: int | None = None
) -> NDArray[np.float64]:
    """Unbounded future over a whole column, run_max, run_min, or until.

    With n, over traces of n samples each in it.
    """

def fewest_cells(
    asked: NDArray[np.int64], found: NDArray[np.int64], before: int, after: int, need: int
) -> list[tuple[int, int]]:
    """As few cells of ``found`` as possible, so that ``need`` of them are in each window of the cells ``asked``.

    The window of k is [k + before, k + after]; ranges of cells are rows of begins and ends.
    """

def memory(program: bytes, calls: _Calls = ...) -> int:
    """Bytes of state of a new monitor of this program."""

def layout(program: bytes, calls: _Calls = ...) -> list[tuple[int | None, int | None]]:
    """What the passes make of a program in discrete time.

    For each instruction: the root of the chain that it is computed in, and its register, None where there is none.
    """

def dense_evaluate(
    program: bytes, columns: Sequence[_Events], extra: int = 0, calls: _Calls = ...
) -> list[_Events]:
    """Run a program over whole signals, up to their last time and extra ticks more."""

def dense_evaluate_bounds(
    program: bytes, columns: Sequence[_Events], extra: int = 0
) -> list[tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]]:
    """Run a program without calls over bounds of whole signals, times and an array of shape (n, 2) of each."""

def dense_scan(kind: str, a: _Events, b: _Events | None = None) -> _Events:
    """Unbounded future over whole step functions: run_max, run_min, or until."""

class MonitorBase:
    """Takes samples in discrete time: through ``_backend`` where that is a Monitor, else through Python.

    ``_update_carefully`` and ``_step_carefully`` of the derived class receive what the back end refuses, and
    ``_no_value`` makes the error of an ``Undefined``.
    """

    _backend: Any

    def update(self, time: float, /, **values: float) -> float | None: ...
    def step(self, /, *values: float) -> float | None: ...

class DenseMonitorBase:
    """The same in dense time."""

    _backend: Any

    def update(self, time: Any, /, **values: float) -> Any: ...

class EarlyMonitorBase:
    """The same for early verdicts."""

    _backend: Any

    def update(self, time: Any, /, **values: Any) -> Any: ...
