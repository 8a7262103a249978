"""Formulas to instructions.

One function per kernel shape of the operator table, and a call for every operator without a kernel; no operator is
named here. Instructions are numbered, and operands aligned, in ``emission.py``. Time is counted in steps: samples, or
ticks where signals have values between samples; what differs between the two is in ``time_lowering.py``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from fractions import Fraction
from math import inf

from rtamt.compiler.emission import Emission
from rtamt.compiler.order import Orders, is_derived
from rtamt.compiler.places import Deferred, Origins
from rtamt.compiler.program import CODES, NO_OPERAND, CallSite, Program
from rtamt.language.formula import Apply, Const, Formula, Parameter, Var, postorder
from rtamt.language.lazy_modules import shares
from rtamt.language.operators import Ahead, Bounds, Pointwise, Rank, Shift, Since, Sum, Tense, Until, Window
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rtamt.signals.time_domain_interface import TimeDomain

#: Those of windows of bounded length.
_SLIDES = {reduce: CODES[f"slide_{reduce}"] for reduce in ("max", "min", "sum")}
_IDENTITY = {"max": -inf, "min": inf}

#: Looking up a member of an enumeration takes as long as the rest of an instruction.
_PAST = Tense.PAST


def seconds_per_step(step: Fraction) -> tuple[tuple[str, float], ...]:
    """Return the operations, each with a number, that make seconds of a count of steps.

    One product if the step is a double; else n/d are two operations, which for counts round once.
    """
    if Fraction(float(step)) == step:
        return (("mul", float(step)),)
    return ("mul", float(step.numerator)), ("div", float(step.denominator))


class Lowering(Emission, ABC):
    """Emits the instructions of formulas."""

    #: The width of the window [0, 0].
    point: int

    def __init__(
        self,
        domain: type[TimeDomain],
        period: Fraction,
        inputs: tuple[str, ...],
        clip: int | None,
    ) -> None:
        super().__init__(inputs)
        self.domain = domain
        self.period = period
        self.ratio = period.as_integer_ratio()
        self.clip = clip
        self.formulas: tuple[Formula, ...] = ()
        #: The index of each operator's node, by its identity.
        self.found: dict[int, int] = {}
        #: Bounds, and their steps, by identity: most intervals of a text share a few bounds.
        self.counts: dict[int, tuple[Fraction, int]] = {}
        self.orders = Orders()
        self.calls: dict[CallSite, int] = {}
        #: Whether an instruction has a smaller lag than the horizon of its formula.
        self.known_early = False

    @property
    def expanded(self) -> bool:
        """Whether an operator of the formulas has been expanded."""
        return any(map(is_derived, self.orders))

    def program(self, outputs: tuple[int, ...], cores: Callable[[], Lowering]) -> Program:
        """Return the program; instructions that no output needs are kept, since they may fail or be queried.

        ``cores``: the lowering of the formulas in core operators.
        """
        return Program(
            tuple(self.records),
            self.inputs,
            outputs,
            self.period,
            Deferred(lambda: cores().places_of_nodes()),
            Origins(lambda: cores().origins),
            self.domain,
            tuple(self.calls),
            parametric={place: parameter.name for parameter, place in self.parameters.items()},
        )

    def places_of_nodes(self) -> Iterator[tuple[Formula, int]]:
        """Yield the nodes of the formulas, and the instruction of each."""
        for node in postorder(*self.formulas):
            yield node, self.found[id(node)] if isinstance(node, Apply) else self.leaf(node)

    def lower(self, formulas: Sequence[Formula]) -> list[int]:
        """Emit the instructions of formulas, operands first, and return the index of each formula's last one.

        Operators that are expanded and have a recipe are expanded here: the instructions and their order are those of
        the expansion. Others must have been expanded before.
        """
        self.formulas = tuple(formulas)
        return [self._lower(formula) for formula in formulas]

    def _lower(self, formula: Formula) -> int:
        """Emit the instructions of a formula and of what is below it, and return the index of its own."""
        # By identity, since hashing formulas takes as long as lowering them: equal ones have the same instructions.
        found, orders, variables, constants = self.found, self.orders, self.variables, self.constants
        pointwise, leaf = self.pointwise, self.leaf
        opened: list[Apply] = []  # the operators whose result is still to come
        values: list[int] = []
        todo: list[Any] = [formula]  # nodes and steps over their values, the next one last
        while todo:
            item = todo.pop()
            kind = item.__class__
            if kind is tuple:
                code, count, core, last = item
                if code is None:
                    node = opened[-1] if core is None else core
                    first = len(values) - count
                    place = self._lower_node(node, values[first:])
                    values[first:] = (place,)
                else:  # most
                    b = values.pop() if count == 2 else NO_OPERAND
                    values[-1] = place = pointwise(code, opened[-1], values[-1], b)
                if last:
                    found[id(opened.pop())] = place
                continue
            if kind is Apply:
                known = found.get(id(item))
                if known is None:
                    args = item.args
                    pair, order = orders[item.op]
                    if pair is not None:  # over leaves, as most predicates are, there is nothing to align
                        code, first, last = pair
                        a, b = args[first], args[last]
                        if a.__class__ is not Apply and b.__class__ is not Apply:
                            place = found[id(item)] = pointwise(code, item, leaf(a), leaf(b))
                            values.append(place)
                            continue
                    opened.append(item)
                    if order is None:
                        todo += (None, len(args), None, True), *args[::-1]
                    else:
                        todo += [args[each] if each.__class__ is int else each for each in order]
                    continue
            elif kind is Var:
                known = variables.get(item.name)  # most occur several times
            else:
                known = constants.get(item.value) if kind is Const else None  # no parameter
            values.append(leaf(item) if known is None else known)
        return values[0]

    def _lower_node(self, node: Formula, args: list[int]) -> int:
        """Return the index of an operator over operands that need not be aligned, or of a constant of a recipe."""
        if not isinstance(node, Apply):
            return self.leaf(node)
        kernel = node.op.kernel
        if isinstance(kernel, Window):  # most
            return self.window(node, kernel, args[0])
        args = self.align(args)
        if isinstance(kernel, Pointwise):
            return self.pointwise(CODES[kernel.opcode], node, *args)
        if isinstance(kernel, Sum):
            return self.sum(node, args[0])
        if isinstance(kernel, Rank):
            return self.rank(node, args[0])
        if isinstance(kernel, Shift):
            return self.shift_by_one(node, kernel, args[0])
        if isinstance(kernel, Ahead):
            return self.ahead_of(node, args[0])
        if isinstance(kernel, Since):
            return self.since(node, *args)
        if isinstance(kernel, Until):
            return self.until(node, *args)
        return self.call(node, args)

    # ---- intervals in steps ------------------------------------------------------------------------

    def whole(self, bound: Fraction) -> int:
        """Return a bound in steps."""
        a, b = bound.as_integer_ratio()
        c, d = self.ratio  # a division of fractions costs ten times as much
        count, rest = divmod(a * d, b * c)
        assert rest == 0, "bounds are checked before compilation"
        return count

    def count(self, bound: Fraction) -> int:
        """Return a bound of the formulas in steps."""
        known = self.counts.get(id(bound))
        if known is None:
            known = self.counts[id(bound)] = bound, self.whole(bound)
        return known[1]

    def steps(self, bound: Fraction) -> int:
        """Return a bound in steps, clipped to the length of the trace."""
        count = self.whole(bound)
        return count if self.clip is None else min(count, self.clip)

    def bounds(self, node: Apply) -> tuple[int, int | None]:
        """Return the interval of an operator in steps; no interval is [0, inf)."""
        if node.interval is None:
            return 0, None
        begin, end = node.interval.begin, node.interval.end
        if self.clip is None:
            return self.count(begin), None if end is None else self.count(end)
        # The length is clipped, not the end: precedes reads up to the end, in a window of this length.
        first = self.steps(begin)
        return first, None if end is None else first + self.steps(end - begin)

    # ---- one function for each shape of kernel -----------------------------------------------------

    def window(self, node: Apply, kernel: Window, x: int) -> int:
        """Lower the largest or smallest value in a window."""
        begin, end = self.bounds(node)
        lag = self.lags[x]
        if node.op.tense is _PAST:
            if end is None:
                x = self.add(f"run_{kernel.reduce}", node, x, lag=lag)
            else:
                x = self.extremum(kernel.reduce, x, end - begin + self.point, lag, node)
            return self.moved(x, begin, _IDENTITY[kernel.reduce], lag, node) if begin else x
        assert end is not None, "unbounded future is cut off before"
        if end == 0:
            return x
        if begin == end:
            return self.moved(x, 0, _IDENTITY[kernel.reduce], lag + end, node)
        return self.extremum(kernel.reduce, x, end - begin + self.point, lag + end, node)

    def rank(self, node: Apply, x: int) -> int:
        """Lower the k-th largest value in a window, whose values outside the trace count as the same infinity."""
        begin, end = self.bounds(node)
        assert node.interval is not None
        assert node.interval.end is not None
        assert end is not None
        k, outside = shares.rank_of(node.interval, self.period, continuous=self.point == 0)
        # Counted from the other end, infinite values outside need not be counted.
        reduce = "min" if outside > 0 else "max"
        nominal = self.whole(node.interval.end - node.interval.begin) + self.point
        order = nominal - k + 1 if outside > 0 else k
        width = end - begin + self.point
        past = node.op.tense is Tense.PAST
        lag = self.lags[x] + (0 if past else end)
        if order == 1 and (self.point or outside > 0):
            if width == self.point and not past:
                return self.moved(x, 0, outside, lag, node) if end else x
            x = self.slide(reduce, x, width, lag, node)
        else:
            order = min(
                order, width + 1
            )  # of a window that is clipped to the trace, so many are never inside
            x = self.add(f"rank_{reduce}", node, x, n=width, x=float(order), lag=lag)
        return self.moved(x, begin, outside, lag, node) if past and begin else x

    def extremum(self, reduce: str, x: int, width: int, lag: int, origin: Formula) -> int:
        """Return the extremum over the last ``width`` steps."""
        if width == self.point:
            return x
        return self.emit((_SLIDES[reduce], x, NO_OPERAND, 0, width, 0.0, lag), origin)

    def slide(self, reduce: str, x: int, width: int, lag: int, origin: Formula) -> int:
        """Return the extremum or the sum over the last ``width`` steps."""
        if width == self.point:
            return x
        operand = self.origins[x]
        if (
            reduce == "sum"
            and isinstance(operand, Const)
            and not isinstance(operand, Parameter)  # whose value may be changed
            and operand.value.is_integer()
        ):
            most = operand.value * width
            if 0 <= most <= 2**53:  # exact in any order
                return self.counting(x, most, lag, origin)
        return self.emit((_SLIDES[reduce], x, NO_OPERAND, 0, width, 0.0, lag), origin)

    def counting(self, x: int, most: float, lag: int, origin: Formula) -> int:
        """Return the sum over a window of a whole number: the sum so far, but no more than of a whole window."""
        total = self.add("run_sum", origin, x, lag=lag)
        limit = self.constant(most, origin)
        return self.add("min", origin, total, limit, lag=lag)

    def sum(self, node: Apply, x: int) -> int:
        """Lower the sum over a window of the past.

        The operand is delayed, not the sum: that of a window which lies later than the last sample may have no value.
        """
        begin, end = self.bounds(node)
        lag = self.lags[x]
        if end == begin:
            x = self.moved(x, begin, 0.0, lag, node) if begin else x
        else:
            x = self.late(x, lag + begin)
            if end is None:
                x = self.add("run_sum", node, x, lag=lag)
            else:
                x = self.slide("sum", x, end - begin + self.point, lag, node)
        for opcode, factor in seconds_per_step(self.period) if node.op.timed else ():
            x = self.add(opcode, node, x, self.constant(factor, node), lag=self.lags[x])
        return x

    def slid(self, reduce: str, x: int, width: int, lag: int, origin: Formula) -> int:
        """Return a window over an operand of since or until, delayed to their lag (except for constants)."""
        return self.delayed(self.slide(reduce, x, width, self.lags[x], origin), lag)

    def shift_by_one(self, node: Apply, kernel: Shift, x: int) -> int:
        """Lower an operator that reads the previous or next sample."""
        if node.op.tense is Tense.PAST:
            return self.moved(x, 1, kernel.fill, self.lags[x], node)
        return self.moved(x, 0, kernel.fill, self.lags[x] + 1, node)

    @abstractmethod
    def ahead_of(self, node: Apply, x: int) -> int:
        """Lower an operator that reads later values, and the last one where the trace ends before."""

    def since(self, node: Apply, hold: int, goal: int) -> int:
        """φ since[a, b] ψ is once[a, b] ψ, φ on (t - a, t], and (φ since ψ) a ago: O(1) state apart from windows."""
        begin, end = self.bounds(node)
        lag = max(self.lags[hold], self.lags[goal])
        x = self.add("since", node, hold, goal, lag=lag)
        if end is not None:
            recent = self.slid("max", goal, end - begin + self.point, lag, node)
            x = self.add("min", node, x, recent, lag=lag)
        if begin == 0:
            return x
        x = self.moved(x, begin, -inf, lag, node)
        held = self.slid("min", hold, begin, lag, node)
        return self.add("min", node, x, held, lag=lag)

    def until(self, node: Apply, hold: int, goal: int) -> int:
        """φ until[a, b] ψ over the steps up to t + b; in the past tense (precedes) up to t."""
        begin, end = self.bounds(node)
        assert end is not None, "unbounded future is cut off before"
        lag = max(self.lags[hold], self.lags[goal])
        known = lag + end if node.op.tense is Tense.FUTURE else lag
        return self.until_within(node, hold, goal, (begin, end), known)

    def call(self, node: Apply, args: list[int]) -> int:
        """Lower a custom operator to a call of its kernel, or else of its definition."""
        if not args:  # a constant operand determines how many values are needed, and when
            args = [self.constant(0.0, node)]
        begin = 0 if node.interval is None else self.whole(node.interval.begin)
        end = self.end_of(node)
        ahead = self.ahead(node, end)
        site = CallSite(node, tuple(args), begin, end, ahead)
        # If the trace ends before the operator's last operand value, its result is known at the end.
        lag = max(self.lags[i] for i in args) + (ahead if self.clip is None else min(ahead, self.clip))
        number = self.calls.setdefault(site, len(self.calls))
        return self.add("call", node, n=number, lag=lag)

    def end_of(self, node: Apply) -> int | None:
        """Return the upper bound of an operator's interval in steps, None if unbounded."""
        return None if node.interval is None or node.interval.end is None else self.whole(node.interval.end)

    def ahead(self, node: Apply, end: int | None) -> int:
        """Return the number of steps that an operator with bounded future reads ahead."""
        if node.op.tense is not Tense.FUTURE:
            return 0
        ahead = node.op.reach if node.op.bounds is Bounds.NONE else end
        assert ahead is not None, "unbounded future is cut off before"
        return ahead

    @staticmethod
    @abstractmethod
    def until_just_before(period: Fraction) -> Fraction:
        """Return by how much the closed window for [0, a) is shorter than a."""

    @abstractmethod
    def until_within(self, node: Apply, hold: int, goal: int, bounds: tuple[int, int], known: int) -> int:
        """Return until over [begin, end] = ``bounds``, known at lag ``known``."""

    def chain(self, node: Apply, hold: int, goal: int, width: int, known: int) -> int:
        """Return until over a window that ends at the latest step, known at lag ``known``."""
        return self.add("until", node, hold, goal, n=width, lag=known)
