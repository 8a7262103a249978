"""Questions about requirements, and what their answers say."""

import sys

import numpy as np
import pytest

import rtamt
from rtamt.analysis import NotCoveredError, analyze, diff, equivalent, implies, satisfiable, valid
from rtamt.errors import UsageError


def sentence_of(spec, **settings):
    return [str(finding) for finding in analyze(rtamt.parse(spec), samples=20, **settings).findings]


def test_a_requirement_that_no_long_trace_satisfies_is_shown_with_a_short_one():
    answer = satisfiable(rtamt.parse("always(x > 0 and next(x < 0))"), samples=10)
    assert str(answer) == "no trace of 10 samples satisfies it; a trace of 1 sample does"
    assert answer.finding
    assert answer.witness.confirmed


def test_a_counterexample_has_a_visible_margin_and_is_confirmed_by_the_engine():
    spec = rtamt.parse("always(req >= 3 -> eventually[0:2](gnt >= 3))")
    answer = valid(spec)
    assert (answer.holds, answer.finding) == (False, False)
    assert answer.witness.confirmed
    assert answer.witness.margin >= 0.1
    assert spec.evaluate(answer.witness.data).satisfied is False


def test_strict_and_other_comparisons_differ():
    assert implies(rtamt.parse("x > 3"), rtamt.parse("x >= 3")).holds is True
    back = implies(rtamt.parse("x >= 3"), rtamt.parse("x > 3"))
    assert back.holds is False
    assert back.witness.columns["x"][0] == 3.0


def test_rates_of_change_bound_how_fast_a_trace_rises():
    text = "float x in [0, 10] rate [-1, 2]  sample 500ms  not (x <= 0 and eventually[0:{end}](x >= 10))"
    assert valid(rtamt.parse(text.format(end="4.5s"))).sentence == (
        "it always holds: no counterexample of any length"
    )
    answer = valid(rtamt.parse(text.format(end="5s")))
    assert answer.witness.columns["x"][:11].tolist() == [float(i) for i in range(11)]


def test_booleans_and_enumerations_have_their_declared_values_only():
    text = "enum Mode { OFF, ON, FAULT }  input Mode mode  input bool armed  {}"
    assert valid(rtamt.parse(text.replace("{}", "mode == OFF or mode == ON or mode == FAULT"))).holds is True
    found = satisfiable(rtamt.parse(text.replace("{}", "always(armed -> mode == ON) and armed")), samples=3)
    assert found.witness.columns["mode"][0] == 1.0


def test_a_rate_that_is_reached_exactly_is_no_matter_of_rounding():
    text = "float x in [0, 10] rate [-1, 1]  sample 100ms  x == 0 -> always[0:5s](x <= 5)"
    assert valid(rtamt.parse(text), samples=60).sentence == "it always holds: no counterexample of any length"


def test_formulas_without_signals_have_traces_of_some_length():
    assert analyze(rtamt.parse("require A: 3 > 2; require B: always(x > 3)"), samples=9).findings[
        0
    ].names == ("A",)
    assert valid(rtamt.parse("always(next(3 < 2))"), samples=4).witness.confirmed


@pytest.mark.parametrize("n", [2, 7, 8, 9, 30])
def test_a_violation_that_needs_so_many_samples_is_found_with_them_and_not_with_fewer(n):
    spec = rtamt.parse(f"always(not (once[{n - 1}:{n - 1}](true) and historically[0:{n - 1}](x > 0)))")
    assert valid(spec, samples=n).witness.samples == n
    assert valid(spec, samples=n - 1).sentence.endswith(f"up to {n - 1} sample{'s' * (n > 2)}")


def test_findings_name_the_requirements_of_a_contradiction():
    assert sentence_of(
        "require A: always(x > 3); require B: always(y > 3); require C: always(x < y and y < 3)"
    ) == ["B, C: they contradict each other: no trace of 20 samples satisfies them together"]


def test_findings_name_what_implies_a_redundant_requirement():
    assert sentence_of("require A: always(x > 3); require B: always(y > x); require C: always(y > 2)") == [
        "C: it is redundant, because A and B imply it: no counterexample up to 20 samples"
    ]


def test_a_condition_that_only_violating_traces_trigger_is_vacuous():
    (finding,) = analyze(rtamt.parse("always(x > 5 -> x < 3)"), samples=20).findings
    assert finding.sentence == (
        "it holds only where 'x > 5' is never true: no trace up to 20 samples satisfies it with that true"
    )
    assert finding.witness.confirmed


def test_conditions_that_no_recording_triggers_are_findings():
    spec = rtamt.parse("always(x > 5 -> y > 3)")
    quiet, loud = ({"x": np.array([1.0, each]), "y": np.zeros(2)} for each in (2.0, 9.0))
    assert analyze(spec, samples=9, recordings={"a": quiet, "b": loud}).findings == ()
    (finding,) = analyze(spec, samples=9, recordings={"a": quiet, "b": quiet}).findings
    assert finding.sentence == "it is vacuous on the given recordings: 'x > 5' is never true in 2 recordings"


def test_what_is_not_covered_is_said_and_nothing_else_is_concluded_from_it():
    analysis = analyze(
        rtamt.parse("require A: always(x * y > 3); require B: always(x > 3); require C: x > 0"), samples=9
    )
    assert analysis.notes == (
        "A: 'x * y' is not covered by the analysis: a product of two signals is nonlinear",
        "B has unbounded operators: traces longer than 9 samples are not covered",
    )
    assert not any("A" in each.names for each in analysis.conclusions)


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        (
            "always(sqrt(x) > 3)",
            {},
            "'sqrt(x)' is not covered by the analysis: 'sqrt' is not linear\n  line 1, column 8:\n"
            "    always(sqrt(x) > 3)\n           ^^^^^^^",
        ),
        (
            "optional float x  always(not valid(x))",
            {},
            "'valid(x)' is not covered by the analysis: it depends on missing samples\n  line 1, column 30:\n"
            "    optional float x  always(not valid(x))\n                                 ^^^^^^^^",
        ),
        (
            "always(x > 3)",
            {"time": "dense"},
            "dense time is not covered by the analysis, which counts samples: read the specification in discrete time",
        ),
        (
            'group cars = "car_*"  forall v in cars: always(v.x > 3)',
            {},
            "quantifiers are not covered by the analysis: choose the members of 'cars' with spec.over(...)",
        ),
    ],
)
def test_messages_for_what_is_not_covered(text, settings, message):
    with pytest.raises(NotCoveredError) as error:
        valid(rtamt.parse(text, **settings))
    assert str(error.value) == message


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"samples": 0}, "samples is 0; give a number of samples, 1 or more"),
        ({"limit": -1}, "limit is -1; give a number of seconds above 0"),
    ],
)
def test_messages_for_settings(settings, message):
    with pytest.raises(UsageError) as error:
        valid(rtamt.parse("x > 3"), **settings)
    assert str(error.value) == message


def test_messages_for_specifications_that_cannot_be_compared():
    first = rtamt.parse("bool x  always(x)")
    with pytest.raises(UsageError, match="the types of 'x' differ: declare the same type in both"):
        equivalent(first, rtamt.parse("always(x > 0)"))
    with pytest.raises(UsageError, match="the units of 'v' differ: declare the same unit in both"):
        equivalent(rtamt.parse("float v [m/s]  v < 30"), rtamt.parse("float v [km/h]  v < 30"))
    with pytest.raises(UsageError, match="the sampling periods differ, 100 ms and 1 s"):
        equivalent(first, rtamt.parse("bool x  always(x)", period="100ms"))


NOTHING = "no value on any trace up to 20 samples: evaluations report an error"


@pytest.mark.parametrize("text", ["clip(x, 5, 3) > 0", "x > 100 -> clip(x, 5, 3) > 0"])
def test_a_requirement_without_a_value_on_any_trace_neither_holds_nor_implies(text):
    spec = rtamt.parse(text)
    for ask in (valid, satisfiable):
        answer = ask(spec, samples=20)
        assert (answer.holds, answer.finding) == (False, True)
        assert answer.sentence == f"it has {NOTHING}"
    answer = implies(spec, rtamt.parse("x > 0"), samples=20)
    assert (answer.holds, answer.sentence) == (None, f"they have {NOTHING}")
    assert sentence_of(f"require R: {text}") == [f"R: it has {NOTHING}"]
    assert diff(spec, rtamt.parse(text), samples=20).conclusions[0].holds is True


def test_limits_of_one_specification_hold_for_the_other_and_must_not_differ():
    free, narrow = rtamt.parse("x < 100"), rtamt.parse("float x in [0, 20]  x < 30")
    assert implies(free, narrow).holds is True
    assert implies(free, rtamt.parse("float x  x < 30")).holds is False
    with pytest.raises(UsageError) as error:
        equivalent(narrow, rtamt.parse("float x in [0, 10]  x < 30"))
    assert str(error.value) == "the ranges of 'x' differ: declare the same range in both specifications"


def test_whole_numbers_are_named_in_a_note():
    found = analyze(rtamt.parse("int n  long m  int unused  n > 3 or m > 2"), samples=5)
    assert found.notes == ("n and m are whole numbers: traces have any number there, as recordings may",)


def test_degrees_and_radians_are_covered():
    answer = valid(rtamt.parse("input float x in [0, 90]  radians(x) <= 1.58 and degrees(radians(x)) <= 91"))
    assert answer.holds is True


def test_versions_that_read_other_data_differ():
    old = """
        input float speed in [0, 60]
        input int n
        input float gap
        sample 100ms
        always(speed <= 50 and n + gap > 3)"""
    new = old.replace("60", "80").replace("n\n", 'n = "count"\n').replace("100ms", "100ms hold for 1s")
    new = new.replace("input float gap", "optional input float gap")
    found = diff(rtamt.parse(old), rtamt.parse(new), samples=5)
    assert [(each.question, each.sentence) for each in found.findings] == [
        ("data", "the sampling rule has changed from 'sample 100ms' to 'sample 100ms hold for 1s'"),
        ("data", "the recorded name of 'n' has changed from 'n' to 'count'"),
        ("data", "'gap' is optional now"),
    ]
    assert (
        found.notes[-1]
        == "the range of 'speed' has changed from [0, 60] to [0, 80]: traces stay in the new one"
    )
    assert not diff(rtamt.parse(new), rtamt.parse(new), samples=5).findings


LONG = """
    output float pitch
    output float yaw
    sample 10ms
    def within(command) = always(not (once[1s:1s](true) and historically[0:1s](abs(command) > 50)))
    def smooth(command) = always(s_prev(true) -> abs(rate[10ms](command)) <= 50)
    require LIMIT: within(pitch)
    require RATE: smooth(pitch)
    require YAW: smooth(yaw)"""


def test_windows_of_a_hundred_samples_are_answered_by_traces_that_change_rarely():
    found = analyze(rtamt.parse(LONG))
    assert not found.unanswered
    assert not found.findings
    redundant = {each.names[0]: each.witness for each in found.conclusions if each.question == "redundant"}
    assert redundant["LIMIT"].samples == 200
    assert len(set(redundant["LIMIT"].columns["pitch"].tolist())) <= 14
    assert redundant["LIMIT"].confirmed


def test_a_signal_that_must_change_at_every_sample_is_found_too():
    text = "float x rate [1, 3]  sample 1s  always(x <= 25) -> eventually[0:20](x >= 24)"
    answer = satisfiable(rtamt.parse(text), samples=21)
    assert answer.witness.confirmed
    assert all(1 <= step <= 3 for step in np.diff(answer.witness.columns["x"]))


def test_no_answer_within_the_limit_is_said():
    text = " and ".join(f"always(floor(x * {k}.5) + floor(y / {k}) != {k})" for k in range(3, 9))
    answer = valid(
        rtamt.parse(f"float x in [0, 1000]  float y in [0, 1000]  not ({text} and always(abs(x - y) > 1))"),
        limit=0.001,
    )
    assert answer.holds is None
    assert answer.sentence == "'valid' has no answer within 0.001 s; use fewer samples or a longer limit"


def test_a_trace_that_doubles_do_not_confirm_leaves_the_question_open():
    answer = satisfiable(rtamt.parse("x / 3 * 3 == 1e17 + 1 and y == 1e17 + 1 and y - 1e17 == 1"), samples=1)
    assert (answer.holds, answer.finding, answer.witness.confirmed) == (None, False, False)
    assert answer.sentence == (
        "'satisfiable' is open: over the reals there is a trace of 1 sample, on which doubles lead to another verdict"
    )


def test_what_is_valid_over_the_reals_may_fail_in_doubles():
    spec = rtamt.parse("x + y - y >= x")
    assert valid(spec).holds is True
    assert spec.evaluate({"x": [0.1], "y": [1e17]}).satisfied is False


def test_without_the_solver_the_message_names_the_extra(monkeypatch):
    from rtamt.analysis import solver

    for name in ("_core", "_types"):
        getattr(solver, name).cache_clear()
    monkeypatch.setitem(sys.modules, "z3.z3core", None)
    with pytest.raises(UsageError) as error:
        valid(rtamt.parse("x > 3"))
    assert str(error.value) == (
        "the analysis of requirements needs the package 'z3', which is not installed: pip install 'rtamt[analysis]'"
    )


def test_numbers_beyond_doubles_are_no_overflow_error():
    answer = valid(rtamt.parse("x <= 1e308"))
    assert answer.holds is False
    assert answer.witness.confirmed
    assert answer.witness.columns["x"].max() == 1.7976931348623157e308
