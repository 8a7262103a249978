"""Checks of well-formed formulas before evaluation: bounds, time domain, boundedness."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

from rtamt.errors import BoundError, SpecificationError
from rtamt.language.contents import contents, timed
from rtamt.language.formula import Apply, Const, Formula, Interval, children, postorder
from rtamt.language.operators import STL, Bounds, Pointwise, Sum, Tense
from rtamt.language.units.durations import format_duration
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.ground import closed

if TYPE_CHECKING:
    from rtamt.language.operators import Operator


@dataclass(frozen=True, slots=True)
class BoundUnit:
    """The unit in which a time domain counts bounds: its name in messages, and the largest count.

    ``continuous``: whether signals have values between the steps. ``setting``: the setting that gives the length of
    a step. ``steps``: the plural. ``longer`` and ``finer``: the setting that reduces or increases their number.
    ``most``: the longest bound. ``farthest``: the longest sum of bounds of nested operators; None where sums of
    the longest bounds fit into an int64.
    """

    setting: str
    steps: str
    longer: str
    finer: str
    continuous: bool
    most: int
    farthest: int | None

    @property
    def step(self) -> str:
        """The singular of ``steps``."""
        return self.steps[:-1]

    @property
    def contents(self) -> str:
        """The elements of a window."""
        return self.steps if self.continuous else "samples"

    def size(self, window: Interval, step: Fraction) -> int:
        """Return the number of ticks or samples of a closed window; it has a sample at both ends."""
        assert window.end is not None
        return int((window.end - window.begin) / step) + (not self.continuous)


#: The largest number of steps of a window of which a share is taken: doubles count them.
MOST_RANKED = 2**53

#: Sampling periods, between the samples of discrete time.
PERIODS = BoundUnit("sampling period", "periods", "a longer period", "shorter period", False, 2**44, None)
#: Ticks; the sum of bounds is limited because it is added to timestamps.
TICKS = BoundUnit("resolution", "ticks", "a coarser resolution", "finer resolution", True, 2**56, 2**61)


def check_bounds(
    formula: Formula, step: Fraction, text: str | None = None, unit: BoundUnit = PERIODS
) -> None:
    """Raise :class:`BoundError` unless every bound is an integer multiple of ``step`` seconds; ``unit`` names the step.

    A half-open interval must contain at least one of these.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> check_bounds(parse_formula("always[0:1] x"), Fraction(1, 10))
    """
    #: The steps of bounds, by identity: most intervals of a text share a few bounds.
    known: dict[int, int] = {}
    for node in timed(spelled_out(formula)):
        interval = node.interval
        assert interval is not None
        begin, end = interval.begin, interval.end
        first = known.get(id(begin))
        if first is None:
            first = known[id(begin)] = _count_steps(begin, step, text, unit, node)
        if end is not None:
            last = known.get(id(end))
            if last is None:
                last = known[id(end)] = _count_steps(end, step, text, unit, node)
            if last - interval.end_open < first + interval.begin_open:
                from rtamt.language.printing.printer import interval_text

                raise BoundError(
                    f"the interval {interval_text(interval)} is empty: with a {unit.setting} of "
                    f"{format_duration(step)} no {unit.step} lies in it; close a bound, or choose a {unit.finer}",
                    text,
                    interval.span or node.span,
                )
        if node.op.share:
            _check_share(closed(interval, step), step, text, unit)
    if unit.farthest is not None:
        _check_sums(spelled_out(formula), step, text, unit, unit.farthest)


def _count_steps(bound: Fraction, step: Fraction, text: str | None, unit: BoundUnit, node: Apply) -> int:
    """Return a bound of a node in steps; raise :class:`BoundError` if it is no multiple of them, or too large."""
    a, b = step.as_integer_ratio()
    c, d = bound.as_integer_ratio()
    count, rest = divmod(c * b, d * a)  # a division of fractions costs ten times as much
    assert node.interval is not None
    if rest != 0:
        raise BoundError(
            f"The operator bound must be a multiple of the {unit.setting}: "
            f"{format_duration(bound)} is not a whole number of {unit.steps} of {format_duration(step)}; "
            f"change the bound or the {unit.step}",
            text,
            node.interval.span or node.span,
        )
    if count > unit.most:
        raise BoundError(
            f"{format_duration(bound)} is {_short(count)} {unit.steps} of {format_duration(step)}, "
            f"more than can be counted; shorten the bound, leave it open with inf, or choose {unit.longer}",
            text,
            node.interval.span or node.span,
        )
    return count


def _check_share(interval: Interval, step: Fraction, text: str | None, unit: BoundUnit) -> None:
    """Raise :class:`BoundError` at a share that is not a number of steps of its window."""
    from rtamt.language.printing.printer import interval_text
    from rtamt.language.shares import ShareKind, rank_of

    share = interval.share
    assert share is not None
    nominal = unit.size(interval, step)
    window = f"the window {interval_text(interval)}"
    if unit.continuous and share.kind is ShareKind.SAMPLES:
        reason = "a number of samples is a share in discrete time only; write a duration, such as 3s, or 80%"
    elif share.kind is ShareKind.DURATION and (share.amount / step).denominator != 1:
        reason = (
            f"the share {share.text()} is not a whole number of {unit.steps} of {format_duration(step)}; "
            f"change it or the {unit.step}"
        )
    elif nominal == 0:
        reason = f"{window} is an instant, which has no share in dense time; make it longer"
    elif nominal > MOST_RANKED:
        reason = (
            f"{window} is {_short(nominal)} {unit.steps} long, more than a share is counted in; shorten it"
        )
    elif rank_of(interval, step, continuous=unit.continuous).k > nominal:
        reason = (
            f"{window} has {nominal} {unit.contents}, fewer than the share "
            f"{share.text()} of it; make the window longer or the share smaller"
        )
    else:
        return
    raise BoundError(reason, text, share.span)


def _short(count: int) -> str:
    """Return a number, which may exceed the range of a double, with three digits."""
    return f"{float(count):.3g}" if count < 10**300 else f"{Decimal(count):.3g}"


def _check_sums(formula: Formula, step: Fraction, text: str | None, unit: BoundUnit, farthest: int) -> None:
    """Raise :class:`BoundError` at an operator whose bounds, added to those of its operands, are too large."""
    reach: dict[int, Fraction] = {}
    none, limit = Fraction(0), farthest * step
    for node in postorder(formula):
        far = none
        for operand in children(node):
            if reach[id(operand)] is not far:  # fractions are slow to compare
                far = max(far, reach[id(operand)])
        if isinstance(node, Apply) and node.interval is not None:
            far += node.interval.begin if node.interval.end is None else node.interval.end
            if far > limit:
                raise BoundError(
                    f"the bounds from here inwards add up to {format_duration(far)}, {_short(int(far / step))} "
                    f"{unit.steps} of {format_duration(step)}, more than can be counted; shorten them, or choose "
                    f"{unit.longer}",
                    text,
                    node.interval.span or node.span,
                )
        reach[id(node)] = far


def check_online(formula: Formula, text: str | None = None, *, group: str | None = None) -> None:
    """Raise :class:`BoundError` at the first operator with an unbounded future, which is never known online.

    ``group``: of the members over which the formula is quantified.
    """
    node = unbounded_future(formula)
    if node is not None:
        verdicts = "monitor its bounds or verdicts (verdict='interval', 'eager')"
        known = f"name the members, which must be present throughout: spec.over({{'{group}': [...]}}), and {verdicts}"
        raise BoundError(
            f"'{node.op.name}' without an upper bound needs the whole future{' of each member' if group else ''} "
            f"and cannot be monitored online; give it a bound, such as {node.op.name}[0:10], evaluate the finished "
            f"trace offline, or {known if group else verdicts}",
            text,
            node.span,
        )


def check_dense(formula: Formula, text: str | None = None, *, ticks: bool = True) -> None:
    """Raise :class:`SpecificationError` at the first operator that is defined only in discrete time.

    ``ticks``: whether an operator may read one tick behind.
    """
    for node in postorder(formula):
        if isinstance(node, Apply) and node.op.bounds is Bounds.DURATION and node.interval is None:
            raise SpecificationError(
                f"'{node.op.name}' without a duration means one sampling period, which dense time does not have; "
                f"write one, such as {node.op.name}[1s](...)",
                text,
                node.span,
            )
    for node in postorder(spelled_out(formula)):
        if isinstance(node, Apply) and (node.op.discrete_only or (node.op.one_tick and not ticks)):
            why = node.op.why_discrete or (
                "means one sample away, which dense time does not have; use a window such as once[0:1]"
            )
            raise SpecificationError(
                f"'{node.op.name}' {why}, or discrete time",
                text,
                node.span,
            )


def unbounded_future(formula: Formula) -> Apply | None:
    """Return the first (innermost, leftmost) operator that reads an unbounded future, or None."""
    formula = spelled_out(formula)
    untimed = any(map(_is_unbounded_without_interval, contents(formula).untimed))
    if not untimed and not any(map(reads_unbounded_future, timed(formula))):
        return None
    for node in postorder(formula):
        if isinstance(node, Apply) and reads_unbounded_future(node):
            return node
    return None


def reads_unbounded_future(node: Apply) -> bool:
    """Return whether this operator itself, whatever its operands, reads an unbounded future."""
    op = node.op
    if node.interval is None or op.bounds is Bounds.NONE:
        return _is_unbounded_without_interval(op)
    return node.interval.end is None and op.tense is Tense.FUTURE and op.bounds is not Bounds.DURATION


def _is_unbounded_without_interval(op: Operator) -> bool:
    if op.tense is not Tense.FUTURE:
        return False
    return op.reach is None if op.bounds is Bounds.NONE else op.bounds is not Bounds.DURATION


def has_future(formula: Formula) -> bool:
    """Return whether any operator of the formula reads the future."""
    return any(isinstance(n, Apply) and n.op.tense is Tense.FUTURE for n in postorder(spelled_out(formula)))


def always_has_a_value(formula: Formula) -> bool:
    """Return whether the formula has a value on every trace: no operation in it can yield NaN or fail."""
    for node in postorder(formula):
        if not isinstance(node, Apply):
            continue
        kernel = node.op.kernel
        partial = isinstance(kernel, Sum) or (isinstance(kernel, Pointwise) and kernel.partial)
        if partial or STL.get(node.op.name) is not node.op:
            return False
        # A predicate is a difference, and inf - inf is undefined.
        if node.op.truth is not None and not any(isinstance(arg, Const) for arg in node.args):
            return False
    return True
