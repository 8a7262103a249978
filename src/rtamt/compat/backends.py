"""The back end of the paper's classes: the compiled core, or the definition if the core is not built."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compat.options import Language
from rtamt.engine import BACKENDS, Evaluators, engine_of
from rtamt.engine.backend import compiled_backend
from rtamt.errors import UsageError
from rtamt.language.formula import Const
from rtamt.language.undefined_value import UndefinedByDefinitionError, at_sample, undefined
from rtamt.language.units.durations import UNITS
from rtamt.signals.discrete import DISCRETE, Discrete

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace


def is_compiled() -> bool:
    """Return whether the compiled core can be loaded."""
    try:
        compiled_backend(DISCRETE).require()
    except UsageError:
        return False
    return True


def require_core(what: str, instead: str) -> None:
    """Raise :class:`UsageError` for ``what`` if the core cannot be loaded; suggest ``instead``."""
    try:
        compiled_backend(DISCRETE).require()
    except UsageError as reason:
        raise UsageError(
            f"{what} needs the compiled core, which cannot be loaded; install the package with a C++ compiler "
            f"at hand, or use {instead}, which gives the same results more slowly"
        ) from reason


def check_language(language: Language) -> None:
    """Raise :class:`UsageError` for a language that the combined classes do not support."""
    if not isinstance(language, Language):
        raise UsageError(f"the language is {language!r}; choose Language.PYTHON or Language.CPP")
    if language is Language.CPP:
        require_core("Language.CPP", "Language.PYTHON")


def backend() -> str:
    """Return the name of the back end: the compiled core, or the definition where it cannot be loaded."""
    return BACKENDS[0] if is_compiled() else BACKENDS[1]


def signal(formula: Formula, recording: DomainTrace) -> Signal:
    """Return the robustness of a formula over a finished recording."""
    return Evaluators(backend())((formula,), recording)[0]


class Stream:
    """A stream of samples that has not begun.

    ``formulas``: past formulas, the formula of the result first. ``inputs``: their variables. ``period``:
    the sampling period in seconds. ``unit``: that of the timestamps. ``tolerance``: the allowed deviation of a
    gap, as a fraction of the period, before it is counted. ``ignored``: other names that a sample may hold.
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        period: Fraction,
        unit: str,
        tolerance: float,
        ignored: Collection[str],
    ) -> None:
        self._made_of = formulas, inputs, period, unit, tolerance, ignored
        self._unit = float(UNITS[unit])
        domain = Discrete(period, tolerance)
        chosen: Any = engine_of(domain).backends[backend()]
        self._session = chosen.session(
            formulas, inputs, domain, ignored, strict=False, unit=UNITS[unit], parts=True
        )
        #: The monitor, which counts samples and gaps.
        self.monitor: Any = self._session.open()
        #: Raised by :meth:`take` for a rejected sample.
        self.refused = self._session.refused
        self._undefined: Any = self._session.undefined
        #: What an update from pairs raises where :meth:`take` has to find out what is wrong.
        self.refusals: tuple[type[Exception], ...] = ()
        #: The fast path for plain input of the caller; None if there is none.
        self.quick: Callable[[Any, Any], Any] | None = None
        if self._session.checks:
            self.refusals = (self.refused, *self._undefined, UsageError)
            self.quick = self.monitor.update_pairs

    def take(self, timestamp: Any, numbers: Mapping[str, Any]) -> float:
        """Take a sample and return the robustness.

        Raises :attr:`refused`, or :class:`EvaluationError` where an operation has no value; the stream is
        then unchanged.
        """
        try:
            robustness: float = self.monitor.update_pairs(timestamp, list(numbers.items()))
        except UndefinedByDefinitionError:  # whose text has seconds already
            raise
        except self._undefined as error:
            formula = self._session.culprit(error)
            raise undefined(formula, at_sample(error.args[1], error.time * self._unit)) from None
        return robustness

    def __reduce__(self) -> tuple[Any, ...]:
        return _reopen, (self._made_of, self.monitor.state())

    def latest(self, part: Formula) -> float:
        """Return the value of a formula, or of a part of one, at the latest sample."""
        return part.value if isinstance(part, Const) else self._session.part(self.monitor, part)


def _reopen(made_of: tuple[Any, ...], state: Any) -> Stream:
    stream = Stream(*made_of)
    stream.monitor.restore(state)
    return stream
