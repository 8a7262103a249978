"""What Breach's files declare: signals with roles, parameters with several values, and computed bounds."""

import pytest

import rtamt
from rtamt.interchange.breach import read_breach, write_breach


def test_signals_of_breach_have_roles() -> None:
    found = read_breach(
        "param c=1\n input signal x, y\noutput signal g\nphi := alw (x[t] + y[t] > c => ev_[0,1] g[t] >= 3)"
    )
    assert found.converted == ("phi",)
    spec = rtamt.parse(found.text)
    assert spec.roles == {"x": "input", "y": "input", "g": "output"}
    assert str(spec.requirements["phi"].formula) == "always(x + y > 1 -> eventually[0:1](g >= 3))"


@pytest.mark.parametrize(
    ("bounds", "interval"),
    [
        ("[tf-2*d, tf]", "[39.6:40]"),
        ("[0, t1+.1]", "[0:1.1]"),
        ("[7.5*scale, 12.5*scale]", "[0.000000075:0.000000125]"),
        ("[d, (t1+2)/3]", "[0.2:1]"),
        ("[0, t1/3]", "[0:1/3]"),
        ("[-(d - t1), tf]", "[0.8:40]"),
    ],
)
def test_bounds_of_breach_are_computed_exactly(bounds: str, interval: str) -> None:
    found = read_breach(f"param tf=40, d=0.2, t1=1, scale=1e-8\nphi := ev_{bounds} (x[t] > 1)")
    assert str(rtamt.parse(found.text).requirements["phi"].formula) == f"eventually{interval}(x > 1)"


@pytest.mark.parametrize(
    ("bounds", "reason"),
    [
        (
            "[0, x[t]+1]",
            "the interval [0, x[t]+1] cannot be computed: 'x' is not declared; declared names: a",
        ),
        ("[0, a/(a-a)]", "the interval [0, a/(a-a)] cannot be computed: '2 / (2 - 2)' divides by 0"),
        ("[0, abs(a)]", "the interval [0, abs(a)] cannot be computed: 'abs(2)' is no arithmetic of numbers"),
        ("[0, inf-1]", "the interval [0, inf-1] cannot be computed: 'inf' is no arithmetic of numbers"),
        ("[0, a-3]", "'-1' is no bound of Breach, whose bounds are numbers or parameters"),
    ],
)
def test_bounds_of_breach_that_have_no_value(bounds: str, reason: str) -> None:
    (rejected,) = read_breach(f"param a=2\nphi := ev_{bounds} (x[t] > 1)").rejected
    assert rejected.reason.partition("\n")[0] == reason


def test_a_formula_of_breach_has_the_parameters_declared_before_the_next_one() -> None:
    text = """\
param limit = 3, t_end = 20
far := abs(x[t]) >= limit
early := alw_[0, t_end] (not far)
param t_end = 25, limit = 4
late := alw_[0, t_end - 2] (not far)
last := x[t] > limit
param limit = 5
"""
    spec = rtamt.parse(read_breach(text).text)
    assert {name: str(each.formula) for name, each in spec.requirements.items()} == {
        "early": "always[0:25](not(abs(x) >= 4))",
        "late": "always[0:23](not(abs(x) >= 4))",
        "last": "x > 5",
    }
    assert spec.parameters == {}


def test_a_chain_of_comparisons_was_read_as_in_this_language() -> None:
    (rejected,) = read_breach("P := alw (1 < x[t] < 3)").rejected
    assert rejected.reason.splitlines()[0] == (
        "Breach has no chains of comparisons: use parentheses, or join two of them with 'and'"
    )
    assert not read_breach("P := 1 < x[t] and x[t] < 3").rejected


def test_unequal_numbers_were_written_with_a_symbol_that_breach_does_not_have() -> None:
    found = write_breach(rtamt.parse("require P: always(x != 3 or y > 1)"))
    assert found.text == "signal x, y\n\nP := alw (not(x[t] == 3) or y[t] > 1)\n"
    assert str(rtamt.parse(read_breach(found.text).text).formula) == "always(not(x == 3) or y > 1)"
    (rejected,) = read_breach("P := x[t] != 3").rejected
    assert rejected.reason.splitlines()[0] == "Breach has no '!'"


def test_equality_of_breach_has_a_note() -> None:
    note = "Breach takes '==' as true within 1e-13, with a robustness of its own; here it is exact"
    assert read_breach("P := x[t] == 3").notes[2:] == (note,)
    assert write_breach(rtamt.parse("require P: x == 3")).notes[2:] == (note,)
    assert len(read_breach("P := x[t] > 3").notes) == 2


def test_formulas_of_breach_had_names_that_it_does_not_read() -> None:
    text = 'require "P 1": x > 1\nrequire P_1: x > 2\nrequire "1st": x > 3\nrequire alw: x > 4\nrequire "x ": x > 5'
    found = write_breach(rtamt.parse(text))
    names = ["P_1", "P_1_2", "R_1st", "alw_2", "x_"]
    assert [line.partition(" :=")[0] for line in found.text.splitlines()[2:]] == names
    assert read_breach(found.text).converted == tuple(names)
