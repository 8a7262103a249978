"""The interface of a back end, which evaluates and monitors formulas in one time domain."""

from __future__ import annotations

from abc import ABC, abstractmethod

from rtamt.engine.engine import BACKENDS, engine_of
from rtamt.engine.native import core, culprit
from rtamt.errors import UsageError
from rtamt.language.contents import types_of
from rtamt.language.formula import postorder
from rtamt.language.undefined_value import UndefinedByDefinitionError
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar, TypeVar
from rtamt.rewrite.desugar import desugar
from rtamt.signals.coding import codes_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.program import CallSite, Program
    from rtamt.compiler.stored import StoredPlan
    from rtamt.engine.early import EarlyQuery, EarlySession
    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import BoundedSignal
    from rtamt.signals.time_domain_interface import TimeDomain


class RefusedError(Exception):
    """An update cannot be taken; nothing has changed."""


class Backend(ABC):
    """Evaluates and monitors formulas in one time domain."""

    #: Whether the compiled core computes; else the definition does.
    compiled: ClassVar[bool]

    @abstractmethod
    def evaluator(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[Any], Sequence[Any]]:
        """Return a function from a trace of ``inputs`` to the values of each formula.

        ``step``: that of the traces, in seconds. The function may be called again with other traces.
        """

    @abstractmethod
    def bounds(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[Any], list[BoundedSignal]]:
        """Return the same for traces that are known in part: the bounds of each formula, as signals."""

    @abstractmethod
    def require(self) -> None:
        """Raise :class:`UsageError` where this back end cannot run."""

    @abstractmethod
    def memory(self, program: Program) -> int | None:
        """Return the bytes of state of a monitor that runs a program; None where that depends on the samples."""

    @abstractmethod
    def session(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: Any,
        ignored: Collection[str] = (),
    ) -> Session:
        """Prepare to monitor formulas of bounded future that read ``inputs``, the result first.

        ``domain``: the time domain, whose step is known. ``ignored``: other variables that an update may hold.
        """

    def early_session(self, query: EarlyQuery, domain: Any) -> EarlySession:
        """Prepare to report verdicts, bounds or causation of formulas before the horizon.

        For time domains that have early verdict modes. ``domain``: the time domain, whose step is known.
        """
        raise NotImplementedError


class Session(ABC):
    """Formulas that a back end has prepared for monitors."""

    #: What a monitor raises for an update that it cannot take; nothing has changed then.
    refused: type[Exception] = RefusedError
    #: What it raises where an operation has no value, for :meth:`culprit`. Others are final errors.
    undefined: tuple[type[Exception], ...] = ()
    #: Whether its monitors check all data of an update, so that callers need not.
    checks: bool = False

    @abstractmethod
    def open(self) -> Any:
        """Return a monitor that has taken no sample; ``_core.pyi`` describes its methods."""

    def part(self, monitor: Any, formula: Formula) -> Any:
        """Return the new values of a part of the formulas after the last update of a monitor."""
        raise NotImplementedError

    def culprit(self, error: Exception) -> Formula:
        """Return the operation without a value, as it is written in the formulas."""
        raise error

    @property
    def fingerprint(self) -> bytes:
        """The identity of the states of monitors, which differs between sessions."""
        return b""

    @property
    def calls(self) -> Sequence[CallSite]:
        """The calls of kernels, whose state cannot be copied."""
        return ()

    def require_copyable(self) -> None:
        """Raise :class:`UsageError` where the state of a monitor cannot be copied."""
        if self.calls:
            name = self.calls[0].op.name
            raise UsageError(
                f"a monitor of '{name}' can be neither copied nor pickled: only the operator's own code knows what "
                f"it remembers; use backend='python'"
            )


class Definition(Session):
    """Formulas that are evaluated by definition."""

    undefined = (UndefinedByDefinitionError,)

    def culprit(self, error: Exception) -> Formula:
        """See :class:`Session`."""
        culprit: Formula = error.args[0]
        return culprit


C = TypeVar("C", bound=Backend)
D = TypeVar("D", bound=Backend)


class Place(NamedTuple):
    """The location of an instruction: the ``root`` of its chain and its ``register``, None if there is none."""

    root: int | None
    register: int | None


class Compiled(Backend):
    """The compiled core as a back end; ``definition`` evaluates what the core can only call."""

    compiled = True

    def __init__(self, definition: Defined) -> None:
        self._definition = definition

    def bounds(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[Any], list[BoundedSignal]]:
        """See :class:`Backend`."""
        from rtamt.compiler.stored import is_built_in  # monitors do not wait for it

        if all(map(is_built_in, postorder(*map(desugar, formulas)))):
            return self.core_bounds(formulas, step, inputs)
        return self._definition.bounds(formulas, step, inputs)

    @abstractmethod
    def core_bounds(
        self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]
    ) -> Callable[[Any], list[BoundedSignal]]:
        """Return the bounds of formulas of built-in operators, see :meth:`bounds`."""

    @abstractmethod
    def stored(self, formulas: tuple[Formula, ...], step: Fraction, inputs: tuple[str, ...]) -> StoredPlan:
        """Compile formulas to a plan without formulas; arguments as for :meth:`evaluator`.

        Raises :class:`UsageError` for a custom operator.
        """

    @abstractmethod
    def stored_evaluator(self, plan: StoredPlan) -> Callable[[Any], Sequence[Any]]:
        """Return the same as :meth:`evaluator`, from a plan without formulas."""

    @abstractmethod
    def check(self, code: bytes, inputs: Sequence[str]) -> None:
        """Raise :class:`ValueError` for the bytes of a program that the core does not run."""

    def layout(self, program: Program) -> Sequence[Place]:  # noqa: ARG002 - of the C++ back end
        """Return where the core computes and keeps the value of each instruction; empty where nothing is merged."""
        return ()

    def require(self) -> None:
        """See :class:`Backend`."""
        core()


class Defined(Backend):
    """A back end that is the definition in Python."""

    compiled = False

    def require(self) -> None:
        """See :class:`Backend`: it runs everywhere."""

    def memory(self, program: Program) -> None:
        """See :class:`Backend`: its monitors keep samples."""

    def bounds(
        self,
        formulas: tuple[Formula, ...],
        step: Fraction,  # noqa: ARG002 - that of the trace
        inputs: tuple[str, ...],  # noqa: ARG002 - as above
    ) -> Callable[[Any], list[BoundedSignal]]:
        """See :class:`Backend`."""
        return lambda trace: [self.bounds_of(formula, trace) for formula in formulas]

    @abstractmethod
    def bounds_of(self, formula: Formula, trace: Any) -> BoundedSignal:
        """Return the bounds of a formula over a recording that is known in part."""


class CompiledSession(Session):
    """Formulas that run as a program in the compiled core."""

    checks = True

    def __init__(self, formulas: Sequence[Formula], program: Program) -> None:
        self.program = program
        self._formulas = tuple(formulas)
        #: What the core converts or checks, because not every number is a value of the variable.
        self._types = codes_of(types_of(*formulas))
        self.refused = core().Refused
        self.undefined = (core().Undefined,)

    def culprit(self, error: Exception) -> Formula:
        """See :class:`Session`."""
        return culprit(error, self.program, self._formulas)

    @property
    def fingerprint(self) -> bytes:
        """The checksum at the end of the program."""
        return self.program.code()[-4:]

    @property
    def calls(self) -> Sequence[CallSite]:
        """See :class:`Session`."""
        return self.program.calls


def compiled_backend(domain: TimeDomain | type[TimeDomain]) -> Compiled:
    """Return the compiled core as the back end of a time domain."""
    backend = engine_of(domain).backends[BACKENDS[0]]
    assert isinstance(backend, Compiled)
    return backend


def named(compiled: C, defined: D) -> Mapping[str, C | D]:
    """Return the back ends of a time domain by name."""
    return dict(zip(BACKENDS, (compiled, defined), strict=True))
