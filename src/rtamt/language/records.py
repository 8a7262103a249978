"""The record of an operator, and a language: an immutable set of operators.

The table of the built-in operators is in ``operators.py``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import Enum
from types import MappingProxyType

from rtamt.errors import UsageError, shown
from rtamt.language.formula import Apply, Formula, Interval
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from rtamt.language.quantifiers import Binder
    from rtamt.language.units.rules import UnitRule

    Expansion = Callable[..., Formula]
    Lookup = Callable[[str], "Operator | None"]
    #: From operands that are not known everywhere, the interval, and where they are known.
    Pastification = Callable[[tuple[Formula, ...], Interval | None, "Known"], Formula]


class Fixity(Enum):
    """The notation of an operator."""

    PREFIX = "prefix"  # always[0:5] φ
    LEFT = "left"  # a - b - c  is  (a - b) - c
    RIGHT = "right"  # a -> b -> c  is  a -> (b -> c)
    FUNCTION = "function"  # abs(x)
    CONDITIONAL = "conditional"  # if φ then x else y
    ATOM = "atom"  # true
    QUANTIFIER = "quantifier"  # forall v in cars: φ


class Sort(Enum):
    """The type of an operand: a number, a formula with its robustness, or a formula of which only the truth counts."""

    NUMBER = "number"
    FORMULA = "formula"
    CONDITION = "condition"  # evaluates to +inf where it holds, else -inf, under every semantics


class Tense(Enum):
    """The instants that an operator reads besides the present one."""

    NONE = "none"
    PAST = "past"
    FUTURE = "future"


class Bounds(Enum):
    """Whether an operator takes an interval."""

    NONE = "none"
    OPTIONAL = "optional"  # left out: [0, inf)
    REQUIRED = "required"  # and bounded
    DURATION = "duration"  # one duration, [d]; left out: one sampling period


class Known(ABC):
    """The condition under which operands are known: after the delay of pastification, or while a member is present."""

    @property
    @abstractmethod
    def now(self) -> Formula:
        """True where they are known."""

    @property
    @abstractmethod
    def begun(self) -> Formula:
        """True from the first instant on at which they are known."""

    @abstractmethod
    def before(self, interval: Interval | None) -> Formula:
        """True where they were known the duration of an interval ago, by default one sample."""


class Source(Enum):
    """The source of an operator's value, which is that of one of its operands at some instant."""

    BRANCH = "branch"  # the second operand where the first holds, else the third
    HELD = "held"  # the first operand when the second last held; where it never did, the third or the first value
    DELAYED = (
        "delayed"  # the first operand so long ago; where that is too early, the second or the first value
    )


@dataclass(frozen=True, slots=True)
class Pointwise:
    """One value from the operands' values at the same instant; ``partial`` if it can be undefined (NaN)."""

    opcode: str
    partial: bool = False


@dataclass(frozen=True, slots=True)
class Window:
    """Largest (``max``) or smallest (``min``) value in a window."""

    reduce: str


@dataclass(frozen=True, slots=True)
class Sum:
    """Sum of the values in a window of the past, of a ``timed`` operator times the period; inf - inf is NaN."""


@dataclass(frozen=True, slots=True)
class Shift:
    """The operand one sample away, ``fill`` where that sample does not exist."""

    fill: float


@dataclass(frozen=True, slots=True)
class Ahead:
    """The operand a number of steps ahead; after the end of the trace, its last value."""


@dataclass(frozen=True, slots=True)
class Rank:
    """The k-th largest value in a window, by the share in the interval."""


@dataclass(frozen=True, slots=True)
class Since:
    """The recursion of since; the tense of its record is past."""


@dataclass(frozen=True, slots=True)
class Until:
    """The window of until; in the past tense the window of precedes."""


@dataclass(frozen=True, slots=True)
class Blocks:
    """A Python class over blocks of numpy arrays, for each time domain that it supports.

    ``discrete`` and ``dense`` are called with the bounds of the interval, in samples and in ticks (without
    arguments if the operator takes no interval), and return an object for one trace: see
    docs/how-to/extend.md for its methods.
    """

    discrete: Callable[..., Any] | None = None
    dense: Callable[..., Any] | None = None


@dataclass(frozen=True, slots=True)
class Compiled:
    """Kernels in a shared library built with ``rtamt/kernel.hpp``.

    ``library`` is its path; ``discrete`` and ``dense`` are the names of the kernels in it, for each supported
    time domain.
    """

    library: str
    discrete: str | None = None
    dense: str | None = None


Kernel = Pointwise | Window | Rank | Sum | Shift | Ahead | Since | Until | Blocks | Compiled

#: The default of ``reach``: not given.
_UNSAID = -1


@dataclass(frozen=True, slots=True, eq=False)
class Operator:
    """One operator. Two operators are equal only if they are the same record.

    Its meaning is its ``definition``. An operator without a definition has the meaning of its ``expansion``,
    and is expanded before it is analysed. ``tense`` and the interval determine which instants it reads;
    without an interval, ``reach`` is the distance in samples, None for all samples.
    ``power`` is the binding power (higher binds tighter). ``guards`` determines how pastification keeps
    an operand that was delayed by d from being read before its first value:
    ``"and"`` (the operand counts as false there), ``"implies"`` (as true), ``"zero"`` (as 0), None (not necessary).
    Of an operator that needs more than this, ``pastified`` returns the formula in the past.
    ``absent``: what counts in place of an operand where a member of a group is absent (by default ``guards``); there
    also ``"held"``, the last value before.
    ``twin`` names the past operator that a future one becomes ("" if the operand itself does).
    ``dual`` names the operator for which ``not op(x) == dual(not x)``.
    """

    name: str
    spellings: tuple[str, ...]  # the first one is printed
    fixity: Fixity
    power: int
    operands: tuple[Sort, ...]
    result: Sort
    doc: str
    example: str
    latex: str = ""  # {0}, {1} operands, {I} the interval as a subscript; by default the first spelling
    definition: Callable[..., Any] | None = None
    tense: Tense = Tense.NONE
    bounds: Bounds = Bounds.NONE
    kernel: Kernel | None = None
    expansion: Expansion | None = None
    dense: Callable[..., float] | None = None
    discrete_only: bool = False
    before: int = 0  # how many samples, or ticks, before its window of the past it reads, too
    timed: bool = False  # seconds matter: the definition takes the sampling period after the bounds
    share: bool = False  # its first operand is a share of the window, which the interval holds
    one_tick: bool = (
        False  # in dense time its interval is the tick behind, in discrete time the sample behind
    )
    why_discrete: str = (
        ""  # completes the message in dense time; by default that it reads a neighbouring sample
    )
    reach: int | None = _UNSAID
    dual: str | None = None
    twin: str | None = None
    guards: tuple[str | None, ...] = ()
    absent: tuple[str, ...] = ()
    pastified: Pastification | None = None
    optional: int = 0  # how many of the last operands may be left out
    positive: bool = False  # its duration is longer than zero
    strict: bool = False  # a formula is no operand, though others read its robustness as a number
    folds: bool = False  # a function that accepts more operands: f(a, b, c) is f(f(a, b), c)
    keeps: tuple[int, ...] = ()  # the operands, Boolean or of an enumeration too, whose type the result has
    source: Source | None = None  # of an operator with an expansion: where its value is taken from
    equates: bool = False  # a comparison that members of an enumeration have, too
    presence: bool = False  # the operand is a variable of any type; only whether it has a sample counts
    truth: Expansion | None = None  # of a predicate: the formula that is +inf where it holds, else -inf
    # Interval extension of a pointwise operator (enclosures.py): the bounds of the result from those of
    # the operands, and the monotonicity of the result in each operand.
    extension: Callable[..., Any] | None = None
    slopes: Callable[..., tuple[int | None, ...]] | None = None
    # In English, by default its notation: {0} an operand, {I} the window, {D} the duration, {S} the share, {B} the
    # binder.
    phrase: str = ""
    fails: str = ""  # where a function has no value, for a message; by default several reasons are named
    binder: Binder | None = None  # of a quantifier in a formula
    # The unit of the result from those of the operands (``units/rules.py``); None: unknown.
    units: UnitRule | None = None
    # Of an operator that a text declares: what makes it again, a function and its arguments.
    maker: tuple[Callable[..., Operator], tuple[Any, ...]] | None = None

    def check(self) -> None:
        """Raise :class:`UsageError` if the record is not a valid operator."""
        arity = _ARITY.get(self.fixity)
        if arity is not None and len(self.operands) != arity:
            raise UsageError(
                f"the operator '{self.name}' is written as {self.fixity.value} and needs {arity} operands, "
                f"not {len(self.operands)}"
            )
        if self.definition is None and self.expansion is None:
            raise UsageError(
                f"the operator '{self.name}' has no definition: give a function on arrays, or an expansion"
            )
        if self.definition is not None and not callable(self.definition):
            raise UsageError(f"the definition of '{self.name}' is no function: give one on arrays")
        self._check_kernel()
        if not self.spellings:
            raise UsageError(f"the operator '{self.name}' has no spelling: give at least one")
        for spelling in self.spellings:
            word = spelling.isidentifier()
            if not word and (not spelling or spelling in _PUNCTUATION or any(map(_in_a_word, spelling))):
                raise UsageError(
                    f"the operator '{self.name}' cannot be spelled '{spelling}': use a word, or symbols "
                    f"other than brackets and punctuation"
                )

    def _check_kernel(self) -> None:
        if self.definition is None:
            if self.kernel is not None:
                raise UsageError(
                    f"the operator '{self.name}' has a kernel and no definition that it could be held against: "
                    f"give one, a function on arrays"
                )
            return
        if isinstance(self.kernel, Blocks | Compiled) and self.expansion is not None:
            raise UsageError(f"the operator '{self.name}' has an expansion and a kernel: keep one of them")
        if self.tense is Tense.NONE and self.bounds is not Bounds.NONE:
            raise UsageError(
                f"the operator '{self.name}' takes an interval and reads one instant only: "
                f"say where it reads, tense=Tense.PAST or Tense.FUTURE"
            )
        if self.tense is Tense.NONE or self.bounds is not Bounds.NONE:
            return
        if self.reach is not None and self.reach < 0:
            raise UsageError(
                f"the operator '{self.name}' reads the {self.tense.value} and takes no interval: "
                f"say how far it reads, reach= a number of samples, or None for all of them"
            )
        if self.reach is not None and self.dense is not None and not self.one_tick:
            raise UsageError(
                f"the operator '{self.name}' has a dense definition and a reach in samples, which dense time "
                f"does not have: give it an interval, or reach=None"
            )

    def __call__(self, *args: Formula, interval: Interval | None = None) -> Apply:
        """Build the formula ``op[interval](*args)``."""
        return Apply(self, args, interval)

    def __repr__(self) -> str:
        return f"<operator {self.name}>"

    def __reduce__(self) -> str | tuple[Any, ...]:
        # Records are compared by identity, so a built-in operator unpickles to the record in the table.
        from rtamt.language.operators import builtin

        if builtin(self.name) is self:
            return (builtin, (self.name,))
        if self.maker is not None:
            return self.maker
        return object.__reduce__(self)


_ARITY = {Fixity.ATOM: 0, Fixity.PREFIX: 1, Fixity.LEFT: 2, Fixity.RIGHT: 2, Fixity.CONDITIONAL: 3}

#: Punctuation of the language, which cannot be the spelling of an operator.
_PUNCTUATION = frozenset("()[],;:=@")


def _in_a_word(char: str) -> bool:
    return char.isalnum() or char.isspace() or char in '_"'


@dataclass(frozen=True, slots=True, eq=False)
class Language:
    """An immutable set of operators."""

    operators: tuple[Operator, ...]
    #: Every spelling of every operator, separated by spaces: a key whose hash is computed once.
    spellings: str
    _by_name: Mapping[str, Operator]
    #: By their spellings: operators at the begin of an operand, and after one.
    openings: Mapping[str, Operator]
    infixes: Mapping[str, Operator]
    #: The ``get`` of both, of dictionaries, which look up faster than read-only views of them.
    lookups: tuple[Lookup, Lookup]

    @classmethod
    def of(cls, operators: Iterable[Operator]) -> Language:
        """Build a language; duplicate names or spellings are errors."""
        table = tuple(operators)
        names: dict[str, Operator] = {}
        opening: dict[str, Operator] = {}
        infix: dict[str, Operator] = {}
        for op in table:
            if not isinstance(op, Operator):
                raise UsageError(f"{shown(op)} is no operator; give an Operator")
            op.check()
            if op.name in names:
                raise UsageError(f"two operators are named '{op.name}': give each a name of its own")
            names[op.name] = op
            spelled = infix if op.fixity in (Fixity.LEFT, Fixity.RIGHT) else opening
            for spelling in op.spellings:
                if spelling in spelled:
                    raise UsageError(f"'{spelling}' spells both '{spelled[spelling].name}' and '{op.name}'")
                spelled[spelling] = op
        words = " ".join((*opening, *infix))
        of_names, of_openings, of_infixes = map(MappingProxyType, (names, opening, infix))
        return cls(table, words, of_names, of_openings, of_infixes, (opening.get, infix.get))

    def extend(self, *operators: Operator) -> Language:
        """Return a new language with these operators added.

        >>> from dataclasses import replace
        >>> import rtamt
        >>> from rtamt.language.operators import STL
        >>> within = dict(definition=lambda a, b: 1 - abs(a - b), expansion=None, truth=None, dual=None)
        >>> near = replace(STL["ge"], name="near", spellings=("~~",), **within)
        >>> spec = rtamt.parse("always(x ~~ 3)", language=STL.extend(near), backend="python")
        >>> spec.evaluate({"x": [3, 3.5]}).robustness
        0.5
        """
        return Language.of((*self.operators, *operators))

    def __repr__(self) -> str:
        return f"<language of {len(self.operators)} operators>"

    def __getitem__(self, name: str) -> Operator:
        return self._by_name[name]

    def get(self, name: str) -> Operator | None:
        """Return the operator called ``name``, or None."""
        return self._by_name.get(name)

    def opening(self, spelling: str) -> Operator | None:
        """Return the operator that ``spelling`` means where an operand can begin."""
        return self.openings.get(spelling)

    def infix(self, spelling: str) -> Operator | None:
        """Return the operator that ``spelling`` means after an operand."""
        return self.infixes.get(spelling)

    def __iter__(self) -> Iterator[Operator]:
        return iter(self.operators)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Language.of, (self.operators,))
