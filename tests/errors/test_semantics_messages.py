"""Every sentence about semantics and roles, in full."""

import pytest

import rtamt
from rtamt.language.formula import Var
from rtamt.rewrite.semantics import SEMANTICS

NAMES = "standard, output_robustness, input_vacuity, input_robustness, output_vacuity, boolean"


def message_of(call):
    with pytest.raises(rtamt.UsageError) as info:
        call()
    return str(info.value)


@pytest.mark.parametrize(
    "call",
    [
        lambda wrong: rtamt.parse("x", semantics=wrong),
        lambda wrong: rtamt.robustness("x", {"x": [1]}, semantics=wrong),
        lambda wrong: rtamt.parse("x").evaluate({"x": [1]}, semantics=wrong),
        lambda wrong: rtamt.parse("x").monitor(semantics=wrong),
    ],
)
def test_an_unknown_semantics(call):
    assert message_of(lambda: call("output_robustnes")) == (
        "unknown semantics 'output_robustnes'; did you mean 'output_robustness'? (semantics: output_robustness, "
        "input_robustness, output_vacuity, standard, input_vacuity, boolean)"
    )
    assert message_of(lambda: call(3)) == f"unknown semantics 3; semantics: {NAMES}"
    assert message_of(lambda: call(rtamt.Semantics)) == (
        f"unknown semantics <enum 'Semantics'>; semantics: {NAMES}"
    )


def test_wrong_roles():
    assert message_of(lambda: rtamt.parse("req >= 3", roles={"rec": "input"})) == (
        "roles has 'rec', which the specification neither reads nor declares; did you mean 'req'?"
    )
    assert message_of(lambda: rtamt.parse("req >= 3", roles={"req": "in"})) == (
        "the role of 'req' is 'in'; choose 'input' or 'output'"
    )


def no_formula(_predicate, _roles):
    return 3


def another_variable(_predicate, _roles):
    return Var("z")


@pytest.mark.parametrize(
    ("judge", "sentence"),
    [
        (
            no_formula,
            "the semantics 'no_formula' returned 3 for the predicate 'x >= 3'; return a formula",
        ),
        (
            another_variable,
            "the semantics 'another_variable' returned 'z' for the predicate 'x >= 3', which does not "
            "read 'z'; use the predicate's own variables",
        ),
    ],
)
def test_a_function_that_returns_something_else(judge, sentence):
    spec = rtamt.parse("always(x >= 3)")
    assert message_of(lambda: spec.evaluate({"x": [1]}, semantics=judge)) == sentence


@pytest.mark.parametrize("semantics", SEMANTICS)
def test_the_other_sentences_are_the_same_under_every_semantics(semantics):
    spec = rtamt.parse("x >= 3 and always(y >= 3)", roles={"x": "input"}, semantics=semantics)
    with pytest.raises(rtamt.BoundError) as info:
        spec.monitor()
    assert str(info.value) == (
        "'always' without an upper bound needs the whole future and cannot be monitored online; "
        "give it a bound, such as always[0:10], evaluate the finished trace offline, "
        "or monitor its bounds or verdicts (verdict='interval', 'eager')\n"
        "  line 1, column 12:\n"
        "    x >= 3 and always(y >= 3)\n"
        "               ^^^^^^^^^^^^^^"
    )
    bounded = rtamt.parse("not once[0:150ms](x >= 3)", semantics=semantics)
    for call in (
        lambda: bounded.evaluate({"x": [1]}, period="100ms"),
        lambda: bounded.monitor(period="100ms"),
    ):
        with pytest.raises(rtamt.BoundError) as info:
            call()
        assert str(info.value) == (
            "The operator bound must be a multiple of the sampling period: 150 ms is not a whole number of "
            "periods of 100 ms; change the bound or the period\n"
            "  line 1, column 9:\n"
            "    not once[0:150ms](x >= 3)\n"
            "            ^^^^^^^^^"
        )
