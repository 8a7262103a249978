"""Formulas whose units fit have no finding, and depend on no unit; one mismatch in them is found once, at its place."""

from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.language.parsing.specfile import parse_document
from rtamt.lint.report import findings as warnings_of

#: A variable of each unit; further expressions of it are made of others.
UNITS = {
    "gap": "m",
    "v": "m/s",
    "acc": "m/s^2",
    "t": "s",
    "rad": "rad",
    "deg": "deg",
    "ratio": "1",
    "kmh": "km/h",
}
#: What is put in place of a number of each unit, and its finding.
OTHER = {
    "gap": "v",
    "v": "kmh",
    "acc": "gap",
    "t": "acc",
    "rad": "deg",
    "deg": "rad",
    "ratio": "t",
    "kmh": "gap",
}
CODES = {("v", "kmh"): "RT302", ("rad", "deg"): "RT302", ("deg", "rad"): "RT302"}

#: Numbers of a unit from numbers of others, by the name of the variable of the unit.
MADE = {
    "gap": [
        "{v} * {t}",
        "integral[0:3]({v})",
        "hypot({gap}, {gap})",
        "sqrt({gap} * {gap})",
        "{kmh} / 3.6 * {t}",
    ],
    "v": ["{gap} / {t}", "rate[1]({gap})", "integral[0:2]({acc})", "{kmh} / 3.6", "sqrt(pow({v}, 2))"],
    "acc": ["{v} / {t}", "rate[2]({v})", "{v} * {v} / {gap}"],
    "t": ["{gap} / {v}", "duration[0:5]({formula})", "{v} / {acc}", "1 / ({v} / {gap})"],
    "rad": ["radians({deg})", "atan2({gap}, {gap})", "asin({ratio})", "wrap({rad}, -3.14159, 3.14159)"],
    "deg": ["degrees({rad})", "wrap({deg}, -180, 180)", "mod({deg}, 360)"],
    "ratio": [
        "sin({rad})",
        "cos({rad})",
        "{v} / {v}",
        "exp({ratio})",
        "sign({gap})",
        "count[0:5]({formula})",
    ],
    "kmh": ["{v} * 3.6", "3.6 * {gap} / {t}"],
}
#: Numbers of a unit from numbers of the same one, of any unit.
KEPT = [
    "({x} + {x})", "({x} - 2)", "-{x}", "abs({x})", "min({x}, {x}, 3)", "clip({x}, 0, {x})", "floor({x})", "2 * {x}",
    "delay[1]({x})", "delay[1]({x}, {x})", "ahead[2]({x})", "diff[1]({x})", "mean[0:2]({x}, 1)", "sum[0:2]({x})",
    "maximum[0:3]({x})", "minimum({x})", "held({x}, {formula}, {x})", "(if {formula} then {x} else {x})",
    "mod({x}, {x})", "unknown", "untyped * {x}",
]  # fmt: skip
FORMULAS = [
    "{x} < {x}",
    "{x} == 3",
    "3 >= {x}",
    "({formula} and {formula})",
    "always[0:2]({formula})",
    "not ({formula})",
]

#: Where two numbers must have one unit. The mismatch is the whole text.
SITES = [
    "{x}+{y}",
    "{y}-{x}",
    "min({x}, {y})",
    "delay[1]({x}, {y})",
    "if p > 0 then {y} else {x}",
    "clip({x}, {y}, 9)",
]

DECLARED = "".join(f"input float {name} [{unit}]\n" for name, unit in UNITS.items())
DECLARED += "input float p\ninput float unknown\nconst float untyped = 2\n"


#: Patterns that mean something else in another unit of length, or are rounded otherwise.
IN_UNITS = {
    "({x} - 2)", "min({x}, {x}, 3)", "floor({x})", "mean[0:2]({x}, 1)", "unknown", "untyped * {x}", "{x} == 3",
    "3 >= {x}", "hypot({gap}, {gap})", "sqrt(pow({v}, 2))",
}  # fmt: skip


@st.composite
def texts(draw, *, broken=False, without=()):
    """Return a formula whose units fit, and the mismatch that was put into it: its text and its finding."""
    mismatch = []

    def pattern_of(patterns):
        return draw(st.sampled_from([pattern for pattern in patterns if pattern not in without]))

    def number(unit, depth, hole):
        if depth == 0:
            if not hole:
                return unit
            code = CODES.get((unit, OTHER[unit]), "RT301")
            mismatch.append((draw(st.sampled_from(SITES)).format(x=unit, y=OTHER[unit]), code))
            return f"({mismatch[0][0]})"
        return fill(pattern_of(MADE[unit] + KEPT), unit, depth, hole)

    def formula(depth, hole):
        known = FORMULAS if depth else FORMULAS[:1]
        return fill(pattern_of(known), draw(st.sampled_from(sorted(UNITS))), depth, hole)

    def fill(pattern, unit, depth, hole):
        places = pattern.count("{")
        if hole and not places:
            return number(unit, 0, hole)
        chosen = draw(st.integers(0, places - 1)) if hole else None
        text = pattern
        for k in range(places):
            name = text[text.index("{") + 1 : text.index("}")]
            inner = name == "formula"
            below = max(depth - 1, 0)
            new = (
                formula(below, k == chosen)
                if inner
                else number(unit if name == "x" else name, below, k == chosen)
            )
            operand = pattern.startswith(("{", "-")) or " * " in pattern or " / " in pattern
            text = text.replace(f"{{{name}}}", f"({new})" if operand and not inner else new, 1)
        return text

    return formula(draw(st.integers(1, 4)), broken), mismatch


def found(text):
    return [
        (each.code, each.text[each.span.start : each.span.end])
        for each in warnings_of(parse_document(DECLARED + text))
        if each.code.startswith("RT3")
    ]


@given(texts())
def test_a_formula_whose_units_fit_has_no_finding(case):
    text, _ = case
    assert found(text) == []


@given(texts(broken=True))
def test_one_mismatch_has_one_finding_at_its_place(case):
    text, ((mismatch, code),) = case
    assert found(text) == [(code, mismatch)]


LENGTHS = {"gap", "v", "acc", "kmh"}
DATA = st.lists(st.tuples(*[st.integers(-4, 4)] * (len(UNITS) + 2)), min_size=1, max_size=6)


@given(texts(without=IN_UNITS), DATA)
def test_a_verdict_does_not_depend_on_the_unit_of_length(case, rows):
    spec = rtamt.parse(DECLARED + case[0])
    columns = dict(zip((*UNITS, "p", "unknown"), map(list, zip(*rows, strict=True)), strict=True))
    # Sixteen of the new unit are one of the old one: products with 16, and with its root, are exact.
    scaled = {name: [16 * x if name in LENGTHS else x for x in values] for name, values in columns.items()}
    assert verdict(spec, scaled) == verdict(spec, columns)


def verdict(spec, columns):
    try:
        return spec.evaluate(columns).satisfied
    except rtamt.EvaluationError:
        return "undefined"
