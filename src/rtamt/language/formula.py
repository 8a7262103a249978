"""Formulas: three immutable node types, compared by meaning and not by position in the text.

::

    Formula = Const(value) | Var(name) | Apply(op, args, interval)

A :class:`Parameter` is a Const whose value can be changed where the formula is evaluated.

A node's ``span`` is its position in the text, so that later errors can point there; equality ignores it.
Walk a formula with :func:`fold`, which does not recurse: a conjunction of ten thousand terms is a
valid formula.

Named sub-formulas are shared, so that a formula is a graph. Written out, a formula of sixty definitions that
each use the previous one twice has 10¹⁸ nodes. Every traversal must visit each node object once.
"""

from __future__ import annotations

from functools import partial

from rtamt.language.equal_nodes import EqualNodes, representative
from rtamt.lazy.dataclasses import dataclass, field, fields, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.contents import Contents, LargeContents
    from rtamt.language.operators import Operator
    from rtamt.language.shares import Share
    from rtamt.language.value_types import PartType

T = TypeVar("T")

#: Nodes are counted up to this.
COUNTLESS = 10**18

#: Nodes are walked as if none were shared up to this number, before that is checked.
_UNCHECKED = 1000

#: The largest formula that caches the list of its nodes: a file may name each of its sub-formulas.
KEPT = 5000


class Span(NamedTuple):
    """A half-open range of characters of the source text."""

    start: int
    end: int


#: A span of a pair, in half the time of calling Span.
span_of: Callable[[tuple[int, int]], Span] = partial(tuple.__new__, Span)


@dataclass(frozen=True, slots=True)
class Interval:
    """An interval ``[begin, end]`` of seconds, exact; ``end=None`` means unbounded.

    ``begin_open``, ``end_open``: whether a bound is not part of it; ``rewrite.ground`` turns such bounds into
    closed ones. ``share``: how much of the window an operator needs. ``begin_unit``, ``end_unit`` and ``constants``
    (the named ones) only record how the bounds were written; ``written`` is the interval of the text, if it is
    another one, and ``implied`` one that the text does not contain at all.
    """

    begin: Fraction
    end: Fraction | None
    begin_unit: str = field(default="", compare=False)
    end_unit: str = field(default="", compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)
    constants: tuple[str, ...] = field(default=(), compare=False, repr=False)
    begin_open: bool = False
    end_open: bool = False
    share: Share | None = None
    written: Interval | None = field(default=None, compare=False, repr=False)
    implied: bool = field(default=False, compare=False, repr=False)

    def __hash__(self) -> int:
        # Hashing fractions is slow.
        end = self.end
        return hash((self.begin.as_integer_ratio(), None if end is None else end.as_integer_ratio()))

    @property
    def is_open(self) -> bool:
        """Whether a bound is not part of the interval."""
        return self.begin_open or self.end_open


class Formula:
    """Base class of the three node types; ``str(formula)`` parses back to an equal formula."""

    __slots__ = ()

    span: Span | None

    def __repr__(self) -> str:
        from rtamt.language.printing.printer import to_text
        from rtamt.language.printing.writing import PAGE

        return f"<formula {to_text(self, limit=PAGE)}>"

    def __copy__(self) -> Formula:
        return self

    def __deepcopy__(self, _memo: object) -> Formula:
        return self  # immutable, as all that it holds

    def __reduce__(self) -> tuple[Any, ...]:
        # A flat list of the nodes: pickle would recurse to the depth of the formula.
        nodes = postorder(self)
        places = {id(node): i for i, node in enumerate(nodes)}
        return _restore, (tuple([_flat(node, places) for node in nodes]),)

    def __str__(self) -> str:
        from rtamt.language.printing.printer import to_text

        return to_text(self)

    def latex(self) -> str:
        """Return the formula as LaTeX mathematics, without dollar signs."""
        from rtamt.language.printing.latex import to_latex

        return to_latex(self)


@dataclass(frozen=True, slots=True, repr=False)
class Const(Formula):
    """A number (IEEE double; never NaN).

    ``name`` only records that a named constant was written. ``type``: that of a constant that is no plain number;
    the ``name`` of a member of an enumeration is printed.
    """

    value: float
    span: Span | None = field(default=None, compare=False, repr=False)
    name: str | None = field(default=None, compare=False, repr=False)
    type: PartType = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True, repr=False)
class Parameter(Const):
    """A declared parameter and its value in use; two parameters of equal value are different formulas."""

    name: str = field(default="", repr=False)


@dataclass(frozen=True, slots=True, repr=False)
class Var(Formula):
    """A signal, by name; a field of a structured signal is part of the name (``req.value``).

    ``type``: as declared; None for numbers. A text declares each name once, so equality ignores it.
    """

    #: Whether a quantifier determines what it is: see ``quantifiers.py``.
    bound: ClassVar[bool] = False

    name: str
    span: Span | None = field(default=None, compare=False, repr=False)
    type: PartType = field(default=None, compare=False, repr=False)

    def __hash__(self) -> int:
        return hash(self.name)


@dataclass(frozen=True, slots=True, eq=False, repr=False, init=False)
class Apply(Formula):
    """An operator applied to formulas, with an interval where the operator takes one."""

    op: Operator
    args: tuple[Formula, ...]
    interval: Interval | None = None
    span: Span | None = field(default=None, repr=False)
    # What follows is found on first use, as most formulas are made of others, used once, and forgotten.
    _hash: int = field(init=False, repr=False)
    _size: int = field(init=False, repr=False)
    #: The class of nodes that were found equal to this one.
    _class: EqualNodes = field(init=False, repr=False)
    #: The nodes below in postorder, and what they contain: a formula is walked many times.
    _below: tuple[Formula, ...] = field(init=False, repr=False)
    _contents: Contents | LargeContents = field(init=False, repr=False)

    def __init__(
        self,
        op: Operator,
        args: tuple[Formula, ...],
        interval: Interval | None = None,
        span: Span | None = None,
    ) -> None:
        _store_op(self, op)
        _store_args(self, args)
        _store_interval(self, interval)
        _store_span(self, span)

    def __hash__(self) -> int:
        try:
            return self._hash
        except AttributeError:
            for arg in self.args:
                if isinstance(arg, Apply) and not hasattr(arg, "_hash"):
                    for node in _lacking(arg, "_hash"):
                        _store_hash(node, hash((node.op, node.args, node.interval)))
            found = hash((self.op, self.args, self.interval))
            _store_hash(self, found)
            return found

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Apply):
            return NotImplemented
        pairs: list[tuple[Formula, Formula]] = [(self, other)]
        # Sound only if everything turns out equal; then it is kept, so that each shared node is compared once.
        assumed: dict[EqualNodes, EqualNodes] = {}
        while pairs:
            a, b = pairs.pop()
            if a is b:
                continue
            if isinstance(a, Apply) and isinstance(b, Apply):
                if (
                    hash(a) != hash(b)
                    or a.op is not b.op
                    or a.interval != b.interval
                    or len(a.args) != len(b.args)
                ):
                    return False
                first, second = _class_of(a, assumed), _class_of(b, assumed)
                if first is not second:
                    # Ordered by address, so that concurrent threads cannot create a cycle.
                    low, high = (first, second) if id(first) < id(second) else (second, first)
                    assumed[high] = low
                    pairs.extend(zip(a.args, b.args, strict=True))
            elif a != b:
                return False
        for high, low in assumed.items():
            high.joined = low
        return True


# A third of the time of ``object.__setattr__``, with which frozen classes store otherwise.
_store_op, _store_args, _store_interval, _store_span = (
    vars(Apply)[name].__set__ for name in ("op", "args", "interval", "span")
)
_store_hash, _store_size, _store_class, _store_below, store_contents = (
    vars(Apply)[name].__set__ for name in ("_hash", "_size", "_class", "_below", "_contents")
)


def _lacking(formula: Apply, name: str) -> Iterator[Apply]:
    """Yield the nodes of a formula that do not have a value yet, operands first; the caller stores it."""
    stack = [formula]
    while stack:
        node = stack[-1]
        below = [arg for arg in node.args if isinstance(arg, Apply) and not hasattr(arg, name)]
        if below:
            stack += below
        else:
            yield stack.pop()


def _class_of(node: Apply, assumed: Mapping[EqualNodes, EqualNodes]) -> EqualNodes:
    """Return the class of a node, by known and by assumed equalities."""
    try:
        known = node._class
    except AttributeError:
        known = EqualNodes()
        _store_class(node, known)
    found = representative(known)
    if found is not known:
        _store_class(node, found)
    while (other := assumed.get(found)) is not None:
        found = representative(other)
    return found


def _flat(node: Formula, places: dict[int, int]) -> tuple[Any, ...]:
    """Return a node as a constructor and its arguments, with operands replaced by their indices."""
    if isinstance(node, Apply):
        return Apply, node.op, tuple([places[id(operand)] for operand in node.args]), node.interval, node.span
    return (type(node), *[getattr(node, each.name) for each in fields(node)])  # type: ignore[arg-type] # lazy


def _restore(flat: tuple[tuple[Any, ...], ...]) -> Formula:
    """Return the formula with the nodes ``flat``, as written by :func:`_flat`."""
    nodes: list[Formula] = []
    for kind, *values in flat:
        if kind is Apply:
            values[1] = tuple([nodes[place] for place in values[1]])
        nodes.append(kind(*values))
    return nodes[-1]


def located(formula: Formula, span: Span | None) -> Formula:
    """Return the formula with another position in the text."""
    if type(formula) is Var:  # most leaves
        return Var(formula.name, span, formula.type)
    node: Any = formula  # each of the three types of nodes is a dataclass
    found: Formula = replace(node, span=span)
    return found


def children(formula: Formula) -> tuple[Formula, ...]:
    """Return the operands of a formula; numbers and variables have no operands."""
    return formula.args if isinstance(formula, Apply) else ()


def postorder(*formulas: Formula) -> tuple[Formula, ...]:
    """Return every distinct node object below and including ``formulas``, operands first.

    Several formulas that share nodes are walked in time proportional to the number of nodes.
    """
    if len(formulas) != 1:
        return _distinct_of_several(formulas)
    (formula,) = formulas
    if not isinstance(formula, Apply):
        return formulas
    try:
        below = formula._below
    except AttributeError:
        below = _distinct(formula.args)
        if len(below) <= KEPT:
            _store_below(formula, below)
    return (*below, formula)


def _distinct(formulas: tuple[Formula, ...]) -> tuple[Formula, ...]:
    """Return every distinct node object of formulas, operands first."""
    found: list[Formula] = []
    stack: list[Any] = list(formulas)
    limit = _UNCHECKED
    while stack:  # the last operands first, each before its own operands
        node = stack.pop()
        found.append(node)
        if node.__class__ is Apply:
            stack += node.args
        elif len(found) > limit:  # a formula that shares nodes may have too many to walk
            if _repeats(found):
                return _distinct_of_graph(formulas)
            limit *= 2
    if _repeats(found):
        return _distinct_of_graph(formulas)
    found.reverse()
    return tuple(found)


def _repeats(nodes: Sequence[Formula]) -> bool:
    return len(set(map(id, nodes))) < len(nodes)


def _distinct_of_several(formulas: tuple[Formula, ...]) -> tuple[Formula, ...]:
    """Return the nodes of :func:`_distinct` for formulas whose walks are kept."""
    found: dict[int, Formula] = {}
    walked = 0
    for formula in formulas:
        nodes = postorder(formula)
        walked += len(nodes)
        if walked > 20 * KEPT:  # each may contain the ones before
            return _distinct_of_graph(formulas)
        found.update(zip(map(id, nodes), nodes, strict=True))
    return tuple(found.values())


def _distinct_of_graph(formulas: tuple[Formula, ...]) -> tuple[Formula, ...]:
    """Return the nodes of :func:`_distinct` for formulas that share nodes."""
    seen: set[int] = set()
    found: list[Formula] = []
    stack: list[Formula | None] = list(formulas[::-1])
    opened: list[Formula] = []  # their operands come before the next None
    while stack:
        node = stack.pop()
        if node is None:
            found.append(opened.pop())
        elif id(node) not in seen:
            seen.add(id(node))
            if isinstance(node, Apply):
                opened.append(node)
                stack.append(None)
                stack += node.args[::-1]
            else:
                found.append(node)
    return tuple(found)


def outermost(formulas: Sequence[Formula]) -> list[Formula]:
    """Return the formulas that are not part of a later one: a search below them covers all formulas.

    >>> from rtamt.language.operators import STL
    >>> x = Var("x")
    >>> outermost([x, STL["not"](x)])
    [<formula not x>]
    """
    if len(formulas) < 2:
        return list(formulas)
    found: list[Formula] = []
    seen: set[int] = set()
    for formula in reversed(formulas):
        if id(formula) not in seen:
            found.append(formula)
            seen.update(map(id, postorder(formula)))
    return found[::-1]


def fold(formula: Formula, step: Callable[[Formula, tuple[T, ...]], T]) -> T:
    """Compute a value bottom-up: ``step(node, values of its operands)``, once per node object.

    >>> from rtamt.language.formula import Var, fold
    >>> fold(Var("x"), lambda node, below: 1 + sum(below))
    1
    """
    return folds((formula,), step)[0]


def folds(formulas: Sequence[Formula], step: Callable[[Formula, tuple[T, ...]], T]) -> tuple[T, ...]:
    """Compute a value of each of several formulas as :func:`fold` does, visiting shared nodes once."""
    values: dict[int, T] = {}
    for node in postorder(*formulas):
        below = tuple([values[id(operand)] for operand in node.args]) if isinstance(node, Apply) else ()
        values[id(node)] = step(node, below)
    return tuple([values[id(formula)] for formula in formulas])


def size(formula: Formula) -> int:
    """Return the number of nodes of the printed formula, at most :data:`COUNTLESS`.

    A shared sub-formula counts at each occurrence.

    >>> x = Var("x")
    >>> from rtamt.language.operators import STL
    >>> size(STL["and"](x, x))
    3
    """
    if not isinstance(formula, Apply):
        return 1
    try:
        return formula._size
    except AttributeError:
        for node in _lacking(formula, "_size"):
            count = sum(operand._size if isinstance(operand, Apply) else 1 for operand in node.args)
            _store_size(node, min(count + 1, COUNTLESS))
        return formula._size
