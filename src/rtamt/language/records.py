"""What an operator is: one frozen record; and a language, an immutable set of them.

The records themselves are in ``operators.py``, THE TABLE.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.language.formula import Apply, Formula, Interval

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    Expansion = Callable[..., Formula]


class Fixity(Enum):
    """How an operator is written."""

    PREFIX = "prefix"  # always[0:5] φ
    LEFT = "left"  # a - b - c  is  (a - b) - c
    RIGHT = "right"  # a -> b -> c  is  a -> (b -> c)
    FUNCTION = "function"  # abs(x)
    ATOM = "atom"  # true


class Sort(Enum):
    """How an operand is read: as a number, or as a formula that holds or does not."""

    NUMBER = "number"
    FORMULA = "formula"


class Tense(Enum):
    """Which instants an operator reads besides the present one."""

    NONE = "none"
    PAST = "past"
    FUTURE = "future"


class Bounds(Enum):
    """Whether an operator takes an interval."""

    NONE = "none"
    OPTIONAL = "optional"  # left out: [0, inf)
    REQUIRED = "required"  # and bounded


@dataclass(frozen=True, slots=True)
class Pointwise:
    """One value from the operands' values at the same instant; ``partial`` if it can make a NaN."""

    opcode: str
    partial: bool = False


@dataclass(frozen=True, slots=True)
class Window:
    """Largest (``max``) or smallest (``min``) value in a window."""

    reduce: str


@dataclass(frozen=True, slots=True)
class Shift:
    """The operand one sample away, ``fill`` where that sample does not exist."""

    fill: float


@dataclass(frozen=True, slots=True)
class Since:
    """The recursion of since; the tense of its record is past."""


@dataclass(frozen=True, slots=True)
class Until:
    """The window of until; in the past tense the window of precedes."""


Kernel = Pointwise | Window | Shift | Since | Until


@dataclass(frozen=True, slots=True, eq=False)
class Operator:
    """One operator. Two operators are equal only if they are the same record.

    ``power`` is the binding power (higher binds tighter). ``guards`` tells pastification how an
    operand that was delayed by d is kept from being read before the operand meant anything:
    ``"and"`` (the operand counts as false there), ``"implies"`` (as true), None (no need).
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
    latex: str  # {0}, {1} operands, {I} the interval as a subscript
    definition: Callable[..., Any]
    tense: Tense = Tense.NONE
    bounds: Bounds = Bounds.NONE
    kernel: Kernel | None = None
    expansion: Expansion | None = None
    dense: Callable[..., float] | None = None
    discrete_only: bool = False
    reach: int | None = 1  # of a past or future operator without bounds: samples away it reads, None for all
    dual: str | None = None
    twin: str | None = None
    guards: tuple[str | None, ...] = ()
    folds: bool = False  # a function that also takes more operands: f(a, b, c) is f(f(a, b), c)
    truth: Expansion | None = None  # of a predicate: the formula that is +inf where it holds, else -inf

    def check(self) -> None:
        """Raise :class:`UsageError` where the record cannot be an operator."""
        arity = {Fixity.ATOM: 0, Fixity.PREFIX: 1, Fixity.LEFT: 2, Fixity.RIGHT: 2}.get(self.fixity)
        if arity is not None and len(self.operands) != arity:
            raise UsageError(
                f"the operator '{self.name}' is written as {self.fixity.value} and needs {arity} operands, "
                f"not {len(self.operands)}"
            )
        if not callable(self.definition):
            raise UsageError(f"the operator '{self.name}' has no definition: give a function on arrays")
        if not self.spellings:
            raise UsageError(f"the operator '{self.name}' has no spelling: give at least one")
        for spelling in self.spellings:
            word = spelling.isidentifier()
            if not word and (not spelling or spelling in _PUNCTUATION or any(map(_in_a_word, spelling))):
                raise UsageError(
                    f"the operator '{self.name}' cannot be spelled '{spelling}': use a word, or symbols "
                    f"other than brackets and punctuation"
                )

    def __call__(self, *args: Formula, interval: Interval | None = None) -> Apply:
        """Build the formula ``op[interval](*args)``."""
        return Apply(self, args, interval)

    def __repr__(self) -> str:
        return f"<operator {self.name}>"

    def __reduce__(self) -> str | tuple[Any, ...]:
        # Records are compared by identity, so a built-in one unpickles to the one in the table.
        from rtamt.language.operators import STL, builtin

        if STL.get(self.name) is self:
            return (builtin, (self.name,))
        return object.__reduce__(self)


#: What separates things in the language, and spells no operator.
_PUNCTUATION = frozenset("()[],;:=@")


def _in_a_word(char: str) -> bool:
    return char.isalnum() or char.isspace() or char in '_"'


@dataclass(frozen=True, slots=True, eq=False)
class Language:
    """An immutable set of operators."""

    operators: tuple[Operator, ...]
    _by_name: Mapping[str, Operator]
    _by_spelling: Mapping[tuple[str, bool], Operator]

    @classmethod
    def of(cls, operators: Iterable[Operator]) -> Language:
        """Build a language; a name or spelling that is used twice is an error."""
        table = tuple(operators)
        names: dict[str, Operator] = {}
        spellings: dict[tuple[str, bool], Operator] = {}
        for op in table:
            op.check()
            if op.name in names:
                raise UsageError(f"two operators are named '{op.name}': give each a name of its own")
            names[op.name] = op
            for spelling in op.spellings:
                key = (spelling, op.fixity in (Fixity.LEFT, Fixity.RIGHT))
                if key in spellings:
                    raise UsageError(f"'{spelling}' spells both '{spellings[key].name}' and '{op.name}'")
                spellings[key] = op
        return cls(table, MappingProxyType(names), MappingProxyType(spellings))

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

    def __getitem__(self, name: str) -> Operator:
        return self._by_name[name]

    def get(self, name: str) -> Operator | None:
        """Return the operator called ``name``, or None."""
        return self._by_name.get(name)

    def opening(self, spelling: str) -> Operator | None:
        """Return the operator that ``spelling`` means where an operand can begin."""
        return self._by_spelling.get((spelling, False))

    def infix(self, spelling: str) -> Operator | None:
        """Return the operator that ``spelling`` means after an operand."""
        return self._by_spelling.get((spelling, True))

    def __iter__(self) -> Iterator[Operator]:
        return iter(self.operators)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Language.of, (self.operators,))
