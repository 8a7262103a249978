"""The paper's API in dense time: signals are lists of [time, value], and so is the robustness."""

from __future__ import annotations

from copy import copy
from functools import partial
from typing import TYPE_CHECKING, Any

from rtamt.compat.backends import backend, check_language, signal
from rtamt.compat.dense_points import points_of, samples_by_name, with_points_at
from rtamt.compat.explained import ExplainedSpecification
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.formulas import Formulas
from rtamt.compat.objects import head_of
from rtamt.compat.online import OnlineSpecification, require_past
from rtamt.compat.options import Language, Semantics, sampling
from rtamt.engine import Watched
from rtamt.engine.dense.monitor import DenseMonitor, part_of
from rtamt.errors import NameInFormulaError, StlError, UsageError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Var, folds, outermost, postorder
from rtamt.language.operators import Tense
from rtamt.language.printing.printer import canonical
from rtamt.language.printing.writing import EXCERPT
from rtamt.language.units.durations import NANOSECOND, UNITS
from rtamt.rewrite.check import TICKS, check_bounds, check_dense, has_future
from rtamt.signals import arrays
from rtamt.signals.counting import all_integers
from rtamt.signals.data_errors import missing_variable, unknown_variable
from rtamt.signals.dense import record_dense
from rtamt.signals.sampling_period import TOLERANCE
from rtamt.signals.ticks import TimeScale
from rtamt.usage_guard import exclusive

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from fractions import Fraction

    from rtamt.compat.dense_points import Samples
    from rtamt.language.formula import Formula
    from rtamt.signals.dense import DenseTrace


class DenseTimeSpecification(Formulas):
    """The base of the classes for dense time: input and output of signals. Not instantiated by users."""

    @raises_rtamt
    def set_sampling_period(
        self, sampling_period: float = 1, unit: str = "s", tolerance: float = TOLERANCE
    ) -> None:
        """Accept a sampling period without effect: dense time has none, but programs for RTAMT set one.

        Arguments and errors are those of discrete time.
        """
        sampling(sampling_period, unit, tolerance)

    @property
    def _tick(self) -> Fraction:
        return NANOSECOND

    def _check(self, formula: Formula, text: str) -> None:
        # Operators that are undefined in dense time are parsed, as in RTAMT; only their values do not exist.
        check_bounds(formula, NANOSECOND, text, TICKS)
        for node in postorder(formula):
            if isinstance(node, Var) and node.name == arrays.TIME:
                # The engine's recordings keep their timestamps under this name.
                raise NameInFormulaError(
                    f"'{arrays.TIME}' means the timestamps; give the variable another name", text, node.span
                )

    @property
    def _scale(self) -> TimeScale:
        return TimeScale(NANOSECOND, "units", UNITS[self._unit])

    def _columns(self, given: dict[str, Samples], names: Sequence[str]) -> dict[str, Samples]:
        """Return the times as given, and the values, of all ``names`` in the data."""
        columns: dict[str, Samples] = {}
        for name in names:
            head, *path = (name,) if name in given else name.split(".")
            if head not in given:
                continue
            times, values = given[head]
            if path:
                values = [arrays.field_of(value, head, path, i) for i, value in enumerate(values)]
            columns[name] = times, values
        return columns


def _is_watchable(node: Formula, reads: Collection[str]) -> bool:
    """Return whether a node by itself is past, and reads nothing but ``reads``."""
    if isinstance(node, Apply):
        op = node.op
        past = op.tense is not Tense.FUTURE and (op.definition is not None or not has_future(node))
        return past and not op.discrete_only and not op.one_tick
    return not isinstance(node, Var) or node.name in reads


class StlDenseTimeOfflineSpecification(ExplainedSpecification, DenseTimeSpecification):
    """Evaluates complete signals, each on its own time base.

    >>> import rtamt
    >>> spec = rtamt.StlDenseTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.spec = "always[0:1](req >= 3)"
    >>> spec.parse()
    >>> spec.evaluate(["req", [[0, 5], [2.5, 4], [6, 6]]])
    [[0.0, 2.0], [1.5, 1.0], [6.0, 3.0]]
    """

    @raises_rtamt
    def evaluate(self, *dataset: Sequence[Any]) -> list[list[float]]:
        """Return the robustness as ``[[time, value], ...]``: a point for every change, and one at the end.

        ``dataset``: for every variable ``[name, [[time, value], ...]]``, times in :attr:`unit`, later
        from sample to sample, counted in nanoseconds; a value holds until the next one. Integers are
        exact, whatever their size, and if all times are integers so are those of the result, where they
        can be. A value is a number, or an object where the specification reads fields. Other names are
        ignored, and nothing is changed. The robustness of signals without samples has no points. Raises
        :class:`RTAMTException` for wrong data.
        """
        formula = self._result
        given = samples_by_name(dataset)
        # Only the variables of the result: those of other assertions would move the start and the end.
        names = variables(formula)
        for name in names:
            if name not in given and head_of(name) not in given:
                raise missing_variable(name, tuple(given))
        columns, scale = self._columns(given, self._inputs), self._scale
        recording, robustness = self._evaluation(formula, columns, scale)
        self._value_of = partial(self._points_over, columns, scale)
        self._remember(formula, recording)
        return robustness

    def _points_over(self, columns: dict[str, Samples], scale: TimeScale, part: Formula) -> list[list[float]]:
        return self._evaluation(part, columns, scale)[1]

    def _evaluation(
        self, part: Formula, columns: dict[str, Samples], scale: TimeScale
    ) -> tuple[DenseTrace | None, list[list[float]]]:
        """Return the recording over which a part of the specification is evaluated, and its points.

        Both are missing if no signal has samples: there is no instant then.
        """
        check_dense(part, self._parsed_document.text, ticks=False)
        read = tuple(dict.fromkeys((*variables(self._result), *variables(part))))
        held = {name: columns[name] for name in read if name in columns}
        if held and not any(times for times, _ in held.values()):
            return None, []
        recording = record_dense(held, read, NANOSECOND, scale=scale)
        whole = all(all_integers(times) for times, _ in held.values())
        return recording, points_of(signal(self._under_semantics(part), recording), whole)


class StlDenseTimeOnlineSpecification(OnlineSpecification, DenseTimeSpecification):
    """Monitors signals, each on its own time base.

    A formula with future operators must be rewritten by :meth:`pastify`; its robustness then comes
    one horizon late.

    >>> import rtamt
    >>> spec = rtamt.StlDenseTimeOnlineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.spec = "historically[0:1](req >= 3)"
    >>> spec.parse()
    >>> spec.update(["req", [[0, 5], [2.5, 4]]])
    [[0.0, 2.0], [2.5, 1.0]]
    >>> spec.update(["req", [[6, 6]]])
    [[6.0, 1.0]]
    """

    def __init__(self) -> None:
        super().__init__()
        self._monitor: DenseMonitor | None = None  # made by the first update
        self._watched: tuple[Formula, ...] = ()  # by it
        self._given: dict[str, Samples] = {}  # by the latest update
        self._whole = True  # whether all times so far were integers
        self._last: list[list[float]] = []  # the last point so far, if there is one

    @raises_rtamt
    def pastify(self) -> None:
        """Rewrite the formulas into past operators; see :class:`OnlineSpecification`.

        Also raises :class:`RTAMTException` for an operator that is undefined in dense time.
        """
        for formula in outermost([*self._formulas.values()]):
            check_dense(formula, self._parsed_document.text, ticks=False)
        super().pastify()

    @raises_rtamt
    @exclusive
    def update(self, *dataset: Sequence[Any]) -> list[list[float]]:
        """Take the next samples and return the new values, in the form of ``evaluate``.

        ``dataset``: as for ``evaluate``; a variable may have no samples (``[]``) or be left out. The
        robustness is known up to the earliest last time of the variables: a point for every change
        since the previous update, and one at that time. As in RTAMT, a variable and an operator with one
        operand and no interval also keep the points of the operand, where the value need not change. Raises
        :class:`RTAMTException` for wrong data; the monitor is then unchanged.
        """
        changes = self._update(dataset)
        points = with_points_at(changes, self._kept_times(), self._last)
        self._last = points[-1:] or self._last
        return points

    def _kept_times(self) -> list[float]:
        """Return the times at which the result has a point after the latest update, even without a change."""
        part = self._result
        while isinstance(part, Apply) and part.interval is None and len(part.args) == 1:
            (part,) = part.args
        if isinstance(part, Var):
            times, _ = self._given.get(part.name, ((), ()))
            return list(self._scale.times(self._scale.ticks(times, part.name)))
        return (
            []
            if part is self._result or isinstance(part, Const)
            else [time for time, _ in self._report(part)]
        )

    def _update(self, dataset: tuple[Any, ...]) -> list[list[float]]:
        monitor = self._require_monitor()
        given = samples_by_name(dataset)
        for name in given:
            if name not in self._reads and name not in self._types and name not in self._inputs:
                raise unknown_variable(name, tuple(self._reads))
        columns = self._columns(given, monitor.input_names)
        signal = monitor.update_many(columns)
        self._whole = self._whole and all(all_integers(times) for times, _ in columns.values())
        self._objects.update({name: values[-1] for name, (_, values) in given.items() if values})
        if len(signal):
            self._publish(float(signal.values[-1]))
        self._given = columns
        self._value_of = self._report
        return points_of(signal, self._whole)

    @raises_rtamt
    @exclusive
    def final_update(self, *dataset: Sequence[Any]) -> list[list[float]]:
        """Take the last samples, as :meth:`update` does, and return the rest of the robustness.

        Every signal holds its last value to the end, the latest of all times. Afterwards only :meth:`reset` is
        possible. Raises :class:`RTAMTException` for wrong data, and if a variable never had a sample; the monitor is
        then unchanged.

        >>> import rtamt
        >>> spec = rtamt.StlDenseTimeOnlineSpecification()
        >>> for name in ("x", "y"):
        ...     spec.declare_var(name, "float")
        >>> spec.spec = "x and y"
        >>> spec.parse()
        >>> spec.update(["x", [[0, 1], [4, 3]]], ["y", [[0, 2]]])
        [[0, 1.0]]
        >>> spec.final_update(["y", [[1, 0]]])
        [[1, 0.0], [4, 0.0]]
        """
        before = copy(self)
        points = self._update(dataset)
        kept = self._kept_times()
        try:
            signal = self._require_monitor().finish()
        except StlError:  # the last samples are rejected as well
            self.__setstate__(before.__getstate__())
            raise
        if len(signal):
            self._publish(float(signal.values[-1]))
        rest = points_of(signal, self._whole)
        if points and rest and points[-1][0] == rest[0][0]:
            del rest[0]
        points = points + rest
        last = len(points) - 1
        # Nothing need have changed at the end of the update.
        changes = [point for i, point in enumerate(points) if i in {0, last} or point[1] != points[i - 1][1]]
        return with_points_at(changes, [*kept, *self._kept_times()], self._last)

    @raises_rtamt
    @exclusive
    def reset(self) -> None:
        """Forget the signals; the next samples are the first."""
        self._value_of = None
        self._whole = True
        self._last = []
        if self._monitor is not None:
            self._monitor.reset()

    def _report(self, part: Formula) -> list[list[float]]:
        """Return the new values of a part after the latest update, or the samples of a variable (as RTAMT does)."""
        if isinstance(part, Var):
            times, values = self._given.get(part.name, ((), ()))
            number = int if self._whole else float
            return [[number(time), float(value)] for time, value in zip(times, values, strict=True)]
        if not any(part == node for node in postorder(*self._watched)):
            raise UsageError(
                f"'{canonical(part, limit=EXCERPT)}' is no part of what is watched: the result, and past "
                f"assertions that read no other variables; evaluate the finished signals offline"
            )
        return points_of(part_of(self._require_monitor(), self._under_semantics(part)), self._whole)

    def _start_over(self, formulas: dict[str, Formula]) -> None:
        super()._start_over(formulas)
        self._monitor = None
        self._whole = True
        self._last = []

    def _require_monitor(self) -> DenseMonitor:
        if self._monitor is None:
            formula, text = self._result, self._parsed_document.text
            check_dense(formula, text, ticks=False)
            require_past(formula, text)
            # Variables that the result does not read need no samples.
            reads = set(variables(formula))
            named = tuple(self._formulas.values())
            watchable = folds(named, lambda node, below: all(below) and _is_watchable(node, reads))
            others = [
                other for other, fits in zip(named, watchable, strict=True) if fits and other is not formula
            ]
            self._watched = (formula, *others)
            made = partial(
                DenseMonitor,
                self._apply_semantics(formula),
                text=text,
                backend=backend(),
                watch=[Watched(str(i), self._apply_semantics(other), text) for i, other in enumerate(others)],
                scale=self._scale,
                parts=True,
            )
            self._monitor = made(factory=made)
        return self._monitor


class StlDenseTimeSpecification(StlDenseTimeOfflineSpecification, StlDenseTimeOnlineSpecification):
    """Evaluates complete signals and monitors streams.

    ``semantics`` and ``language`` as for :class:`StlDiscreteTimeSpecification`.

    >>> import rtamt
    >>> spec = rtamt.StlDenseTimeSpecification()
    >>> spec.declare_var("x", "float")
    >>> spec.spec = "eventually[0:1](x >= 3)"
    >>> spec.parse()
    >>> spec.evaluate(["x", [[0, 5], [2, 4]]])
    [[0, 2.0], [2, 1.0]]
    >>> spec.pastify()
    >>> spec.update(["x", [[0, 5], [2, 4]]])
    [[0, 2.0], [2, 2.0]]
    """

    @raises_rtamt
    def __init__(
        self, semantics: Semantics = Semantics.STANDARD, language: Language = Language.PYTHON
    ) -> None:
        super().__init__()
        check_language(language)
        self.semantics = semantics


#: Spellings of older programs and of the paper's ROS code.
STLCTSpecification = StlDenseTimeSpecification
STLDenseTimeSpecification = StlDenseTimeSpecification
