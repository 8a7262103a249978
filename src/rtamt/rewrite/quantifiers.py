"""Quantifiers over the members of groups, resolved: ordinary formulas over the signals of the members.

``forall v in cars: φ`` is the conjunction of φ over the members that are present, ``exists`` the disjunction, and
``count`` the number of those for which φ holds. T_v is where v is present, and in φ every window, delay and held value
is cut to it, as if v had a trace of its own: what φ reads at an instant at which v is absent counts as what lies
outside the trace. So the operand of ``once`` is ``valid(v) and φ`` and that of ``historically`` is ``valid(v) -> φ``,
where ``valid(v)`` is a channel that is 1 where v is present and 0 where it is not. In a quantifier inside another one
both members must be present.
"""

from __future__ import annotations

from functools import reduce
from math import inf
from operator import is_not
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.language.document import groups_in
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, located
from rtamt.language.operators import STL, Operator, Sort, Tense
from rtamt.language.quantifiers import JOINS, FieldOf
from rtamt.language.records import Known
from rtamt.language.shares import ShareKind
from rtamt.language.unwritten import PRESENT, WHERE_PRESENT
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.rewrite.desugar import standing_for
from rtamt.rewrite.partial import may_fail
from rtamt.rewrite.presence import channel_of
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.document import Declaration, Document
    from rtamt.language.quantifiers import Binder


@dataclass(frozen=True, slots=True)
class Members:
    """The members of each group, by its name, and those members that are present throughout."""

    names: Mapping[str, tuple[str, ...]]
    throughout: frozenset[str] = frozenset()


def resolve(formula: Formula, members: Members) -> Formula:
    """Return the formula with each quantifier replaced by a formula over the members of its group.

    >>> from rtamt.language.quantifiers import Group
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> near = parse_formula("always exists v in cars: once(v.x > 3)", groups={"cars": Group("cars", "car_*")})
    >>> print(resolve(near, Members({"cars": ("car_1", "car_2")}, frozenset({"car_1"}))))
    always(once(car_1.x > 3) or valid(car_2) and once(valid(car_2) and car_2.x > 3))
    """
    return Scope(members).resolved(formula)


def resolved_document(
    document: Document, members: Members, declarations: tuple[Declaration, ...]
) -> Document:
    """Return the document over these members; ``declarations``: also of their fields.

    Formulas over other groups, which the selected requirement does not read, are left out.
    """
    scope, done = Scope(members), dict[int, Formula]()

    def formula(of: Formula) -> Formula:
        if id(of) not in done:
            done[id(of)] = scope.resolved(of)
        return done[id(of)]

    def known(of: Formula) -> bool:
        return groups_in(of).keys() <= members.names.keys()

    declared = {each.name: None for each in declarations if each.kind == "var"}
    types = {
        f"{member}.{each.name}": each.values
        for group in document.groups.values()
        for member in members.names.get(group.name, ())
        for each in group.fields
        if each.values is not None
    }
    return replace(
        document,
        assertions=tuple(
            replace(each, formula=formula(each.formula))
            for each in document.assertions
            if known(each.formula)
        ),
        requirements=tuple(replace(each, formula=formula(each.formula)) for each in document.requirements),
        definitions=MappingProxyType(
            {name: formula(each) for name, each in document.definitions.items() if known(each)}
        ),
        declarations=declarations,
        variables=tuple({**dict.fromkeys(document.variables), **declared}) if document.variables else (),
        types=MappingProxyType({**document.types, **types}),
        origin=None,
    )


@dataclass(frozen=True)
class Scope(Known):
    """The scope of quantifiers: the members bound to their variables, and where all of these are present."""

    members: Members
    bound: Mapping[str, str] = field(default_factory=dict)
    #: None where they are present throughout.
    present: Formula | None = None

    # ---- known operands --------------------------------------------------------------------------

    @property
    def now(self) -> Formula:
        """See :class:`Known`."""
        assert self.present is not None
        return self.present

    @property
    def begun(self) -> Formula:
        """See :class:`Known`."""
        return STL["once"](self.now)

    def before(self, interval: Interval | None) -> Formula:
        """See :class:`Known`."""
        return STL["s_prev"](self.now) if interval is None else STL["once"](self.now, interval=interval)

    # ---- formulas --------------------------------------------------------------------------------

    def resolved(self, formula: Formula) -> Formula:
        """Return a formula inside these quantifiers; shared nodes are resolved once."""
        done: dict[int, Formula] = {}
        #: What messages name: the same as if members were present throughout, with the quantifiers inside.
        plain: dict[int, Formula] = {}
        stack = [formula]
        while stack:
            node = stack[-1]
            args = node.args if isinstance(node, Apply) and node.op.binder is None else ()
            missing = [arg for arg in args if id(arg) not in done]
            if missing:
                stack += missing
                continue
            stack.pop()
            cut = tuple([done[id(arg)] for arg in args])
            made = self._step(node, cut)
            plain[id(node)] = node if isinstance(node, Apply) else made
            if isinstance(node, Apply) and args:
                uncut = tuple([plain[id(arg)] for arg in args])
                plain[id(node)] = made
                if self.present is not None or any(map(is_not, uncut, cut)):
                    plain[id(node)] = whole = rebuilt(node, uncut)
                    made = standing_for(whole, made, cut if self.present is None else (*cut, self.present))
            done[id(node)] = made
        return done[id(formula)]

    def _step(self, node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, FieldOf):
            return Var(f"{self.bound[node.variable]}.{node.field}", node.span, node.type)
        if not isinstance(node, Apply):
            return node
        if node.op.binder is not None:
            return self.over_members(node, node.op.binder)
        return rebuilt(node, args) if self.present is None else self._cut(node, args)

    def over_members(self, node: Apply, binder: Binder) -> Formula:
        """Return the expansion of a quantifier over all members."""
        (body,) = node.args
        inside = [self._inside(binder, member) for member in self.members.names[binder.group.name]]
        scopes = [scope for scope in inside if scope.keeps_apart(binder)]
        parts = [of_one(node, scope.newest(binder), scope.resolved(body)) for scope in scopes]
        join = JOINS[node.op.name]
        total = reduce(STL[join.formulas], parts) if parts else Const(join.none)
        return located(total, node.span)

    def _inside(self, binder: Binder, member: str) -> Scope:
        here = None if member in self.bound.values() else self._present(member)
        present = self.present if here is None else _conjunction(self.present, here)
        return Scope(self.members, {**self.bound, binder.variable: member}, present)

    def _present(self, member: str) -> Formula | None:
        return None if member in self.members.throughout else present_of(member)

    def newest(self, binder: Binder) -> Formula | None:
        """Return where the member of the innermost quantifier is present; None if throughout."""
        return self._present(self.bound[binder.variable])

    def keeps_apart(self, binder: Binder) -> bool:
        """Return whether variables that must be bound to different members are."""
        return all(self.bound[one] != self.bound[other] for one, other in binder.apart)

    # ---- cutting operators to where the members are present ----------------------------------------

    def _cut(self, node: Apply, args: tuple[Formula, ...]) -> Formula:
        """Return an operator that reads its operands only where all members are present."""
        op = node.op
        if op.tense is Tense.NONE:
            if op.definition is None and op.expansion is not None:
                return self._expand(node, args)
            return rebuilt(node, self._guard(op, args) if self._needs_guards(op, args) else args)
        rules = op.absent or op.guards
        if rules:
            assert len(rules) == len(args)
            cut = [self._count_absent(*each, node) for each in zip(args, rules, op.operands, strict=True)]
            return Apply(op, tuple(cut), node.interval, node.span)
        if op.pastified is not None:
            return located(op.pastified(args, node.interval, self), node.span)
        if op.expansion is not None:
            return self._expand(node, args)
        raise UsageError(
            f"'{op.spellings[0]}' reads other instants than its own and has no rule for absent members; "
            f"take it out of the quantifier"
        )

    def _expand(self, node: Apply, args: tuple[Formula, ...]) -> Formula:
        """Return the expansion of an operator over operands that are resolved already."""
        assert node.op.expansion is not None
        places = {id(arg): arg for arg in args}
        done: dict[int, Formula] = {}

        def cut(part: Formula) -> Formula:  # expansions are a few nodes deep
            if id(part) in places or not isinstance(part, Apply):
                return part
            if id(part) not in done:
                whole = Apply(part.op, part.args, part.interval, node.span)
                done[id(part)] = self._cut(whole, tuple(map(cut, part.args)))
            return done[id(part)]

        return cut(node.op.expansion(*args, node.interval))

    def _count_absent(self, operand: Formula, rule: str | None, sort: Sort, node: Apply) -> Formula:
        """Return an operand that counts as a rule says where a member is absent."""
        if node.op.share:
            assert node.interval is not None
            assert node.interval.share is not None
            rule = "implies" if node.interval.share.kind is ShareKind.PERCENT else "and"
        if rule is None:
            return operand
        if rule == "held":
            return Apply(STL["held"], (operand, self.now), None, operand.span)
        if sort is Sort.NUMBER:
            instead = {"zero": 0.0, "implies": inf, "and": -inf}[rule]
            return Apply(STL["if"], (self.now, operand, Const(instead)), None, operand.span)
        return _implies(self.present, operand) if rule == "implies" else _conjunction(self.present, operand)

    def _needs_guards(self, op: Operator, args: tuple[Formula, ...]) -> bool:
        """Return whether an operation on numbers may have no value where a member is absent, whose fields are 1."""
        return any(may_fail(op, tuple(_known(arg, member) for arg in args)) for member in self.absent())

    def absent(self) -> set[str | None]:
        """Return the members that may be absent."""
        return {member for member in self.bound.values() if member not in self.members.throughout}

    def _guard(self, op: Operator, args: tuple[Formula, ...]) -> tuple[Formula, ...]:
        """Return operands that are 1, 2, 3 where a member is absent: there, every operation has a value."""
        instead = [
            arg.value if isinstance(arg, Const) else float(position) for position, arg in enumerate(args, 1)
        ]
        constants = not may_fail(op, tuple(instead))  # numbers of the text may stay as they are
        return tuple(
            arg
            if constants and isinstance(arg, Const)
            else Apply(WHERE_PRESENT, (self.now, Const(float(position)), arg), None, arg.span)
            for position, arg in enumerate(args, 1)
        )


def _known(operand: Formula, absent: str | None) -> float | None:
    """Return the value of an operand where a member (None: everything) is absent, None if it may be any."""
    if isinstance(operand, Const):
        return operand.value
    own = isinstance(operand, Var) and (absent is None or operand.name.startswith(f"{absent}."))
    return 1.0 if own else None


def present_of(member: str) -> Formula:
    """Return the formula that is +inf where a member is present, else -inf."""
    return PRESENT(Var(channel_of(member), None, BOOLEAN))


def of_one(node: Apply, present: Formula | None, body: Formula) -> Formula:
    """Return the contribution of one member to a quantifier; ``present``: where it is present, None if throughout."""
    guard = STL[JOINS[node.op.name].guard]
    guarded = body if present is None else Apply(guard, (present, body), None, body.span)
    assert node.op.expansion is not None
    return node.op.expansion(guarded, None)


def _conjunction(present: Formula | None, formula: Formula) -> Formula:
    return formula if present is None else Apply(STL["and"], (present, formula), None, formula.span)


def _implies(present: Formula | None, formula: Formula) -> Formula:
    return formula if present is None else Apply(STL["implies"], (present, formula), None, formula.span)
