"""The patterns of the library, and what ``rtamt new`` writes from them."""

import re

import pytest

import rtamt
from rtamt.errors import ParseError, UsageError
from rtamt.patterns import find_pattern, patterns, specification_of

#: An argument for each parameter: durations, times and numbers by their names.
DURATIONS = ("duration", "window", "width", "within", "after", "shortest", "longest")


def argument(pattern, name):
    if name in DURATIONS or (name == "limit" and pattern.name != "bounded_rate"):
        return "2s"
    if len(name) == 1:
        return name if name == "x" else f"{name} > 1"
    return "3"


@pytest.mark.parametrize("pattern", patterns().values(), ids=patterns())
def test_every_pattern_has_a_sentence_with_its_parameters_and_becomes_a_specification(pattern):
    assert set(re.findall(r"`(\w+)`", pattern.sentence)) == set(pattern.parameters)
    texts = {name: argument(pattern, name) for name in pattern.parameters}
    spec = rtamt.parse(specification_of(pattern, texts, "R-7"), period=1)
    (requirement,) = spec.document.requirements
    assert (requirement.name, requirement.description) == ("R-7", pattern.described(texts))
    assert "`" not in requirement.description
    assert spec.warnings == ()


def test_the_patterns_are_those_of_the_library_without_their_helpers():
    names = set(patterns())
    assert {"absence_between", "response_within", "settles", "precedence_between"} <= names
    assert not names & {
        "within_scope",
        "occurrences",
        "reaches",
        "reaches_later",
        "spike_ends",
        "swung_up",
        "swings",
    }


def test_sentences_have_scopes():
    texts = {"p": "open", "q": "speed > 2", "r": "speed < 1"}
    assert find_pattern("absence_between").described(texts) == (
        "Between each (speed is more than 2) and the next (speed is less than 1), open never holds."
    )
    assert find_pattern("absence_until").sentence.startswith(
        "from each `q` until the next `r`, which may never come, "
    )
    assert (
        find_pattern("stays").described({"x": "v", "low": "0", "high": "50"}) == "v stays between 0 and 50."
    )


def test_what_is_wrong_is_said():
    with pytest.raises(UsageError) as failure:
        find_pattern("respons")
    assert str(failure.value).startswith("there is no pattern 'respons'; did you mean 'response'?")
    response = find_pattern("response")
    with pytest.raises(UsageError) as failure:
        specification_of(response, {"p": "x > 1"})
    assert str(failure.value) == "response(p, s) needs s: give s=..."
    with pytest.raises(UsageError) as failure:
        specification_of(response, {"p": "x > 1", "s": "y > 1", "z": "1"})
    assert str(failure.value).startswith("response(p, s) has no parameter 'z'")
    with pytest.raises(ParseError) as syntax:
        specification_of(response, {"p": "x >", "s": "y > 1"})
    assert str(syntax.value).startswith("p of response(p, s): expected an operand after '>'")
