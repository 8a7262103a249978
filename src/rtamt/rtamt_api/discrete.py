"""The paper's API in discrete time: what its classes share, and the offline one."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import inf
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.engine import signals
from rtamt.engine.signals import TIME, Trace
from rtamt.errors import StlError, UsageError, did_you_mean
from rtamt.language.formula import Formula, Var, postorder, variables
from rtamt.language.printer import canonical
from rtamt.language.units import UNITS, duration
from rtamt.rewrite.check import check_bounds
from rtamt.rtamt_api.backends import signal
from rtamt.rtamt_api.declarations import Declarations
from rtamt.rtamt_api.failures import raises_rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.specfile import Document


class DiscreteTimeSpecification(Declarations):
    """What the classes for discrete time share: the sampling period, and values of sub-formulas.

    Not made by users.
    """

    def __init__(self) -> None:
        super().__init__()
        self._period = Fraction(1)
        self._tolerance = signals.TOLERANCE
        self._formulas: dict[str, Formula] = {}  # by name, the result last
        self._inputs: tuple[str, ...] = ()  # the variables they read, fields by full name
        self._value_of: Callable[[Formula], Any] | None = None  # of the latest evaluation or update
        self._violations = 0  # of the latest evaluation

    # ---- settings --------------------------------------------------------------------------------

    @raises_rtamt
    def set_sampling_period(
        self, sampling_period: float = 1, unit: str = "s", tolerance: float = signals.TOLERANCE
    ) -> None:
        """Set the time between samples.

        ``sampling_period`` in ``unit`` (s, ms, us, ns); ``tolerance``, from 0 to 1, is the fraction of
        the period by which a gap may miss it before :attr:`sampling_violation_counter` counts it.
        """
        period = duration(sampling_period, unit)
        if period == 0:
            raise UsageError(f"the sampling period is {sampling_period} {unit}; it must be positive")
        if not (signals.is_number(tolerance) and 0 <= tolerance <= 1):
            raise UsageError(
                f"the sampling tolerance is {tolerance!r}; it is a fraction of the period, from 0 to 1"
            )
        before = self._period, self._tolerance
        self._period, self._tolerance = period, float(tolerance)
        try:
            self._settings_changed()
        except StlError:
            self._period, self._tolerance = before
            raise

    def get_sampling_frequency(self) -> float:
        """Return the samples per second."""
        return float(1 / self._period)

    @property
    def sampling_tolerance(self) -> float:
        """The fraction of the period by which a gap between samples may miss it."""
        return self._tolerance

    @property
    def sampling_violation_counter(self) -> int:
        """How many gaps between samples missed the period by more than the tolerance."""
        return self._violations

    @property
    def _period_in_units(self) -> float:
        return float(self._period / UNITS[self._unit])

    # ---- reading ---------------------------------------------------------------------------------

    def _parsed(self, document: Document) -> None:
        formulas = self._assertions(document)
        for formula in formulas.values():
            check_bounds(formula, self._period, document.text)
        self._formulas = formulas
        self._inputs = tuple(dict.fromkeys(name for f in formulas.values() for name in variables(f)))
        self._value_of = None
        self._violations = 0

    @raises_rtamt
    def spec_print(self) -> str:
        """Return the formula in RTAMT's canonical text; after ``pastify`` the pastified one.

        >>> import rtamt
        >>> spec = rtamt.StlDiscreteTimeSpecification()
        >>> spec.spec = "eventually[0,1] (a >= b)"
        >>> spec.parse()
        >>> spec.spec_print()
        'eventually[0,1]((a)>=(b))'
        """
        return canonical(self._result)

    @property
    def _result(self) -> Formula:
        """The formula of the last assertion."""
        _ = self._parsed_document
        return list(self._formulas.values())[-1]

    # ---- values ----------------------------------------------------------------------------------

    @raises_rtamt
    def get_value(self, var_name: str) -> Any:
        """Return what a variable, an assertion or a sub-formula is worth now.

        ``var_name``: the name of a variable or assertion, or the text of a formula, such as its
        canonical text ``'(a)>=(2.0)'``. After ``evaluate`` the value is a list, one number a sample;
        after ``update`` it is the latest number; before both it is what was declared. A variable of
        a message class gives its object.
        """
        if var_name in self._objects and (self._value_of is None or self._holds(var_name)):
            return self._objects[var_name]
        if self._value_of is None:
            hint = did_you_mean(var_name, [*self._objects, *self._formulas])
            raise UsageError(f"'{var_name}' has no value yet{hint}; call update() or evaluate() first")
        return self._value_of(self._formula_named(var_name))

    def _holds(self, name: str) -> bool:
        """Tell whether what is held for a variable is its value: objects are kept, numbers need not be."""
        return not isinstance(self._objects[name], Real)

    def _formula_named(self, text: str) -> Formula:
        if text in self._formulas:
            return self._formulas[text]
        if text in self._inputs:
            return Var(text)
        if text in self._types:
            raise UsageError(f"the specification does not read '{text}', so that its values are not kept")
        formula = self._read_formula(text)
        parts = {node for part in self._formulas.values() for node in postorder(part)}
        if formula not in parts:
            raise UsageError(f"'{text}' is no part of the specification {self.spec_print()}")
        return formula


class StlDiscreteTimeOfflineSpecification(DiscreteTimeSpecification):
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

        ``dataset``: from ``"time"`` to n time stamps in :attr:`unit`, and from every variable to n
        numbers (or objects, where the specification reads fields). Other keys are ignored, and
        nothing is changed. Gaps between samples that miss the sampling period are counted in
        :attr:`sampling_violation_counter`; the evaluation goes by samples all the same. Raises
        :class:`RTAMTException` for wrong data.
        """
        formula = self._result
        stamps, trace = self._trace(dataset)
        values = signal(formula, trace)
        gaps = np.diff(stamps)
        period = self._period_in_units
        self._violations = int(np.count_nonzero(np.abs(gaps - period) > self._tolerance * period))
        self._value_of = lambda part: signal(part, trace).tolist()
        result: list[list[float]] = np.column_stack((stamps, values)).tolist()
        return result

    def _trace(self, dataset: Any) -> tuple[signals.FloatArray, Trace]:
        """Return the stamps as given, and the trace in seconds, whatever the gaps between its samples."""
        keys = dataset if isinstance(dataset, Mapping) else getattr(dataset, "columns", ())
        columns = {key: dataset[key] for key in keys}
        stamps = signals.stamps(columns[TIME]) if TIME in columns else None
        if stamps is not None:
            columns[TIME] = stamps * float(UNITS[self._unit])
        trace = signals.trace(columns or dataset, self._inputs, self._period, tuple(columns), inf)
        if stamps is None:
            raise signals.missing_variable(TIME, tuple(columns))
        return stamps, trace
