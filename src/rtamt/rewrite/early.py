"""Static analysis of bounds and verdicts that are reported before the end of the trace.

Bounds are sound for every formula. They are tight (attained by some trace that agrees with all known samples) if
every sample enters with one polarity: :func:`loose`. In discrete time the end of a trace clips windows, so that
a verdict at the end may differ from one reported while the trace went on: :func:`ends_differently`. A share of a
window has no causation: :func:`causeless`.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, TypeAlias

from rtamt.language.contents import variables
from rtamt.language.definitions.enclosures import Enclosure, extended
from rtamt.language.formula import Apply, Const, Formula, Var, children, fold, postorder
from rtamt.language.operators import Bounds, Pointwise, Shift, Since, Sum, Tense, Until, Window
from rtamt.language.shares import is_share
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.presence import tracked

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping
    from fractions import Fraction

#: The first and the last instant at which a sub-formula is read, in seconds relative to the present.
_Instant: TypeAlias = "Fraction | float"
_Span: TypeAlias = tuple[_Instant, _Instant]

_PRESENT: _Span = (0, 0)


class _Use(NamedTuple):
    """One use of a variable: the formula is nondecreasing (1) or nonincreasing (-1) in it.

    If the variable occurs in arithmetic that is not monotone, ``inside`` is that arithmetic, and ``sign``
    applies to it.
    """

    sign: int
    span: _Span
    inside: Formula | None = None


def _agree(uses: Iterable[_Use], *, dense: bool) -> bool:
    """Return whether one value of a sample minimises every two uses of a variable at once.

    They are alike, or do not read the same instant; in dense time one sample is read at many instants.
    """
    known = {(use.sign, use.inside) for use in uses}
    if len(known) < 2 or dense:
        return len(known) < 2
    first, *later = sorted(uses, key=lambda use: use.span[0])
    last, kind = first.span[1], (first.sign, first.inside)  # the latest end so far, and what ends there
    unlike: _Instant | None = None  # the latest end of anything else
    for use in later:
        begin, end = use.span
        same = (use.sign, use.inside) == kind
        before = unlike if same else last
        if before is not None and begin <= before:
            return False
        if same:
            last = max(last, end)
        else:  # which begins behind the latest end, and so ends behind it
            last, kind, unlike = end, (use.sign, use.inside), last
    return True


def loose(formula: Formula, period: Fraction | None) -> str | None:
    """Return a variable that may make bounds wider than necessary; None if bounds are tight.

    ``period``: seconds; None means dense time. Functions of the C library (``exp``, ``ln``) leave bounds up to
    four units in the last place wider.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formulas = ["always(x >= 3 -> eventually[0:5] y >= 3)", "x > 0 or x < 5", "x > 0 or prev(x < 5)"]
    >>> [loose(parse_formula(text), Fraction(1)) for text in formulas]
    [None, 'x', None]
    """
    core = desugar(tracked(formula))
    if any(map(_sums_all, postorder(core))):  # beyond the newest sample such a sum has no best bounds
        return next(iter(variables(core)), None)
    constants, varying = _constants(core), _varying(core)
    # Parents first: the instants at which a node is read, by its identity and sign.
    spans: dict[tuple[int, int], _Span] = {(id(core), 1): _PRESENT}
    uses: dict[str, list[_Use]] = {name: [] for name in variables(core)}
    for node in reversed(postorder(core)):
        for sign in (1, -1):
            span = spans.get((id(node), sign))
            if span is None or id(node) not in varying:
                continue
            if isinstance(node, Var):
                uses[node.name].append(_Use(sign, span))
                continue
            assert isinstance(node, Apply)
            moves = _moves(node, constants, varying)
            if None in moves or (
                0 in moves
                and (_repeats(node, constants, varying) or (period is None and len(variables(node)) > 1))
            ):
                return variables(node)[0]
            if 0 in moves:
                for name in variables(node):
                    uses[name].append(_Use(sign, span, node))
                continue
            for k, (operand, move) in enumerate(zip(node.args, moves, strict=True)):
                assert move is not None
                key = (id(operand), sign * move)
                read = _read(node, k, span, period)
                before = spans.get(key, read)
                spans[key] = min(before[0], read[0]), max(before[1], read[1])
    for name, every in uses.items():
        if not _agree(every, dense=period is None):
            return name
    return None


def _sums_all(node: Formula) -> bool:
    """Return whether a node is a sum since the start of the trace."""
    if not isinstance(node, Apply) or not isinstance(node.op.kernel, Sum):
        return False
    return node.interval is None or node.interval.end is None


def _moves(node: Apply, constants: Mapping[int, float], varying: Collection[int]) -> tuple[int | None, ...]:
    """Return the monotonicity of an operator in each operand; see ``rows.slopes``."""
    if node.op.tense is not Tense.NONE:
        return (1,) * len(node.args)
    if node.op.slopes is None:
        return (None,) * len(node.args)
    slopes = node.op.slopes(*(constants.get(id(operand)) for operand in node.args))
    return tuple(
        slope if id(operand) in varying else 1 for operand, slope in zip(node.args, slopes, strict=True)
    )


def _repeats(node: Formula, constants: Mapping[int, float], varying: Collection[int]) -> bool:
    """Return whether arithmetic reads a variable twice, or contains a temporal formula."""
    if any(isinstance(part, Apply) and part.op.tense is not Tense.NONE for part in postorder(node)):
        return True

    def reads(part: Formula, below: tuple[int, ...]) -> int:
        return 1 if isinstance(part, Var) else sum(below)

    return fold(node, reads) > len(variables(node)) or any(
        isinstance(part, Apply) and None in _moves(part, constants, varying) for part in postorder(node)
    )


def _varying(formula: Formula) -> set[int]:
    """Return the identities of the nodes that read a variable; fields of members are none."""
    found: set[int] = set()
    for node in postorder(formula):
        own = isinstance(node, Var) and not node.bound
        if own or not found.isdisjoint(map(id, children(node))):
            found.add(id(node))
    return found


def _constants(formula: Formula) -> dict[int, float]:
    """Return the values of the literal numbers, by identity of the node."""
    found: dict[int, float] = {}
    for node in postorder(formula):
        if isinstance(node, Const):
            found[id(node)] = node.value
        elif (
            isinstance(node, Apply)
            and node.op.extension is not None
            and all(id(x) in found for x in node.args)
        ):
            assert node.op.definition is not None
            found[id(node)] = float(node.op.definition(*(np.array([found[id(x)]]) for x in node.args))[0])
    return found


def _read(node: Apply, operand: int, span: _Span, period: Fraction | None) -> _Span:
    """Return the instants at which an operand is read, from those at which the node is read."""
    op = node.op
    if op.tense is Tense.NONE:
        return span
    begin: Fraction | float
    end: Fraction | float
    if op.bounds is Bounds.NONE:
        begin = end = period or 0  # in dense time the span does not matter
    elif node.interval is None:
        begin, end = 0, inf
    else:
        begin, end = node.interval.begin, inf if node.interval.end is None else node.interval.end
    if isinstance(op.kernel, Since | Until) and (operand == 0 or op.tense is Tense.PAST):
        # φ at every instant up to ψ; for precedes, ψ may also be at the present instant.
        begin = begin if isinstance(op.kernel, Since) and operand == 1 else 0
    if op.tense is Tense.PAST:
        begin, end = -end, -begin
    return span[0] + begin, span[1] + end


def ends_differently(formula: Formula, ranges: Mapping[str, tuple[float, float]]) -> Apply | None:
    """Return an operator for which bounds and verdicts may differ at the end of a discrete trace.

    None: reported bounds and verdicts also hold at the end. The operator returned reads the future of an
    operand that is partly known at instants without a sample: one that reads the past, or
    a constant, or a variable with a declared range. For verdicts, pass the formula in its Boolean
    semantics (``boolean``).

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formulas = ["always[0:5](x >= 3)", "eventually[1:2] once[0:5](x >= 3)"]
    >>> [ends_differently(parse_formula(text), {}) for text in formulas]
    [None, <formula eventually[1:2](once[0:5](x - 3))>]
    """
    unseen: dict[int, Enclosure | None] = {}  # None: differs among these instants

    def known(node: Formula) -> bool:
        found = unseen[id(node)]
        return found is None or found.lower[0] > -inf or found.upper[0] < inf

    with np.errstate(all="ignore"):
        for node in postorder(desugar(formula)):
            if isinstance(node, Apply) and node.op.tense is Tense.FUTURE and any(map(known, node.args)):
                return node
            unseen[id(node)] = _unseen(node, [unseen[id(operand)] for operand in children(node)], ranges)
    return None


def _unseen(
    node: Formula, below: list[Enclosure | None], ranges: Mapping[str, tuple[float, float]]
) -> Enclosure | None:
    """Return the bounds of a sub-formula at instants that have no sample yet."""
    if isinstance(node, Const | Var):
        low, high = (node.value,) * 2 if isinstance(node, Const) else ranges.get(node.name, (-inf, inf))
        return Enclosure(np.array([low]), np.array([high]))
    assert isinstance(node, Apply)
    operands = [x for x in below if x is not None]
    if len(operands) < len(below) or node.op.tense is Tense.PAST:
        return None
    if node.op.extension is None:
        return Enclosure(
            np.array([-inf]), np.array([inf])
        )  # future operators over operands that may have any value
    assert node.op.definition is not None
    return extended(node.op.definition, node.op.extension, operands)


def connects(node: Formula) -> bool:
    """Return whether an operator only takes minima, maxima and negations of its operands."""
    kernel = node.op.kernel if isinstance(node, Apply) else None
    if isinstance(kernel, Pointwise):
        return kernel.opcode in ("min", "max", "neg")
    return isinstance(kernel, Window | Shift | Since | Until)


def at_one_instant(node: Formula) -> bool:
    """Return whether a formula reads all its variables at the instant of its value."""
    return not any(isinstance(each, Apply) and each.op.tense is not Tense.NONE for each in postorder(node))


def causeless(formula: Formula) -> Formula | None:
    """Return a part of a formula that has no causation, which is a share of a window.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> causeless(parse_formula("always(atleast[0:9](80%, x > 0))"))
    <formula atleast[0:9](80%, x > 0)>
    """
    return next((node for node in postorder(formula) if is_share(node)), None)
