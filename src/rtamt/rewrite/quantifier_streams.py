"""Quantifiers over members that come and go: one formula for any member, and an outer one that reads the results.

The members of a stream are not known in advance, so each quantifier becomes a formula over one member, in which its
variable is the name of the member (``v.x``, ``valid(v)``), and a column of the outer formula: what the members give
together. A monitor runs the formula once for each member. Where that looks ahead by d, the column is known d later, and
the outer formula reads it d ahead.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Formula, Interval, Var, postorder
from rtamt.language.operators import STL, Sort, Tense
from rtamt.language.quantifiers import quantifiers
from rtamt.language.records import Bounds
from rtamt.language.unwritten import COLUMN, PRESENT
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.rewrite.check import check_online
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.quantifiers import Members, Scope, of_one
from rtamt.rewrite.semantics import boolean
from rtamt.rewrite.truth import read_as_conditions

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.quantifiers import Binder

#: The channel that is 1 until the stream ends, and 0 at the instants after it at which columns are still read.
RUNNING = "valid(stream)"


@dataclass(frozen=True, slots=True)
class Quantified:
    """A quantifier as monitors run it.

    ``formula``: over one member, whose robustness is what the member gives. ``column``: the name of the column of what
    all give together. ``lag``: after how many seconds it is known. ``keep``: for how many seconds a member that is gone
    still matters to what it gives when it returns; None: for ever. ``inside``: the quantifiers in it.
    """

    binder: Binder
    kind: str
    formula: Formula
    column: str
    lag: Fraction
    keep: Fraction | None
    inside: tuple[Quantified, ...]


class Splitting:
    """Formulas split at their quantifiers; equal quantifiers become one column."""

    def __init__(
        self,
        period: Fraction,
        applied: Callable[[Formula], Formula],
        text: str | None = None,
        *,
        held_at_end: bool = False,
        late: bool = True,
    ) -> None:
        self.period = period
        #: Whether signals hold their last values after the end, so that columns have values there.
        self.held_at_end = held_at_end
        #: Whether columns have each value when it is known, one lag late; else its bounds from the beginning.
        self.late = late
        self.applied = applied
        self.text = text
        #: The quantifiers that conditions read.
        self._conditions: set[Formula] = set()
        self._scope = _StreamScope(Members({}), splitting=self)

    def reads_truth(self, quantifier: Formula) -> bool:
        """Return whether some condition reads whether a quantifier holds."""
        return quantifier in self._conditions

    def outer(self, formulas: tuple[Formula, ...]) -> tuple[tuple[Formula, ...], tuple[Quantified, ...]]:
        """Return formulas over columns and their quantifiers, none of which is inside another one."""
        places = read_as_conditions(*formulas)
        self._conditions = {each for each in quantifiers(*formulas) if id(each) in places}
        found = tuple(map(self._scope.resolved, formulas))
        quantified = self._scope.found
        goes_on = self.late and not self.held_at_end  # after the end of the stream, columns are read
        if goes_on and any(each.lag for each in quantified):
            running = PRESENT(Var(RUNNING, None, BOOLEAN))
            scope = _StreamScope(Members({}), {}, running, self, quantified)
            found = tuple(map(scope.resolved, formulas))
        return tuple(map(self.applied, found)), tuple(quantified)


@dataclass(frozen=True)
class _StreamScope(Scope):
    """A scope whose quantifiers become columns."""

    splitting: Splitting | None = None
    found: list[Quantified] = field(default_factory=list)

    def over_members(self, node: Apply, binder: Binder) -> Formula:
        """Return the formula that reads the column of a quantifier."""
        assert self.splitting is not None
        (body,) = node.args
        inner = _StreamScope(
            self.members,
            {**self.bound, binder.variable: binder.variable},
            self._with(binder.variable),
            self.splitting,
        )
        given = of_one(node, inner.newest(binder), inner.resolved(body))
        if node.op.result is Sort.NUMBER:  # its condition is read as true or false under every semantics
            return self._column(node, binder, given, inner)
        value = holds = self._column(node, binder, self.splitting.applied(given), inner)
        if self.splitting.reads_truth(node):
            holds = self._column(node, binder, boolean(given), inner)
        return COLUMN(value, holds)

    def _column(self, node: Apply, binder: Binder, given: Formula, inner: _StreamScope) -> Formula:
        """Return the formula that reads the column of the members' values."""
        assert self.splitting is not None
        period = self.splitting.period
        inside = tuple(inner.found)
        # Names of columns repeat: equal formulas may read different quantifiers inside.
        same = (binder, node.op.name, given, inside)
        known = next(
            (each for each in self.found if (each.binder, each.kind, each.formula, each.inside) == same), None
        )
        if known is None:
            check_online(given, self.splitting.text, group=binder.group.name)
            lag = horizon(given, period)
            assert lag is not None
            name = f"{node.op.name} {binder.variable} #{len(self.found) + 1}"
            keep = _keep(_past(desugar(given), period), inner.found)
            known = Quantified(binder, node.op.name, given, name, lag, keep, inside)
            self.found.append(known)
        column = Var(known.column, node.span)
        if not known.lag or not self.splitting.late:
            return column
        interval = Interval(known.lag, known.lag, "s", "s", implied=True)
        return Apply(STL["ahead"], (column,), interval, node.span)

    def _with(self, variable: str) -> Formula:
        here = PRESENT(Var(f"valid({variable})", None, BOOLEAN))
        return here if self.present is None or not self.bound else STL["and"](self.present, here)

    def newest(self, binder: Binder) -> Formula:
        """Return where the member of the innermost quantifier is present."""
        return PRESENT(Var(f"valid({binder.variable})", None, BOOLEAN))

    def absent(self) -> set[str | None]:
        """Return the variables whose members may be absent; None: everything, after the end of the stream."""
        return set(self.bound) or {None}


def _keep(past: Fraction | None, inside: list[Quantified]) -> Fraction | None:
    """Return how long an absent member matters, including for the quantifiers inside."""
    known = [each.keep + each.lag for each in inside if each.keep is not None]
    return None if past is None or len(known) < len(inside) else past + max(known, default=Fraction(0))


def _past(core: Formula, period: Fraction) -> Fraction | None:
    """Return how far behind a core formula reads at most, the sum over nested operators; None: without bound."""
    found: dict[int, Fraction | None] = {}
    for node in postorder(core):
        below: list[Fraction | None] = []
        own: Fraction | None = Fraction(0)
        if isinstance(node, Apply):
            below = [found[id(arg)] for arg in node.args]
            if node.op.tense is not Tense.NONE:
                if node.interval is not None:
                    own = node.interval.end
                elif node.op.bounds is Bounds.NONE and node.op.reach is not None:
                    own = node.op.reach * period
                else:
                    own = period if node.op.bounds is Bounds.DURATION else None
        known = [each for each in below if each is not None]
        unbounded = own is None or len(known) < len(below)
        found[id(node)] = None if unbounded else (own or Fraction(0)) + max(known, default=Fraction(0))
    return found[id(core)]
