"""Rules that follow declared ranges through formulas, by the interval extensions of the operators.

Each part of a formula has bounds that hold at every instant of every recording within the ranges. Operators of one
instant are extended (``definitions/enclosures.py``). The definitions of operators over time are monotone: they are
applied to the lower and to the upper bounds, of a trace that is long enough to have windows that are empty, cut and
whole; what their windows hold does not depend on how long they are.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import product
from math import inf, isnan
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Var, postorder
from rtamt.language.operators import (
    STL,
    Ahead,
    Bounds,
    Pointwise,
    Rank,
    Shift,
    Since,
    Sort,
    Source,
    Sum,
    Until,
    Window,
    builtin,
)
from rtamt.language.parsing.grammar import is_number
from rtamt.language.printing.printer import number
from rtamt.language.shares import ShareKind
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.modules import np
from rtamt.lint.found import Found

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from rtamt.language.formula import Formula, Interval
    from rtamt.language.operators import Operator
    from rtamt.lint.found import Text

    Range = tuple[float, float]

ANYTHING: Range = (-inf, inf)
#: Samples of the trace on which operators over time are evaluated.
_SAMPLES = 4
#: In place of an infinite end of a range: functions have values there.
_FAR = 1e300


class _Enclosed:
    """The bounds of each part of formulas, within the ranges of variables; of what is ``open_``, none."""

    def __init__(
        self, ranges: Mapping[str, Range], open_: Callable[[Apply], bool] = lambda _node: False
    ) -> None:
        self._ranges = ranges
        self._open = open_
        self._known: dict[int, Range] = {}
        self._kept: list[Formula] = []

    def of(self, formula: Formula) -> Range:
        """Return the bounds of a formula, by its truth, or of a number."""
        known = self._known.get(id(formula))
        if known is not None:
            return known
        for node in postorder(formula):
            if id(node) not in self._known:
                self._known[id(node)] = self._bounds(node)
                self._kept.append(node)  # so that its ID stays its own
        return self._known[id(formula)]

    def _bounds(self, node: Formula) -> Range:
        if isinstance(node, Const):
            # The value of a parameter is a default.
            return (node.value, node.value) if type(node) is Const else ANYTHING
        if isinstance(node, Var):
            return (0.0, 1.0) if node.type is BOOLEAN else self._ranges.get(node.name, ANYTHING)
        assert isinstance(node, Apply)
        if self._open(node) or node.op.presence:
            return ANYTHING
        operands = [
            # A formula as a number is its robustness, and only truth is computed here.
            ANYTHING if sort is Sort.NUMBER and not is_number(arg) else self._known[id(arg)]
            for sort, arg in zip(node.op.operands, node.args, strict=False)
        ]
        if operands and all(each == ANYTHING for each in operands):
            return ANYTHING
        if builtin(node.op.name) is node.op:
            return _apply_builtin(node.op, tuple(operands), node.interval)
        return _apply(node.op, operands, node.interval)


def _apply(op: Operator, operands: Sequence[Range], interval: Interval | None) -> Range:
    """Return the bounds of an operator from those of its operands."""
    if op.source is not None:
        taken = [operands[k] for k in op.keeps if k < len(operands)]
        return min(low for low, _ in taken), max(high for _, high in taken)
    if op.truth is not None:
        return _expand(op.truth, operands, interval)
    if op.extension is not None and op.definition is not None:
        return _extend(op, operands)
    if isinstance(op.kernel, Rank):
        # Instants outside the trace count for a share, and not for a number or a duration.
        low, high = operands[0]
        share = None if interval is None else interval.share
        return (low, inf) if share is not None and share.kind is ShareKind.PERCENT else (-inf, high)
    if isinstance(op.kernel, Window | Shift | Ahead | Since | Until):
        return _over_time(op, operands, interval)
    if isinstance(op.kernel, Sum):
        low, high = operands[0]
        return (0.0 if low >= 0 else -inf), (0.0 if high <= 0 else inf)
    if op.expansion is not None and op.kernel is None:
        return _expand(op.expansion, operands, interval)
    return ANYTHING


#: An editor asks for the same bounds at every change of a text.
_apply_builtin = lru_cache(4096)(_apply)


def _expand(expansion: object, operands: Sequence[Range], interval: Interval | None) -> Range:
    """Return the bounds of an expansion, with variables in place of the operands."""
    names = [str(k) for k in range(len(operands))]
    assert callable(expansion)
    formula = expansion(*map(Var, names), interval)
    return _Enclosed(dict(zip(names, operands, strict=True))).of(formula)


def _extend(op: Operator, operands: Sequence[Range]) -> Range:
    from rtamt.language.definitions.enclosures import Enclosure, extended

    assert op.definition is not None
    if isinstance(op.kernel, Pointwise) and op.kernel.partial and _leaves_domain(op, operands):
        return ANYTHING  # where it has no value, nothing holds
    given = [Enclosure(np.array([low]), np.array([high])) for low, high in operands]
    assert op.extension is not None
    with np.errstate(all="ignore"):
        found = extended(op.definition, op.extension, given)
    low, high = float(found.lower[0]), float(found.upper[0])
    return ANYTHING if isnan(low) or isnan(high) else (low, high)


def _leaves_domain(op: Operator, operands: Sequence[Range]) -> bool:
    """Return whether a function has no value at a corner of the ranges of its operands."""
    corners = np.array(list(product(*operands))).clip(-_FAR, _FAR).T
    assert op.definition is not None
    with np.errstate(all="ignore"):
        return bool(np.isnan(op.definition(*corners)).any())


def _over_time(op: Operator, operands: Sequence[Range], interval: Interval | None) -> Range:
    window: tuple[object, ...] = ()
    if op.bounds is not Bounds.NONE:
        window = _window(interval)
    assert op.definition is not None
    ends = [op.definition(*(np.full(_SAMPLES, each[k]) for each in operands), *window) for k in (0, 1)]
    return float(ends[0].min()), float(ends[1].max())


def _window(interval: Interval | None) -> tuple[int, int | None]:
    """Return the bounds of a window that is empty, cut and whole where that of an interval is, in few samples."""
    if interval is None:
        return 0, None
    begin = int(interval.begin > 0 or interval.begin_open)
    if interval.end is None:
        return begin, None
    return begin, begin + (interval.end > interval.begin)


# ---- analysis of a text --------------------------------------------------------------------------


class Decided:
    """The parts of a text that declared ranges decide: from their IDs to whether they always hold or never.

    ``guards``: the implications that are never triggered. ``branches``: the choices whose condition is decided.
    """

    def __init__(self, text: Text) -> None:
        self.ranges = {
            each.name: each.range for each in text.document.declarations if each.range not in (None, ANYTHING)
        }
        self.guards: list[Apply] = []
        self.branches: list[tuple[Apply, bool]] = []
        #: The outermost parts that are decided, and how.
        self.formulas: list[tuple[Apply, bool]] = []
        if self.ranges:
            self._find(text)

    def _find(self, text: Text) -> None:
        within = _Enclosed(self.ranges, lambda node: self._triggered_never(node, within))
        anywhere = _Enclosed({})
        covered: set[int] = set()
        found: list[tuple[Apply, bool]] = []
        for node in text.nodes:
            holds = _holds(within.of(node))
            if node.op.source is Source.BRANCH:
                condition = _holds(within.of(node.args[0]))
                if condition is not None and _holds(anywhere.of(node.args[0])) is None:
                    self.branches.append((node, condition))
                    covered.add(id(node.args[0]))
            if holds is not None and not is_number(node) and _holds(anywhere.of(node)) is None:
                found.append((node, holds))
                covered.update(map(id, node.args))
        covered.update(id(guard.args[0]) for guard in self.guards)
        self.formulas = [(node, holds) for node, holds in found if id(node) not in covered]

    def _triggered_never(self, node: Apply, within: _Enclosed) -> bool:
        """Return whether an implication is never triggered; its consequences are then not reported separately."""
        if node.op is not STL["implies"] or _holds(within.of(node.args[0])) is not False:
            return False
        if _holds(_Enclosed({}).of(node.args[0])) is not None:
            return False
        self.guards.append(node)
        return True

    def ranges_note(self, formula: Formula) -> str:
        """Return the declared ranges of the variables of a formula, for a message."""
        names = dict.fromkeys(node.name for node in postorder(formula) if isinstance(node, Var))
        ranges = [
            f"'{name}' is in {_format_range(self.ranges[name])}" for name in names if name in self.ranges
        ]
        return " and ".join(ranges)


def _holds(bounds: Range) -> bool | None:
    """Return the truth that bounds of a formula decide; None if they do not."""
    low, high = bounds
    return True if low > 0 else False if high < 0 else None


def _format_range(range_: Range) -> str:
    return f"[{number(range_[0])}, {number(range_[1])}]"


def always_holds(text: Text) -> Iterator[Found]:
    """``x <= 20`` for x in [0, 10]."""
    for node, holds in text.decided.formulas:
        if holds:
            yield Found(
                node.span, f"{text.written(node.span)} always holds, because {text.decided.ranges_note(node)}"
            )


def never_holds(text: Text) -> Iterator[Found]:
    """``x > 20`` for x in [0, 10]."""
    for node, holds in text.decided.formulas:
        if not holds:
            yield Found(
                node.span, f"{text.written(node.span)} never holds, because {text.decided.ranges_note(node)}"
            )


def never_triggered(text: Text) -> Iterator[Found]:
    """``x > 20 -> p`` for x in [0, 10]."""
    for node in text.decided.guards:
        guard = node.args[0]
        yield Found(
            guard.span,
            f"the implication is never triggered: {text.written(guard.span)} never holds, because "
            f"{text.decided.ranges_note(guard)}",
        )


def branch_never_taken(text: Text) -> Iterator[Found]:
    """``if x > 20 then y else z`` for x in [0, 10]."""
    for node, condition in text.decided.branches:
        dead, how = node.args[2 if condition else 1], "always" if condition else "never"
        yield Found(
            node.span,
            f"{text.written(dead.span)} is never reached: {text.written(node.args[0].span)} {how} holds, because "
            f"{text.decided.ranges_note(node.args[0])}",
        )
