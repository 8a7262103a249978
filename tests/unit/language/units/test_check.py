"""Dimensional analysis: what fits, what does not, and that nothing is reported about what is not declared."""

import sys

import pytest

import rtamt
from rtamt.language.operators import STL, Sort

DECLARED = """
input float v [m/s]
input float kmh [km/h]
input float gap [m]
input float acc [m/s^2]
input float deg [deg]
input float rad [rad]
input float omega [rad/s]
input float rpm [rpm]
input float hz [Hz]
input float celsius [degC]
input float kelvin [K]
input float ms [ms]
input float s [s]
input float torque [N*m]
input float joule [J]
input float share [%]
input float ratio [1]
input float u
const float unknown = 3
const float g = 9.81 [m/s^2]
const float band = 2 [K]
parameter float limit = 4 [m]
table curve = {(0, 1), (1, 2)}
def near(x, most) = abs(x) <= most
"""


def found(formula):
    """Return the code of each finding, and the text at its caret."""
    return [(each.code, each.text[each.span.start : each.span.end]) for each in findings(formula)]


def findings(formula):
    # Most formulas leave a declaration unused, which is not the subject here.
    return [each for each in rtamt.parse(DECLARED + formula).warnings if each.code != "RT203"]


FITTING = [
    "v > 3 and 0 <= v <= 30 and v != 0",
    "v + 1 > 3 - v",
    "v * s < gap and gap / s > v and v / s > acc and gap * gap / gap < gap",
    "v < u and u + v > gap and unknown * v < gap and sin(u) > v and pow(v, unknown) > gap",
    # numbers convert
    "v * 3.6 < kmh and v < kmh / 3.6 and 1000 * v / 3600 < kmh * (1 / 3.6) * (1000 / 3600)",
    "ms / 1000 < s and 0.001 * ms < s and ratio * 100 < share",
    "deg * 0.0174533 < rad and 180 / 3.14159 * rad < deg",
    # angles
    "hz * s > 3 and 1 / s < hz and hz * 6.28319 < omega and omega / 6.28319 < hz and hz * gap < v",
    "sin(rad) > 0 and cos(radians(deg)) > 0 and tan(v / v) > 0 and asin(gap / limit) < rad and atan2(gap, gap) < rad",
    "degrees(atan(ratio)) < deg and radians(deg / s) < omega and degrees(omega) > deg / s",
    "omega * gap < v",
    "wrap(deg, -180, 180) > 0 and wrap(rad, -3.14159, 3.14159) > 0 and mod(deg, 360) > 0 and wrap(v, 0, 360) > 0",
    # other functions
    "sqrt(v * v) < v and pow(v, 2) < v * v and pow(gap, 0.5) < sqrt(gap) and hypot(v, 3) < v and pow(ratio, u) < ratio",
    "exp(v / v) > 1 and ln(ratio) > 1 and log(gap / gap, 10) > 1 and tanh(ratio) > 0",
    "abs(v) + floor(v) + ceil(v) + round(v) + min(v, 3, v) + max(v, u) + clip(v, -1, 1) + mod(v, 3) - -v < v",
    "sign(v) * gap < gap and sign(v) == 1",
    # over time
    "delay[1](v) < v and delay[1](v, 0) < v and ahead[1](v) < v and diff[1](v) < v and held(v, gap > 3, 0) < v",
    "rate[1](v) < acc and rate[1](gap) < v and integral[0:5](v) < gap and integral[0:5](v) / s < v",
    "sum[0:5](v) < v and mean[0:5](v, 3) < v and minimum(v) < v and maximum[0:5](v) - v < v",
    "duration[0:5](v > 3) < s and count[0:5](v > 3) < 3 and count(v > 3) * gap < gap and duration(v > 3) / s < ratio",
    "(if v > 3 then v else 0) < v and held(if v > 3 then u else v, gap > 3) < gap",
    # zeros of temperatures
    "celsius < 30 and celsius + 273.15 < kelvin and celsius - 20 < band and abs(celsius - celsius) < band",
    "rate[1](celsius) < band / s and 1.8 * celsius + 32 > 0",
    # names, templates, tables
    "near(gap, limit) and near(gap - limit, most=3) and near(u, limit) and curve(v) < gap",
    "fast = v * 2; require R: fast > 3 and (fast < v or sqrt(gap) > 3)",
]


def test_a_misfit_names_a_constant_inside_an_operand():
    (finding,) = findings("v < 3 * band")
    assert finding.message.startswith("'v' is in m/s and '3 * band' is in K,")


@pytest.mark.parametrize("formula", FITTING)
def test_units_that_fit(formula):
    assert found(formula) == []


MISFITS = [
    ("v + gap > 3", "RT301", "v + gap"),
    ("always(v - gap + v > gap)", "RT301", "v - gap"),
    ("v < gap", "RT301", "v < gap"),
    ("0 <= v <= gap", "RT301", "v <= gap"),
    ("gap == v or gap > 3", "RT301", "gap == v"),
    ("gap >= 2 * v", "RT301", "gap >= 2 * v"),
    ("v * v / (2 * 8) < gap", "RT301", "v * v / (2 * 8) < gap"),
    ("9.81 * sin(rad) < acc", "RT301", "9.81 * sin(rad) < acc"),
    ("v < kmh", "RT302", "v < kmh"),
    ("2 * v < kmh", "RT302", "2 * v < kmh"),
    ("ms < s", "RT302", "ms < s"),
    ("share < ratio", "RT302", "share < ratio"),
    ("sin(deg) > 0", "RT302", "deg"),
    ("cos(2 * deg) > 0", "RT302", "2 * deg"),
    ("tan(gap) > 0", "RT301", "gap"),
    ("deg < rad", "RT302", "deg < rad"),
    ("asin(ratio) < deg", "RT302", "asin(ratio) < deg"),
    ("atan2(v, gap) < rad", "RT301", "atan2(v, gap)"),
    ("degrees(deg) > 0", "RT302", "deg"),
    ("radians(rad) > 0", "RT302", "rad"),
    ("radians(v) > 0", "RT301", "v"),
    ("wrap(rad, -180, 180) > 0", "RT302", "rad"),
    ("wrap(deg, 0, 6.2832) > 0", "RT302", "deg"),
    ("mod(rad, 360) > 0", "RT302", "rad"),
    ("wrap(deg, -rad, rad) > 0", "RT302", "wrap(deg, -rad, rad)"),
    ("rpm < hz", "RT302", "rpm < hz"),
    ("hz < omega", "RT302", "hz < omega"),
    ("omega > 2 * hz", "RT302", "omega > 2 * hz"),
    ("celsius < kelvin", "RT302", "celsius < kelvin"),
    ("sqrt(gap) < gap", "RT301", "sqrt(gap) < gap"),
    ("pow(v, 2) < gap", "RT301", "pow(v, 2) < gap"),
    ("pow(v, gap) < 3", "RT301", "gap"),
    ("hypot(v, gap) < 3", "RT301", "hypot(v, gap)"),
    ("exp(gap) > 1", "RT301", "gap"),
    ("ln(share) > 1", "RT302", "share"),
    ("sign(v) < gap", "RT301", "sign(v) < gap"),
    ("min(v, gap) > 3", "RT301", "min(v, gap)"),
    ("clip(v, 0, gap) > 3", "RT301", "clip(v, 0, gap)"),
    ("delay[1](v, gap) > 3", "RT301", "delay[1](v, gap)"),
    ("held(v, gap > 3, gap) > 3", "RT301", "held(v, gap > 3, gap)"),
    ("(if u > 3 then v else gap) > 3", "RT301", "if u > 3 then v else gap"),
    ("(if v > gap then v else 3) > 3", "RT301", "v > gap"),
    ("mean[0:5](v, gap) > 3", "RT301", "mean[0:5](v, gap)"),
    ("rate[1](v) < v", "RT301", "rate[1](v) < v"),
    ("integral[0:5](v) < v", "RT301", "integral[0:5](v) < v"),
    ("duration[0:5](v > 3) < ms", "RT302", "duration[0:5](v > 3) < ms"),
    ("duration[0:5](v > gap) < s", "RT301", "v > gap"),
    ("count[0:5](v > 3) < s", "RT301", "count[0:5](v > 3) < s"),
    ("maximum[0:5](v) < gap", "RT301", "maximum[0:5](v) < gap"),
    ("near(v, limit)", "RT301", "near(v, limit)"),
    ("fast = v + gap; fast > 3 and fast < 4", "RT301", "v + gap"),
]


@pytest.mark.parametrize(("formula", "code", "where"), MISFITS)
def test_units_that_do_not_fit_are_reported_once_at_their_place(formula, code, where):
    assert found(formula) == [(code, where)]


BOTH = "declare both in one unit"
MESSAGES = {
    "v + gap > 3": "'v' is in m/s and 'gap' is in m, which are different quantities; correct a declaration, or "
    "multiply 'v' by a constant in s",
    "near(v, limit)": "'abs(v)' is in m/s and 'limit' is in m, which are different quantities; correct a declaration, "
    "or multiply 'abs(v)' by a constant in s",
    "gap < 2 * v * v": "'gap' is in m and '2 * v * v' is in m^2/s^2, which are different quantities; correct a "
    "declaration, or multiply 'gap' by a constant in m/s^2",
    "count(v > 3) < s": "'count(v > 3)' has no unit and 's' is in s, which are different quantities; correct a "
    "declaration, or multiply 'count(v > 3)' by a constant in s",
    "v < kmh": f"'v' is in m/s and 'kmh' is in km/h, two units of one quantity; {BOTH}, or multiply 'v' by 3.6",
    "kmh < v": f"'kmh' is in km/h and 'v' is in m/s, two units of one quantity; {BOTH}, or divide 'kmh' by 3.6",
    "rad < deg": f"'rad' is in rad and 'deg' is in deg, two units of one quantity; {BOTH}, or write radians(deg)",
    "rpm < hz": f"'rpm' is in rpm and 'hz' is in Hz, two units of one quantity; {BOTH}, or divide 'rpm' by 60",
    "hz < omega": (
        f"'hz' is in Hz and 'omega' is in rad/s, two units of one quantity; {BOTH}, or multiply 'hz' by 6.28319"
    ),
    "torque / joule / s > s": (
        "'torque / joule / s' is in N*m/J/s and 's' is in s, which are different quantities; correct a declaration, or "
        "multiply 'torque / joule / s' by a constant in s^2"
    ),
    "kelvin < celsius": f"'kelvin' is in K and 'celsius' is in degC, which count from different zeros; {BOTH}",
    "sin(deg) > 0": "'deg' is in deg, and this takes an angle in radians; write radians(deg)",
    "exp(share) > 0": "'share' is in %, and this takes a number without unit; divide it by 100",
    "tan(gap) > 0": "'gap' is in m, and this takes an angle in radians; correct the declaration of its unit, or divide "
    "it by a constant of the same unit",
    "degrees(deg) > 0": "'deg' is in deg, which is in degrees already; leave out the conversion",
    "degrees(v) > 0": "'v' is in m/s, which is no angle; correct the declaration of its unit",
    "mod(rad, 360) > 0": "'rad' is in rad, and 360 is a full turn in degrees; write degrees(rad), or a full turn in "
    "rad",
}


@pytest.mark.parametrize(("formula", "message"), MESSAGES.items())
def test_messages_name_the_units_and_the_fix(formula, message):
    assert [each.message for each in findings(formula)] == [message]


@pytest.mark.parametrize("formula", [formula for formula, _, _ in MISFITS if "band" not in formula])
def test_a_text_without_units_is_not_checked(formula):
    names = "v kmh gap acc deg rad omega rpm hz celsius kelvin ms s share ratio u limit".split()
    declared = "".join(f"input float {name}\n" for name in names) + "def near(x, most) = abs(x) <= most\n"
    assert rtamt.parse(declared + formula).warnings == ()


def test_the_caret_is_below_the_mismatch():
    (finding,) = rtamt.parse("input float v [m/s]\ninput float gap [m]\nalways(v + gap > 3)").warnings
    assert str(finding) == (
        "RT301: 'v' is in m/s and 'gap' is in m, which are different quantities; correct a declaration, or multiply "
        "'v' by a constant in s\n"
        "  line 3, column 8:\n"
        "    always(v + gap > 3)\n"
        "           ^^^^^^^"
    )
    assert finding.severity == "error"


def test_findings_do_not_block_evaluation():
    spec = rtamt.parse("input float v [m/s]  input float gap [m]  always(v + gap > 3)")
    assert spec.evaluate({"v": [1, 2], "gap": [5, 4]}).robustness == 3


def test_an_unknown_unit_is_reported_where_it_meets_another_one():
    text = "input float v [kmh]  input float w [kmh]  input float x [m/s]  v < w and v > 3 and "
    assert rtamt.parse(text + "w > 2").warnings == ()
    (finding,) = rtamt.parse(text + "w < x and v < x").warnings
    assert (finding.code, finding.severity) == ("RT303", "note")
    assert finding.text[finding.span.start : finding.span.end] == "w < x"
    assert finding.message == (
        "the units are not checked here: pint does not know the unit 'kmh'; correct its spelling, such as km/h or m/s^2"
    )


def test_without_the_library_equal_units_are_known_and_the_others_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pint", None)
    assert found("v < 3 and v + v > 2 and gap * v < v * gap and rate[1](v) < v / s") == []
    (finding,) = findings("v < kmh and v < gap")
    assert (finding.code, finding.message) == (
        "RT303",
        "the units are not checked here: comparing units needs the package 'pint', which is not installed: "
        "pip install 'rtamt[units]'",
    )


@pytest.mark.parametrize(
    "unit",
    ["{0}", "9**9**9**9", "m**99999999", "m" * 10**4, "exit()", "Ym^9", "m*" * 29, "%s", "dB", "°", "dBm*m"],
)
def test_a_hostile_unit_does_no_harm(unit):
    text = f"input float v [{unit}]  input float x [km]  "
    powers = "pow(v, 12) < x and pow(v, 1e300) < x and pow(1e300 * v, 2) < x and pow(v, inf) < 3 and 1e-300 * v < x"
    products = " * ".join(["v", "x"] * 200)
    warnings = rtamt.parse(f"{text} {powers} and {products} > x and v < x and sin(v) < 0").warnings
    assert {each.code for each in warnings} <= {"RT301", "RT302", "RT303"}


@pytest.mark.parametrize("formula", ["v < x", "sqrt(g) < x"])
def test_units_whose_base_unit_is_undefined_were_an_internal_error(formula):
    text = "input float v [dBm*m]  input float g [g_e]  input float x [m]  "
    (finding,) = rtamt.parse(text + formula).warnings
    assert (finding.code, finding.severity) == ("RT303", "note")


def test_units_of_imported_declarations_are_checked(tmp_path):
    (tmp_path / "car.stl").write_text("input float v [m/s]\nconst float most = 30 [km/h]\n")
    text = 'import "car.stl"\nalways(v <= most)'
    (finding,) = rtamt.parse(text, folder=tmp_path).warnings
    assert (finding.code, text[finding.span.start : finding.span.end]) == ("RT302", "v <= most")


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("forall c in cars: c.x > gap and c.v * 2 > 3", []),
        ("forall a in cars: forall b in cars where a != b: abs(a.x - b.x) > 2 * a.x", []),
        ("(count c in cars: c.x > 3) > 2 and (count c in cars: c.v > 3) * gap > gap", []),
        ("forall c in cars: c.v > gap", ["c.v > gap"]),
        ("exists c in cars: c.x > 3 and c.x + c.v > 3", ["c.x + c.v"]),
        ("(count c in cars: c.x > 3) > gap", ["(count c in cars: c.x > 3) > gap"]),
    ],
)
def test_fields_of_groups_have_units(formula, expected):
    text = 'group cars = "car_*" { float x [m]; float v [m/s] }  input float gap [m]  '
    spans = [finding.span for finding in rtamt.parse(text + formula).warnings]
    assert [(text + formula)[span.start : span.end] for span in spans] == expected


def test_every_operator_of_numbers_has_a_rule_for_units():
    numeric = [op for op in STL if Sort.NUMBER in (*op.operands, op.result) and not op.presence]
    assert [op.name for op in numeric if op.units is None] == []
