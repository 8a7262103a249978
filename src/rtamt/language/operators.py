"""The operator table: every operator of the language, once.

One frozen record (``records.py``) per operator. Lexer, parser, printer, checks, horizon, desugaring,
pastification, compiler, command-line help, the generated reference and the test generators all derive from
this table; there is no second list. ``STL.extend(...)`` returns a new language.

The meaning of an operator is its ``definition``, a pure function on arrays: of a pointwise operator the same in
every time domain (``pointwise_definitions.py``), of a temporal operator that in discrete time (``definitions.py``).
In dense time, a temporal operator has a function ``dense`` that gives its value at one instant
(``dense_definitions.py``), or the meaning of its ``expansion``.
The implementation is either an ``expansion`` into simpler operators (``expansions.py``) or a ``kernel``: one of the
shapes that the compiler supports, or a user-supplied class (``Blocks``, ``Compiled``). Names of opcodes are
those of the core.
"""

from __future__ import annotations

from math import inf

from rtamt.language import definitions as d
from rtamt.language import dense_definitions as dense
from rtamt.language import enclosures as e
from rtamt.language import expansions as expand
from rtamt.language import functions as f
from rtamt.language import pointwise_definitions as p
from rtamt.language.formula import Const
from rtamt.language.records import (
    Ahead,
    Blocks,
    Bounds,
    Compiled,
    Fixity,
    Kernel,
    Language,
    Operator,
    Pointwise,
    Rank,
    Shift,
    Since,
    Sort,
    Sum,
    Tense,
    Until,
    Window,
)
from rtamt.language.rows import C, F, N, function, infix, math, prefix
from rtamt.language.unwritten import EQ, GE, GT, LE, LT, NE, UNWRITTEN

__all__ = [
    "STL",
    "Ahead",
    "Blocks",
    "Bounds",
    "Compiled",
    "Fixity",
    "Kernel",
    "Language",
    "Operator",
    "Pointwise",
    "Rank",
    "Shift",
    "Since",
    "Sort",
    "Sum",
    "Tense",
    "Until",
    "Window",
    "builtin",
]


def builtin(name: str) -> Operator | None:
    """Return the built-in operator with this name, in the table or not; built-in operators unpickle to it."""
    return STL.get(name) or UNWRITTEN.get(name)


_SAMPLES = "adds samples, which dense time does not have; use minimum or maximum"
_COUNT = "counts samples at which a formula begins to hold; use rise or atleast"
_LINE = "of a step signal is a line, not a step, and dense time has steps only; use atleast with a duration"


STL: Language = Language.of((
    # ---- atoms -------------------------------------------------------------------------------
    Operator("true", ("true",), Fixity.ATOM, 200, (), F, "Always holds: +inf.", "true", r"\top",
             p.true, expansion=lambda _i: Const(inf)),
    Operator("false", ("false",), Fixity.ATOM, 200, (), F, "Never holds: -inf.", "false", r"\bot",
             p.false, expansion=lambda _i: Const(-inf)),
    # ---- numbers -----------------------------------------------------------------------------
    function("abs", 1, "Absolute value.", "abs(x) <= 2", latex=r"\left|{0}\right|",
             definition=p.abs_, kernel=Pointwise("abs"), extension=e.abs_, slopes=e.slopes(0)),
    function("sqrt", 1, "Square root.", "sqrt(x) <= 2", latex=r"\sqrt{{{0}}}",
             definition=p.sqrt, kernel=Pointwise("sqrt", partial=True), extension=e.sqrt, slopes=e.slopes(1)),
    function("exp", 1, "The exponential function.", "exp(x) <= 2",
             definition=p.exp, kernel=Pointwise("exp"), extension=e.exp, slopes=e.slopes(1)),
    function("pow", 2, "The first operand to the power of the second.", "pow(x, 2) <= 4",
             latex=r"{{{0}}}^{{{1}}}", definition=p.pow_, kernel=Pointwise("pow", partial=True),
             extension=e.pow_, slopes=e.slopes(None, None)),
    function("log", 2, "The logarithm of the first operand to the base of the second.", "log(x, 10) >= 1",
             latex=r"\log_{{{1}}}({0})", definition=p.log, kernel=Pointwise("log", partial=True),
             extension=e.log, slopes=e.slopes(None, None)),
    function("ln", 1, "The natural logarithm.", "ln(x) >= 0", latex=r"\ln({0})",
             definition=p.ln, kernel=Pointwise("ln", partial=True), extension=e.ln, slopes=e.slopes(1)),
    function("min", 2, "The smallest operand.", "min(x, y) >= 0", latex=r"\min({0}, {1})",
             definition=p.and_, kernel=Pointwise("min"), extension=e.and_, slopes=e.slopes(1, 1), folds=True),
    function("max", 2, "The largest operand.", "max(x, y) >= 0", latex=r"\max({0}, {1})",
             definition=p.or_, kernel=Pointwise("max"), extension=e.or_, slopes=e.slopes(1, 1), folds=True),
    math("sin", "Sine of an angle in radians.", "sin(x) <= 1", 0, partial=True, latex=r"\sin({0})"),
    math("cos", "Cosine of an angle in radians.", "cos(x) <= 1", 0, partial=True, latex=r"\cos({0})"),
    math("tan", "Tangent of an angle in radians.", "tan(x) <= 1", 0, partial=True, latex=r"\tan({0})"),
    math("asin", "Arc sine in radians.", "asin(x / 10) <= 1", 1, partial=True, latex=r"\arcsin({0})"),
    math("acos", "Arc cosine in radians.", "acos(x / 10) <= 1", -1, partial=True, latex=r"\arccos({0})"),
    math("atan", "Arc tangent in radians.", "atan(x) <= 1", 1, latex=r"\arctan({0})"),
    math("atan2", "Angle of the point (second, first operand) in radians.", "atan2(y, x) <= 1", 0, 0),
    math("hypot", "Length of a vector with two components.", "hypot(x, y) <= 5", 0, 0,
         latex=r"\sqrt{{{0}^2 + {1}^2}}"),
    math("sinh", "Hyperbolic sine.", "sinh(x) <= 1", 1, latex=r"\sinh({0})"),
    math("cosh", "Hyperbolic cosine.", "cosh(x) <= 2", 0, latex=r"\cosh({0})"),
    math("tanh", "Hyperbolic tangent.", "tanh(x) <= 1", 1, latex=r"\tanh({0})"),
    math("degrees", "Radians as degrees.", "degrees(x) <= 90", 1),
    math("radians", "Degrees as radians.", "sin(radians(x)) <= 1", 1),
    math("floor", "The greatest whole number that is not above the operand.", "floor(x) == 3", 1,
         latex=r"\lfloor {0} \rfloor"),
    math("ceil", "The least whole number that is not below the operand.", "ceil(x) == 3", 1,
         latex=r"\lceil {0} \rceil"),
    math("round", "The nearest whole number; halves away from zero.", "round(x) == 3", 1, definition=f.round_),
    math("sign", "-1, 0 or 1: the sign of the operand.", "sign(x) == 1", 1),
    math("mod", "The remainder of a division, with the sign of the divisor.", "mod(x, 360) <= 180", 0, None,
         partial=True),
    function("clip", 3, "The number of [second, third operand] next to the first; an error where they are reversed.",
             "clip(x, -1, 1) >= 0", definition=f.clip, expansion=expand.clip, strict=True),
    function("wrap", 3, "The first operand moved into [second, third) by whole multiples of their difference.",
             "wrap(x, -180, 180) <= 90", definition=f.wrap, expansion=expand.wrap, strict=True),
    Operator("if", ("if",), Fixity.CONDITIONAL, 100, (C, N, N), N,
             "The number after 'then' where the condition holds, else the number after 'else'.",
             "(if x >= 3 then x else y) <= 5", r"\mathbf{{if}}\ {0}\ \mathbf{{then}}\ {1}\ \mathbf{{else}}\ {2}",
             p.if_, expansion=lambda condition, a, b, _i: expand.choice(condition, a, b), strict=True, keeps=(1, 2)),
    prefix("neg", "-", 120, "Minus.", "-x >= 2", operands=(N,), result=N, latex="-{0}",
           definition=p.neg, kernel=Pointwise("neg"), extension=e.neg, slopes=e.slopes(-1)),
    infix("mul", "*", 110, "Product.", "2 * x <= 3", operands=(N, N), result=N, latex=r"{0} \cdot {1}",
          definition=p.mul, kernel=Pointwise("mul", partial=True), extension=e.mul, slopes=e.of_product),
    infix("div", "/", 110, "Quotient.", "x / 2 <= 3", operands=(N, N), result=N, latex=r"{0} / {1}",
          definition=p.div, kernel=Pointwise("div", partial=True), extension=e.div, slopes=e.of_quotient),
    infix("add", "+", 100, "Sum.", "x + y <= 3", operands=(N, N), result=N, latex="{0} + {1}",
          definition=p.add, kernel=Pointwise("add", partial=True), extension=e.add, slopes=e.slopes(1, 1)),
    infix("sub", "-", 100, "Difference.", "x - y <= 3", operands=(N, N), result=N, latex="{0} - {1}",
          definition=p.sub, kernel=Pointwise("sub", partial=True), extension=e.sub, slopes=e.slopes(1, -1)),
    # ---- predicates --------------------------------------------------------------------------
    infix("ge", ">=", 90, "At least: a - b.", "x >= 3", operands=(N, N), latex=r"{0} \geq {1}", dual="lt",
          definition=p.ge, expansion=lambda a, b, _i: STL["sub"](a, b), truth=lambda a, b, _i: GE(a, b)),
    infix("gt", ">", 90, "More than: a - b.", "x > 3", operands=(N, N), latex="{0} > {1}", dual="le",
          definition=p.ge, expansion=lambda a, b, _i: STL["sub"](a, b), truth=lambda a, b, _i: GT(a, b)),
    infix("le", "<=", 90, "At most: b - a.", "x <= 3", operands=(N, N), latex=r"{0} \leq {1}", dual="gt",
          definition=p.le, expansion=lambda a, b, _i: STL["sub"](b, a), truth=lambda a, b, _i: LE(a, b)),
    infix("lt", "<", 90, "Less than: b - a.", "x < 3", operands=(N, N), latex="{0} < {1}", dual="ge",
          definition=p.le, expansion=lambda a, b, _i: STL["sub"](b, a), truth=lambda a, b, _i: LT(a, b)),
    infix("eq", "==", 90, "Equal: -|a - b|, at best 0.", "x == 3", operands=(N, N), latex="{0} = {1}", dual="ne",
          equates=True, definition=p.eq, expansion=lambda a, b, _i: STL["neg"](STL["abs"](STL["sub"](a, b))),
          truth=lambda a, b, _i: EQ(a, b)),
    infix("ne", "!= !==", 90, "Different: |a - b|.", "x != 3", operands=(N, N), latex=r"{0} \neq {1}", dual="eq",
          equates=True, definition=p.ne, expansion=lambda a, b, _i: STL["abs"](STL["sub"](a, b)),
          truth=lambda a, b, _i: NE(a, b)),
    function("valid", 1, "The variable has a sample here; everywhere if none is missing.", "valid(x)", result=F,
             definition=p.valid, expansion=lambda a, _i: GE(a, a), presence=True),
    # ---- Boolean -----------------------------------------------------------------------------
    prefix("not", "not !", 80, "Negation: minus.", "not (x >= 3)", latex=r"\neg {0}",
           definition=p.neg, expansion=lambda a, _i: STL["neg"](a)),
    infix("and", "and & &&", 40, "Both: the smaller value.", "x >= 3 and y >= 3", latex=r"{0} \wedge {1}",
          dual="or", definition=p.and_, kernel=Pointwise("min"), extension=e.and_, slopes=e.slopes(1, 1)),
    infix("or", "or | ||", 30, "At least one: the larger value.", "x >= 3 or y >= 3", latex=r"{0} \vee {1}",
          dual="and", definition=p.or_, kernel=Pointwise("max"), extension=e.or_, slopes=e.slopes(1, 1)),
    infix("implies", "-> implies", 20, "If the first then the second: max(-a, b).", "x >= 3 -> y >= 3",
          latex=r"{0} \to {1}", fixity=Fixity.RIGHT,
          definition=p.implies, expansion=lambda a, b, _i: STL["or"](STL["not"](a), b)),
    infix("iff", "<-> iff", 15, "Both or neither: (a -> b) and (b -> a).", "x >= 3 <-> y >= 3",
          latex=r"{0} \leftrightarrow {1}", dual="xor", definition=p.iff, expansion=expand.iff),
    infix("xor", "xor", 10, "One but not both: not (a <-> b).", "x >= 3 xor y >= 3",
          latex=r"{0} \oplus {1}", dual="iff", definition=p.xor, expansion=expand.xor),
    # ---- windows -----------------------------------------------------------------------------
    prefix("always", "always G", 75, "At every instant of the window ahead: the smallest value.",
           "always[0:5](x >= 3)", latex=r"\mathbf{{G}}_{I} {0}", tense=Tense.FUTURE, bounds=Bounds.OPTIONAL,
           definition=d.always, dense=dense.always, kernel=Window("min"), dual="eventually",
           twin="historically"),
    prefix("eventually", "eventually F", 75, "At some instant of the window ahead: the largest value.",
           "eventually[0:5](x >= 3)", latex=r"\mathbf{{F}}_{I} {0}", tense=Tense.FUTURE, bounds=Bounds.OPTIONAL,
           definition=d.eventually, dense=dense.eventually, kernel=Window("max"), dual="always",
           twin="once"),
    prefix("historically", "historically H", 75, "At every instant of the window behind: the smallest value.",
           "historically[0:5](x >= 3)", latex=r"\mathbf{{H}}_{I} {0}", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
           definition=d.historically, dense=dense.historically, kernel=Window("min"), dual="once",
           guards=("implies",)),
    prefix("once", "once O", 75, "At some instant of the window behind: the largest value.",
           "once[0:5](x >= 3)", latex=r"\mathbf{{O}}_{I} {0}", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
           definition=d.once, dense=dense.once, kernel=Window("max"), dual="historically", guards=("and",)),
    # ---- shares of a window ------------------------------------------------------------------
    function("atleast", 1, "In at least this share of the window ahead: the k-th largest value.",
             "atleast[0:5](80%, x >= 3)", operands=(F,), result=F,
             latex=r"\mathrm{{atleast}}_{I}({S}, {0})", tense=Tense.FUTURE, bounds=Bounds.REQUIRED, share=True,
             definition=d.atleast, dense=dense.atleast, kernel=Rank(), twin="wasatleast"),
    function("wasatleast", 1, "In at least this share of the window behind: the k-th largest value.",
             "wasatleast[0:5](3s, x >= 3)", operands=(F,), result=F,
             latex=r"\mathrm{{wasatleast}}_{I}({S}, {0})", tense=Tense.PAST, bounds=Bounds.REQUIRED, share=True,
             definition=d.wasatleast, dense=dense.wasatleast, kernel=Rank(), guards=("implies",)),
    # ---- numbers over time -------------------------------------------------------------------
    function("minimum", 1, "The least number of the window behind.", "minimum[0:5](x) >= 3",
             latex=r"\mathrm{{minimum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
             definition=d.historically, dense=dense.historically, kernel=Window("min"),
             guards=("implies",), strict=True),
    function("maximum", 1, "The greatest number of the window behind.", "maximum[0:5](x) - x <= 3",
             latex=r"\mathrm{{maximum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
             definition=d.once, dense=dense.once, kernel=Window("max"),
             guards=("and",), strict=True),
    function("sum", 1, "The sum of the samples in the window behind; 0 where there is none.", "sum[0:5](x) <= 3",
             latex=r"\mathrm{{sum}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL, discrete_only=True,
             why_discrete=_SAMPLES, instead="count", definition=d.sum_, kernel=Sum(), guards=("zero",), strict=True),
    function("mean", 2, "The mean of the samples in the window behind; the second operand where there is none, by default "
             "the first operand at the first sample.", "mean[0:5](x) <= 3", latex="", optional=1, tense=Tense.PAST,
             bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, instead="duration", definition=d.mean,
             expansion=expand.mean, strict=True),
    function("integral", 1, "The sum over the window behind times the sampling period in seconds.",
             "integral[0:5](x) <= 3", latex=r"\mathrm{{integral}}_{I}({0})", tense=Tense.PAST,
             bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, instead="duration", definition=d.integral, kernel=Sum(), timed=True,
             guards=("zero",), strict=True),
    function("duration", 1, "For how many seconds of the window behind a formula holds: samples times the period.",
             "duration[0:60](x >= 3) <= 10", operands=(C,), latex=r"\mathrm{{duration}}_{I}({0})", tense=Tense.PAST,
             bounds=Bounds.OPTIONAL, discrete_only=True, why_discrete=_LINE, timed=True, definition=d.duration,
             expansion=expand.duration, guards=("and",)),
    function("count", 1, "How often a formula begins to hold in the window behind.", "count[0:60](x >= 3) <= 10",
             operands=(C,), latex=r"\mathrm{{count}}_{I}({0})", tense=Tense.PAST, bounds=Bounds.OPTIONAL,
             before=1, discrete_only=True, why_discrete=_COUNT, definition=d.count, expansion=expand.count, guards=("and",)),
    function("held", 3, "The first operand when the second was last true; the third, or its first value, where it "
             "never was.", "x - held(x, y >= 3) <= 2", operands=(N, C, N), optional=1, latex="", tense=Tense.PAST,
             reach=None, definition=d.held, dense=dense.held, expansion=expand.held, pastified=expand.past_held, strict=True,
             keeps=(0, 2)),
    function("delay", 2, "The first operand d ago; the second, or its first value, where that is before the start.",
             "x - delay[2](x) <= 2", optional=1, latex="", tense=Tense.PAST, bounds=Bounds.DURATION,
             definition=d.delay, dense=dense.delay, expansion=expand.delay, pastified=expand.past_delay, strict=True, keeps=(0, 1)),
    function("ahead", 1, "The operand d ahead; where the trace ends before, its last value.",
             "ahead[2](x) - x <= 2", latex="", tense=Tense.FUTURE, bounds=Bounds.DURATION,
             definition=d.ahead, dense=dense.ahead, kernel=Ahead(), twin="", strict=True, keeps=(0,)),
    function("diff", 1, "The operand minus what it was d ago, or at the start.", "diff[2](x) <= 2", latex="",
             tense=Tense.PAST, bounds=Bounds.DURATION, definition=d.diff, dense=dense.diff, expansion=expand.diff,
             strict=True),
    function("rate", 1, "The change of the operand in the last d, a second: diff[d](x) / d.", "rate[2](x) <= 1",
             latex="", tense=Tense.PAST, bounds=Bounds.DURATION, definition=d.rate, dense=dense.rate,
             expansion=expand.rate, strict=True, positive=True, timed=True),
    # ---- one sample away ---------------------------------------------------------------------
    prefix("prev", "prev Y previous", 70, "One sample ago; holds where there is none.", "prev(x >= 3)",
           latex=r"\mathbf{{Y}} {0}", tense=Tense.PAST, reach=1, discrete_only=True,
           definition=d.prev, kernel=Shift(inf), dual="s_prev", guards=("implies",)),
    prefix("next", "next X", 70, "One sample ahead; holds where there is none.", "next(x >= 3)",
           latex=r"\mathbf{{X}} {0}", tense=Tense.FUTURE, reach=1, discrete_only=True,
           definition=d.next_, kernel=Shift(inf), dual="s_next", twin=""),
    prefix("s_prev", "s_prev sY s_previous", 70, "One sample ago; fails where there is none.", "s_prev(x >= 3)",
           latex=r"\mathbf{{Y}}_s {0}", tense=Tense.PAST, reach=1, discrete_only=True,
           definition=d.s_prev, kernel=Shift(-inf), dual="prev", guards=("and",)),
    prefix("s_next", "s_next sX", 70, "One sample ahead; fails where there is none.", "s_next(x >= 3)",
           latex=r"\mathbf{{X}}_s {0}", tense=Tense.FUTURE, reach=1, discrete_only=True,
           definition=d.s_next, kernel=Shift(-inf), dual="next", twin=""),
    # ---- two operands in time ----------------------------------------------------------------
    infix("until", "until U", 60, "The second within the window ahead, the first at every instant before it.",
          "x >= 3 until[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{U}}_{I}}} {1}",
          tense=Tense.FUTURE, bounds=Bounds.OPTIONAL, definition=d.until, dense=dense.until, kernel=Until(),
          twin="precedes"),
    infix("precedes", "precedes", 58, "until, read from as far behind as the interval reaches.",
          "x >= 3 precedes[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{P}}_{I}}} {1}",
          tense=Tense.PAST, bounds=Bounds.REQUIRED, definition=d.precedes, dense=dense.precedes, kernel=Until(),
          guards=("implies", "and")),
    infix("unless", "unless W", 55, "Either the first throughout [0, b], or the first until the second.",
          "x >= 3 unless[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{W}}_{I}}} {1}",
          tense=Tense.FUTURE, bounds=Bounds.OPTIONAL, definition=d.unless, dense=dense.unless, expansion=expand.unless),
    infix("since", "since S", 50, "The second within the window behind, the first at every instant after it.",
          "x >= 3 since[0:5] y >= 3", latex=r"{0} \mathbin{{\mathbf{{S}}_{I}}} {1}",
          tense=Tense.PAST, bounds=Bounds.OPTIONAL, definition=d.since, dense=dense.since, kernel=Since(),
          guards=(None, "and")),
    # ---- edges -------------------------------------------------------------------------------
    function("rise", 1, "Holds now and not one sample (in dense time one tick) ago, or at the start.", "rise(x >= 3)",
             operands=(F,), result=F, latex=r"\uparrow {0}", tense=Tense.PAST, reach=1, one_tick=True,
             definition=d.rise, dense=dense.rise, expansion=expand.rise),
    function("fall", 1, "Held one sample (in dense time one tick) ago and does not now, or fails at the start.",
             "fall(x >= 3)", operands=(F,), result=F, latex=r"\downarrow {0}", tense=Tense.PAST, reach=1, one_tick=True,
             definition=d.fall, dense=dense.fall, expansion=expand.fall),
))  # fmt: skip
