"""Names in different Unicode forms: they are compared as they are, and errors say what differs."""

import unicodedata

import pytest

import rtamt
from rtamt.errors import ParseError, TraceError

NFC = "\u00e9"
NFD = unicodedata.normalize("NFD", NFC)
INVISIBLE = (
    f"'{NFD}' has the combining character U+0301, and names without quotes have none: normalise the text to Unicode "
    f'NFC, or write "{NFD}", as the data has it'
)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("{} >= 3", (0, 2)),
        ("x >= 3 and {} >= 3", (11, 13)),
        ("input float {}; x >= 3", (12, 14)),
        ('input float "{0}"; {0} >= 3', (18, 20)),
        ("const float {} = 3; x >= 3", (12, 14)),
        ("require {}: x >= 3", (8, 10)),
        ("def {}(x) = x >= 3; x >= 3", (4, 6)),
        ("def f(x) = {} >= x; f(3)", None),
    ],
)
def test_a_letter_with_its_accent_apart_is_no_unexpected_character(text, place):
    with pytest.raises(ParseError) as caught:
        rtamt.parse(text.format(NFD))
    assert caught.value.message.startswith(INVISIBLE)
    if place is not None:
        assert (caught.value.span.start, caught.value.span.end) == place


def test_a_script_that_has_only_combining_characters_needs_quotes():
    name = "\u0928\u092e\u0938\u094d\u0924\u0947"
    with pytest.raises(ParseError) as caught:
        rtamt.parse(f"{name} >= 3")
    assert caught.value.message == (
        f"'{name}' has the combining character U+094D, and names without quotes have none: write \"{name}\", as the "
        f"data has it"
    )
    assert rtamt.parse(f'"{name}" >= 3').evaluate({name: [5]}).robustness == 2


def test_other_errors_beside_combining_characters_are_their_own():
    with pytest.raises(ParseError) as caught:
        rtamt.parse(f'"{NFD}" >= 3 and')
    assert caught.value.message == "expected an operand after 'and', got the end of the text"


@pytest.mark.parametrize(
    ("asked", "given"), [(NFC, NFD), (NFD, NFC), ("\u00b5", "\u03bc"), ("\u2126", "\u03a9")]
)
def test_names_that_look_alike_are_told_apart(asked, given, tmp_path):
    alike = (
        f"; '{given}' differs from it in its Unicode form only: normalise both, such as with "
        f"unicodedata.normalize('NFKC', name)"
    )
    lacks, has_not = (
        f"the data has no '{asked}'{alike}",
        "the formula has no variable '{}'; '{}' differs from it",
    )
    spec, dense = rtamt.parse(f'"{asked}" >= 3'), rtamt.parse(f'"{asked}" >= 3', time="dense")
    (tmp_path / "a.csv").write_text(f"time,{given}\n0,5\n1,5\n", "utf-8")
    data = {given: [5.0, 5.0]}
    calls = {
        lambda: spec.evaluate(data): lacks,
        lambda: dense.evaluate({given: ([0, 1], [5.0, 5.0])}): lacks,
        lambda: spec.evaluate(
            rtamt.read(tmp_path / "a.csv")
        ): f"{tmp_path / 'a.csv'} has no '{asked}'{alike}",
        lambda: rtamt.read(tmp_path / "a.csv", columns=[asked]): f"a.csv has no column '{asked}'{alike}",
        lambda: spec.monitor().update_many(data): lacks,
        lambda: spec.monitor().update(0, **{given: 5.0}): has_not.format(given, asked),
        lambda: spec.monitor(verdict="eager").update(0, **{given: 5.0}): has_not.format(given, asked),
        lambda: dense.monitor().update(0, **{given: 5.0}): has_not.format(given, asked),
    }
    for call, message in calls.items():
        with pytest.raises(TraceError) as caught:
            call()
        assert message in str(caught.value)
    assert spec.evaluate({asked: [5.0], given: [0.0]}).robustness == 2
