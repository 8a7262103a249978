"""The paper's API in discrete time: the base class and the offline class."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import partial
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.compat.backends import signal
from rtamt.compat.explained import ExplainedSpecification
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.formulas import Formulas
from rtamt.compat.options import sampling
from rtamt.errors import StlError, UsageError
from rtamt.language.units.durations import UNITS
from rtamt.lazy.modules import np
from rtamt.rewrite.check import check_bounds
from rtamt.signals import arrays
from rtamt.signals.arrays import TIME
from rtamt.signals.data_errors import missing_variable
from rtamt.signals.discrete import DiscreteTrace, record_discrete
from rtamt.signals.sampling_period import TOLERANCE

if TYPE_CHECKING:
    from rtamt.language.document import Document
    from rtamt.language.formula import Formula


class DiscreteTimeSpecification(Formulas):
    """The base of the classes for discrete time: the sampling period.

    Not instantiated by users.
    """

    def __init__(self) -> None:
        super().__init__()
        self._period = Fraction(1)
        self._tolerance = TOLERANCE
        self._violations = 0  # of the latest evaluation

    # ---- settings --------------------------------------------------------------------------------

    @raises_rtamt
    def set_sampling_period(
        self, sampling_period: float = 1, unit: str = "s", tolerance: float = TOLERANCE
    ) -> None:
        """Set the time between samples.

        ``sampling_period`` in ``unit`` (h, min, s, ms, us, ns); ``tolerance``, from 0 to 1, is the allowed
        deviation of a gap, as a fraction of the period, before :attr:`sampling_violation_counter` counts it.
        """
        before = self._period, self._tolerance
        self._period, self._tolerance = sampling(sampling_period, unit, tolerance)
        try:
            self._apply_settings()
        except StlError:
            self._period, self._tolerance = before
            raise

    def get_sampling_frequency(self) -> float:
        """Return the number of samples per second."""
        return float(1 / self._period)

    @property
    def sampling_tolerance(self) -> float:
        """The allowed deviation of gaps between samples, as a fraction of the period."""
        return self._tolerance

    @property
    def sampling_violation_counter(self) -> int:
        """The number of gaps between samples that deviate from the period by more than the tolerance."""
        return self._violations

    @property
    def _period_in_units(self) -> float:
        return float(self._period / UNITS[self._unit])

    # ---- reading ---------------------------------------------------------------------------------

    def _accept(self, document: Document) -> None:
        rule = document.sampling
        if rule is not None and (rule.hold or rule.period != self._period):
            raise UsageError(
                f"'{rule}' is read by rtamt.load and rtamt.parse; here the period is set with "
                f"set_sampling_period(), and data are samples as they are"
            )
        super()._accept(document)
        self._violations = 0

    def _check(self, formula: Formula, text: str) -> None:
        check_bounds(formula, self._period, text)


class StlDiscreteTimeOfflineSpecification(ExplainedSpecification, DiscreteTimeSpecification):
    """Evaluates finished traces.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeOfflineSpecification()
    >>> spec.declare_var("req", "float")
    >>> spec.spec = "always(req >= 3)"
    >>> spec.parse()
    >>> spec.evaluate({"time": [0, 1, 2], "req": [5, 4, 6]})
    [[0.0, 1.0], [1.0, 1.0], [2.0, 3.0]]
    """

    @raises_rtamt
    def evaluate(self, dataset: Mapping[str, Any]) -> list[list[float]]:
        """Return the robustness at every sample, ``[[time, value], ...]``.

        ``dataset``: from ``"time"`` to n timestamps in :attr:`unit`, and from every variable to n
        numbers (or objects, where the specification reads fields). Other keys are ignored, and
        nothing is changed. Gaps between samples that deviate from the sampling period are counted in
        :attr:`sampling_violation_counter`; the evaluation still counts in samples. Raises
        :class:`RTAMTException` for wrong data.
        """
        formula = self._result
        timestamps, trace = self._trace(dataset)
        values = signal(self._apply_semantics(formula), trace).values
        gaps = np.diff(timestamps)
        period = self._period_in_units
        self._violations = int(np.count_nonzero(np.abs(gaps - period) > self._tolerance * period))
        self._value_of = partial(self._values_over, trace)
        self._remember(formula, trace)
        result: list[list[float]] = np.column_stack((timestamps, values)).tolist()
        return result

    def _values_over(self, trace: DiscreteTrace, part: Formula) -> list[float]:
        values: list[float] = signal(self._under_semantics(part), trace).values.tolist()
        return values

    def _trace(self, dataset: Any) -> tuple[arrays.FloatArray, DiscreteTrace]:
        """Return the timestamps as given, and the trace in seconds, regardless of the gaps between samples."""
        keys = dataset if isinstance(dataset, Mapping) else getattr(dataset, "columns", ())
        columns = {key: dataset[key] for key in keys}
        timestamps = arrays.array(columns[TIME], TIME) if TIME in columns else None
        if timestamps is not None:
            columns[TIME] = timestamps * float(UNITS[self._unit])
        unit = "s" if columns else None  # given by the specification, so that large numbers are valid seconds
        trace = record_discrete(columns or dataset, self._inputs, self._period, inf, unit)
        if timestamps is None:
            raise missing_variable(TIME, tuple(columns))
        return timestamps, trace
