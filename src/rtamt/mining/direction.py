"""Whether a parameter makes a requirement easier or harder to satisfy, by its formula.

The verdict is monotone in a parameter if every operator between the parameter and the verdict is. That is known for
the pointwise operators from the operator table (``slopes``), and for the kernels of temporal operators from their
definitions: a minimum or maximum over a window is nondecreasing in its operand, and a longer window can only lower a
minimum and raise a maximum. Whatever else is on the way makes the direction unknown.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import BoundError, UsageError, choices
from rtamt.language.formula import Apply, Const, Formula, Parameter, fold, postorder
from rtamt.language.operators import Ahead, Pointwise, Rank, Shift, Since, Sum, Tense, Until, Window
from rtamt.language.parameters import bounding
from rtamt.language.units.durations import UNITS, exact
from rtamt.language.value_types import WHOLE
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.semantics import boolean

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.language.formula import Interval
    from rtamt.specification import Specification

#: Kernels that are nondecreasing in every operand.
_MONOTONE = (Window, Rank, Sum, Shift, Ahead, Since, Until)


@dataclass(frozen=True)
class Role:
    """The role of a parameter in a formula.

    ``direction``: 1 if larger values are easier to satisfy, -1 if smaller ones are, None if that is unknown.
    ``bound``: whether it bounds an interval; then ``seconds`` is how long one unit of it is. ``begins``: of each
    interval that it ends, the begin and how many of the two bounds are excluded; ``ends``: of each that it begins, the
    end likewise. ``whole``: whether it is declared as a whole number.
    """

    name: str
    direction: int | None
    bound: bool = False
    whole: bool = False
    seconds: Fraction = Fraction(1)
    begins: tuple[tuple[Fraction, int], ...] = ()
    ends: tuple[tuple[Fraction, int], ...] = ()

    def least(self, tick: Fraction) -> Fraction:
        """Return the least value with which no interval is empty; an excluded bound is a tick away."""
        return max(((begin + tick * out) / self.seconds for begin, out in self.begins), default=Fraction(0))

    def most(self, tick: Fraction) -> Fraction | None:
        """Return the greatest value for which no interval is empty; None if there is none."""
        return min(((end - tick * out) / self.seconds for end, out in self.ends), default=None)


def directions(
    spec: Specification, ranges: Mapping[str, tuple[float, float]] | None = None
) -> dict[str, str]:
    """Return for each parameter in the formula which values are easier to satisfy.

    ``"larger"``: whatever satisfies the specification still does with a larger value; ``"smaller"``: with a smaller
    one; ``"unknown"``: neither follows from the formula. ``ranges``: from a parameter to its least and
    greatest value, which decides the sign of factors.

    >>> import rtamt
    >>> spec = rtamt.parse('''
    ...     parameter float limit = 3  parameter float within = 2  parameter float level = 1
    ...     always(x > limit -> eventually[0:within](y >= level)) and abs(level) > 0''')
    >>> directions(spec)
    {'limit': 'larger', 'within': 'larger', 'level': 'unknown'}
    """
    named = {1: "larger", -1: "smaller", None: "unknown"}
    chosen = [name for name in spec.parameters if name in used_parameters(spec)]
    return {role.name: named[role.direction] for role in roles_of(spec, chosen, ranges or {})}


def used_parameters(spec: Specification) -> frozenset[str]:
    """Return the parameters that occur in the formula of a specification."""
    found: set[str] = set()
    for node in postorder(spec.formula):
        if isinstance(node, Parameter):
            found.add(node.name)
        elif isinstance(node, Apply) and node.interval is not None:
            found.update(name for name in node.interval.constants if name in spec.parameters)
    return frozenset(found)


def roles_of(
    spec: Specification, names: Iterable[str], ranges: Mapping[str, tuple[float, float]]
) -> list[Role]:
    """Return the roles of parameters that are in the formula of a specification."""
    bounds, unknown = _bounds(spec, names), set()
    sides: dict[int, list[_Side]] = {}
    truth = boolean(spec.formula)
    for name, every in bounds.items():
        for side in every:
            sides.setdefault(id(side.interval), []).append(side)
            if not side.monotone:
                unknown.add(name)
    for every in sides.values():
        if len({side.name for side in every}) > 1:
            first, second = sorted({side.name for side in every})
            raise UsageError(
                f"'{first}' and '{second}' bound the same interval; mine one of them, with a value for the other"
            )
    core = desugar(truth)
    kept = {id(node.interval) for node in postorder(core) if isinstance(node, Apply)}
    for place, every in sides.items():
        if place not in kept:  # an expansion made another interval of it
            unknown.update(side.name for side in every)
    found = _fold(core, frozenset(names), ranges, sides)
    types = {each.name: each.type for each in spec.document.declarations}
    return [
        _role(name, None if name in unknown else found.get(name), bounds.get(name, []), types.get(name, ""))
        for name in names
    ]


@dataclass(frozen=True)
class _Side:
    """An interval that a parameter bounds: at its end or begin, in what unit."""

    name: str
    interval: Interval
    end: bool
    seconds: Fraction
    direction: int | None

    @property
    def monotone(self) -> bool:
        return self.direction is not None

    @property
    def excluded(self) -> int:
        """The number of open bounds of the interval."""
        return self.interval.begin_open + self.interval.end_open


def _role(name: str, direction: int | None, sides: list[_Side], type_: str) -> Role:
    whole = type_ in WHOLE
    if not sides:
        return Role(name, direction, whole=whole)
    seconds = sides[0].seconds
    if any(side.seconds != seconds for side in sides):
        raise UsageError(
            f"'{name}' bounds intervals in different units; "
            f"declare it with a unit, such as parameter float {name} = 1 [s]"
        )
    intervals = [(side.interval, side.end, side.excluded) for side in sides]
    return Role(
        name,
        direction,
        bound=True,
        whole=whole,
        seconds=seconds,
        begins=tuple((interval.begin, out) for interval, end, out in intervals if end),
        ends=tuple(
            (interval.end, out) for interval, end, out in intervals if not end and interval.end is not None
        ),
    )


def _bounds(spec: Specification, names: Iterable[str]) -> dict[str, list[_Side]]:
    """Return the intervals that each parameter bounds, found by giving it another value."""
    found: dict[str, list[_Side]] = {}
    for name in names:
        if name not in bounding(spec.document):
            continue
        other, value = _move_parameter(spec, name)
        change = exact(str(value)) - exact(str(spec.parameters[name]))
        every: list[_Side] = []
        for old, new in zip(postorder(spec.formula), postorder(other.formula), strict=True):
            if isinstance(old, Apply) and isinstance(new, Apply) and old.interval is not None:
                side = _side(name, old, new.interval, change)
                if side is not None:
                    every.append(side)
        found[name] = every
    return found


def _side(name: str, node: Apply, other: Interval | None, change: Fraction) -> _Side | None:
    """Return which bound of the interval of a node changed with a parameter; None if none did."""
    mine = node.interval
    assert mine is not None
    if other is None or (mine.begin, mine.end, mine.share) == (other.begin, other.end, other.share):
        return None
    begins = mine.begin != other.begin
    ends = mine.end is not None and other.end is not None and mine.end != other.end
    old, new = (mine.end, other.end) if ends else (mine.begin, other.begin)
    assert old is not None
    assert new is not None
    direction = None if begins == ends or mine.share != other.share else _of_window(node, end=ends)
    return _Side(name, mine, ends, (new - old) / change, direction)


def _of_window(node: Apply, *, end: bool) -> int | None:
    """Return in which direction the value of a node moves with a bound of its window; None if that is unknown."""
    kernel, sign = node.op.kernel, 1 if end else -1
    if node.op.expansion is not None:
        return None
    if isinstance(kernel, Window):
        return sign if kernel.reduce == "max" else -sign
    if isinstance(kernel, Since) or (isinstance(kernel, Until) and node.op.tense is Tense.FUTURE):
        return sign
    return None


def _move_parameter(spec: Specification, name: str) -> tuple[Specification, float]:
    """Return the specification with another value of a parameter that bounds an interval, and the value."""
    value, step = spec.parameters[name], spec.period or Fraction(1)
    tried = [2 * value, 0.0, *(float(step / unit) for unit in UNITS.values())]
    failure: BoundError | None = None
    for other in tried:
        if other != value:
            try:
                return spec.with_parameters(**{name: other}), other
            except BoundError as error:
                failure = error
    assert failure is not None
    raise failure


# ---- over the formula ----------------------------------------------------------------------------


def _fold(
    core: Formula,
    names: frozenset[str],
    ranges: Mapping[str, tuple[float, float]],
    sides: Mapping[int, list[_Side]],
) -> dict[str, int | None]:
    """Return for each parameter in a formula of core operators in which direction its value moves."""
    constants = _constants(core, names, ranges)

    def step(node: Formula, below: tuple[dict[str, int | None], ...]) -> dict[str, int | None]:
        if isinstance(node, Parameter) and node.name in names:
            return {node.name: 1}
        if not isinstance(node, Apply):
            return {}
        found: dict[str, int | None] = {}
        for move, operand in zip(_moves(node, constants), below, strict=True):
            for name, direction in operand.items():
                _join(found, name, direction * move if direction and move else None)
        for side in sides.get(id(node.interval), ()) if node.interval is not None else ():
            _join(found, side.name, side.direction)
        return found

    return fold(core, step)


def _join(found: dict[str, int | None], name: str, direction: int | None) -> None:
    found[name] = direction if found.get(name, direction) == direction else None


def _moves(node: Apply, constants: Mapping[int, float]) -> tuple[int | None, ...]:
    """Return in which direction the value of a node moves with each operand; None or 0 if that is unknown."""
    op = node.op
    if isinstance(op.kernel, _MONOTONE):
        return (1,) * len(node.args)
    if not isinstance(op.kernel, Pointwise) or op.slopes is None:
        return (None,) * len(node.args)
    return op.slopes(*(constants.get(id(operand)) for operand in node.args))


def _constants(
    core: Formula, names: frozenset[str], ranges: Mapping[str, tuple[float, float]]
) -> dict[int, float]:
    """Return the values of constant parts; of a parameter with a range of one sign, a value of that sign."""
    found: dict[int, float] = {}
    fixed: set[int] = set()
    for node in postorder(core):
        if isinstance(node, Parameter) and node.name in names:
            low, high = ranges.get(node.name, (-1.0, 1.0))
            if low >= 0 or high <= 0:
                found[id(node)] = high if low >= 0 else low
        elif isinstance(node, Const):
            found[id(node)] = node.value
            fixed.add(id(node))
        elif (
            isinstance(node, Apply)
            and node.op.extension is not None
            and all(id(each) in fixed for each in node.args)
        ):
            assert node.op.definition is not None
            found[id(node)] = float(
                node.op.definition(*(np.array([found[id(each)]]) for each in node.args))[0]
            )
            fixed.add(id(node))
    return found


def require(spec: Specification, names: Iterable[str] | None) -> tuple[str, ...]:
    """Return the parameters to mine, in the given order; by default those in the formula."""
    known, there = tuple(spec.parameters), used_parameters(spec)
    if not known:
        raise UsageError(
            "the specification declares no parameter to mine; declare one, such as parameter float limit = 30"
        )
    numbers = [name for name in known if name in there and name not in spec.document.types]
    chosen = tuple(dict.fromkeys(names)) if names is not None else tuple(numbers)
    for name in chosen:
        if name not in known:
            raise UsageError(f"there is no parameter '{name}'{choices(name, known, 'parameters')}")
        if name not in there:
            raise UsageError(
                f"the parameter '{name}' is not in the formula, so every value is the same; leave it out"
            )
        if name in spec.document.types:
            raise UsageError(f"the parameter '{name}' is no number, so it has no tight value; leave it out")
    if not chosen:
        raise UsageError(
            "no parameter in the formula of the specification is a number, so there is nothing to mine"
        )
    return chosen
