"""The paper's API in discrete time, online: one sample in, one number out."""

from __future__ import annotations

from numbers import Real
from typing import TYPE_CHECKING, Any

from rtamt.compat.backends import Stream, check_language, require_core
from rtamt.compat.discrete import DiscreteTimeSpecification, StlDiscreteTimeOfflineSpecification
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.objects import head_of
from rtamt.compat.online import OnlineSpecification, require_past
from rtamt.compat.options import Language, Semantics
from rtamt.errors import TraceError
from rtamt.language.formula import Formula, Var
from rtamt.language.units.durations import UNITS
from rtamt.signals import arrays
from rtamt.signals.data_errors import unknown_variable
from rtamt.signals.samples import read_time, read_values
from rtamt.usage_guard import exclusive, in_use

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping


class StlDiscreteTimeOnlineSpecification(OnlineSpecification, DiscreteTimeSpecification):
    """Monitors a stream of samples.

    A formula with future operators must be rewritten by :meth:`pastify`; its robustness then comes
    one horizon late.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.spec = "historically[0:1](req >= 3)"
    >>> spec.parse()
    >>> [spec.update(t, [("req", x)]) for t, x in enumerate([5.0, 4.0, 6.0])]
    [2.0, 1.0, 1.0]
    """

    def __init__(self) -> None:
        super().__init__()
        self._stream: Stream | None = None  # made by the first update
        self._refusals: tuple[type[Exception], ...] = ()
        self._take: Callable[[Any, Any], Any] = self._begin
        self._shared = False  # whether var_object_dict was exposed: the caller may assign values through it
        self._seen: dict[str, Any] = {}  # its content after the latest update

    def update(self, timestamp: float, dataset: Iterable[tuple[str, Any]]) -> Any:
        """Take one sample and return the robustness.

        ``timestamp`` in :attr:`unit`, no earlier than the previous one: an equal timestamp is another
        sample, whose gap counts in :attr:`sampling_violation_counter`. ``dataset``: pairs of a name and a
        number (or an object, where the specification reads fields). A variable that is left out keeps its
        value. Returns a float, or the object of :attr:`out_var` with the robustness in its field.
        Raises :class:`RTAMTException` for wrong data; the monitor is then unchanged.
        """
        try:
            return self._take(timestamp, dataset)
        except self._refusals:
            return self._update_carefully(timestamp, dataset)

    @raises_rtamt
    @exclusive
    def reset(self) -> None:
        """Forget the trace; the next sample is the first."""
        if self._stream is not None:
            self._stream.monitor.reset()
        self._violations = 0
        self._value_of = None
        self._take = self._begin

    @property
    def sampling_violation_counter(self) -> int:
        """The number of gaps between samples that missed the period by more than the tolerance."""
        online = 0 if self._stream is None else int(self._stream.monitor.violations)
        return self._violations + online

    @property
    def online_interpreter(self) -> OnlineInterpreter:
        """What RTAMT's monitor counts: samples, and gaps that miss the period."""
        return OnlineInterpreter(self)

    @property
    def var_object_dict(self) -> dict[str, Any]:
        """The current value of each variable; a value assigned to an entry is used by the next update."""
        if not self._shared:
            self._shared = True
            if self._stream is not None and self._stream.monitor.samples:
                self._collect()
            self._seen = dict(self._objects)
            self._take = self._begin
        return self._objects

    # ---- starting --------------------------------------------------------------------------------

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_take": self._begin}  # the fast path is bound to one stream

    def _start_over(self, formulas: dict[str, Formula]) -> None:
        super()._start_over(formulas)
        self._stream = None
        self._take = self._begin

    def _begin(self, timestamp: Any, dataset: Any) -> Any:
        """Take a sample after setting up the stream."""
        stream = self._open_stream()
        objects = self.out_var_field or any(name != head_of(name) for name in self._inputs)
        quick = None if self._shared or objects else stream.quick
        self._take = quick or self._update_carefully
        try:
            robustness = self.update(timestamp, dataset)
        except BaseException:  # of a value, too
            self._take = self._begin
            raise
        self._value_of = self._latest
        return robustness

    @raises_rtamt
    @exclusive
    def _open_stream(self) -> Stream:
        return self._require_stream()

    @raises_rtamt
    def _require_stream(self) -> Stream:
        if self._stream is None:
            text = self._parsed_document.text
            formulas = [self._result, *(f for f in self._formulas.values() if f is not self._result)]
            for formula in formulas:
                require_past(formula, text)
            applied = [self._apply_semantics(formula) for formula in formulas]
            self._stream = Stream(
                applied, self._inputs, self._period, self._unit, self._tolerance, frozenset(self._types)
            )
            self._refusals = self._stream.refusals
        return self._stream

    # ---- the slow path: objects, values assigned from outside, any iterable, and errors ------------

    @raises_rtamt
    @exclusive
    def _update_carefully(self, timestamp: Any, dataset: Any) -> Any:
        stream = self._require_stream()
        given = self._pairs(dataset)
        numbers = self._numbers(given, stream.monitor.samples)
        try:
            robustness = stream.take(timestamp, numbers)
        except stream.refused:
            raise self._refusal(timestamp, numbers, stream.monitor) from None
        self._objects.update(given)
        published = self._publish(robustness)
        if self._shared:
            self._collect()
            self._seen = dict(self._objects)
        return published

    def _pairs(self, dataset: Any) -> dict[str, Any]:
        try:
            return {str(name): value for name, value in dataset}
        except (TypeError, ValueError):
            raise TraceError(
                f"expected pairs of a name and a value, such as [('x', 1.0)], got {dataset!r}"
            ) from None

    def _numbers(self, given: Mapping[str, Any], index: int) -> dict[str, Any]:
        """Return the numbers of sample ``index``, by the names that the formulas read."""
        for name in given:
            if name not in self._reads and name not in self._types and name not in self._inputs:
                raise unknown_variable(name, tuple(self._reads))
        numbers: dict[str, Any] = {}
        for head, names in self._reads.items():
            if head in given:
                source = given[head]
            elif head in self._objects and self._came_from_outside(head):
                source = self._objects[head]
            else:
                continue
            for name in names:
                numbers[name] = arrays.field_of(source, head, name.split(".")[1:], index)
        return numbers | {name: given[name] for name in self._inputs if name in given}

    def _came_from_outside(self, head: str) -> bool:
        """Return whether a variable's entry in var_object_dict has to be read: objects change in place."""
        return not isinstance(self._objects[head], Real) or self._is_assigned(head)

    def _refusal(self, timestamp: Any, numbers: dict[str, Any], monitor: Any) -> Exception:
        """Return the error for a sample that the monitor rejected."""
        index = monitor.samples
        last = self._seconds(monitor.last_time) if index else None
        time = read_time(self._seconds(timestamp), index, last, again=True)
        for name in self._inputs:
            if index == 0 and name not in numbers:
                return TraceError(
                    f"'{name}' has no value yet at sample 0: give every variable in the first update; "
                    f"later ones may leave it out",
                    variable=name,
                    index=0,
                )
        read_values(numbers, tuple(numbers), index, time)
        return in_use()  # the cause has disappeared meanwhile

    def _seconds(self, timestamp: Any) -> Any:
        return timestamp * float(UNITS[self._unit]) if isinstance(timestamp, Real) else timestamp

    # ---- values ----------------------------------------------------------------------------------

    def _holds(self, name: str) -> bool:
        # Once var_object_dict is exposed, every update writes into it.
        written = self._shared and self._value_of == self._latest
        return written or self._is_assigned(name) or super()._holds(name)

    def _is_assigned(self, name: str) -> bool:
        """Return whether the caller has assigned to a variable's entry in var_object_dict."""
        return self._shared and self._objects[name] is not self._seen.get(name)

    def _latest(self, part: Formula) -> float:
        return self._require_stream().latest(self._under_semantics(part))

    def _collect(self) -> None:
        """Bring var_object_dict up to date with the updates on the fast path."""
        for name, formula in [*((name, Var(name)) for name in self._inputs), *self._formulas.items()]:
            if isinstance(self._objects.get(name), Real):
                self._objects[name] = self._latest(formula)


class OnlineInterpreter:
    """The counters of an online specification, under the name that they have in RTAMT. Not instantiated by users."""

    __slots__ = ("_spec",)

    def __init__(self, spec: StlDiscreteTimeOnlineSpecification) -> None:
        self._spec = spec

    @property
    def update_counter(self) -> int:
        """The number of samples since the start or the last reset."""
        stream = self._spec._stream
        return 0 if stream is None else int(stream.monitor.samples)

    @property
    def previous_time(self) -> float:
        """The timestamp of the latest sample, in the unit of the specification; 0 if there is none."""
        stream = self._spec._stream
        return float(stream.monitor.last_time) if stream is not None and stream.monitor.samples else 0.0

    @property
    def sampling_violation_counter(self) -> int:
        """The number of gaps between samples that missed the period by more than the tolerance."""
        return self._spec.sampling_violation_counter

    def get_sampling_frequency(self) -> float:
        """Return the number of samples per second."""
        return self._spec.get_sampling_frequency()


class StlDiscreteTimeOnlineSpecificationCpp(StlDiscreteTimeOnlineSpecification):
    """The same with RTAMT's C++ back end named: raises :class:`RTAMTException` where the core is not built.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeOnlineSpecificationCpp()
    >>> spec.declare_var("x", "float")
    >>> spec.spec = "once[0:1](x >= 3)"
    >>> spec.parse()
    >>> [spec.update(t, [("x", x)]) for t, x in enumerate([5.0, 1.0, 2.0])]
    [2.0, 2.0, -1.0]
    """

    @raises_rtamt
    def __init__(self) -> None:
        require_core(type(self).__name__, StlDiscreteTimeOnlineSpecification.__name__)
        super().__init__()


class StlDiscreteTimeSpecification(StlDiscreteTimeOfflineSpecification, StlDiscreteTimeOnlineSpecification):
    """Evaluates complete traces and monitors streams.

    ``semantics``: the semantics of predicates. ``language``: the back end that RTAMT would run. Here both
    values select the compiled core; if it cannot be loaded, ``Language.PYTHON`` runs the definition in
    Python, with equal results, and ``Language.CPP`` raises :class:`RTAMTException`.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeSpecification()
    >>> spec.declare_var("x", "float")
    >>> spec.spec = "eventually[0:1](x >= 3)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1], "x": [5, 4]})
    [[0.0, 2.0], [1.0, 1.0]]
    >>> spec.pastify()
    >>> [spec.update(t, [("x", x)]) for t, x in enumerate([5, 4])]
    [2.0, 2.0]
    """

    @raises_rtamt
    def __init__(
        self, semantics: Semantics = Semantics.STANDARD, language: Language = Language.PYTHON
    ) -> None:
        super().__init__()
        check_language(language)
        self.semantics = semantics

    def evaluate(self, dataset: Mapping[str, Any]) -> list[list[float]]:
        """Evaluate a finished trace; see :class:`StlDiscreteTimeOfflineSpecification`."""
        result = super().evaluate(dataset)
        self._take = self._begin  # values come from the stream again after the next update
        return result


class StlDiscreteTimeSpecificationCpp(StlDiscreteTimeSpecification):
    """The same with RTAMT's C++ back end named: raises :class:`RTAMTException` where the core is not built.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeSpecificationCpp()
    >>> spec.declare_var("x", "float")
    >>> spec.spec = "once[0:1](x >= 3)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1, 2], "x": [5.0, 1.0, 2.0]})
    [[0.0, 2.0], [1.0, 2.0], [2.0, -1.0]]
    """

    @raises_rtamt
    def __init__(self, semantics: Semantics = Semantics.STANDARD) -> None:
        require_core(type(self).__name__, StlDiscreteTimeSpecification.__name__)
        super().__init__(semantics, Language.CPP)


#: Spellings of older programs and of the paper's ROS code.
STLSpecification = StlDiscreteTimeSpecification
STLDiscreteTimeSpecification = StlDiscreteTimeSpecification
#: LTL is STL without bounds.
LTLSpecification = LTLDiscreteTimeSpecification = StlDiscreteTimeSpecification
