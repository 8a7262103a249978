"""Comments that silence findings, and what they leave."""

import pytest

from rtamt.language.parsing.specfile import parse_document
from rtamt.lint.report import findings

PREV = "prev(x) - x <= 3"


def codes(text):
    return [each.code for each in findings(parse_document(text))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"{PREV} // lint: ignore[RT105]", []),
        (f"{PREV} // as in the manual; lint: ignore[RT105, RT101]", ["RT001"]),
        (f"{PREV} /* lint: ignore[RT105] */", []),
        (f"// lint: ignore[RT105]\n{PREV}", []),
        (f"// lint: ignore[RT105]\r\n// for now\r\n\r\n{PREV}", []),
        (f"// lint: ignore[RT105]\nx > 1;\n{PREV}", ["RT001", "RT105"]),
        (f"{PREV};\nx > 1 // lint: ignore[RT105]", ["RT105", "RT001"]),
        (f'a = {PREV}; "// lint: ignore[RT105]" > 1', ["RT105"]),
        (f"{PREV} // lint: ignore[RT999]", ["RT105", "RT001"]),
        (f"{PREV} // lint: ignore", ["RT105"]),
        ("x and y > 1 and z // lint: ignore[RT101]", []),
    ],
)
def test_what_a_comment_silences(text, expected):
    assert codes(text) == expected


def test_a_code_without_effect_is_shown_in_its_comment():
    (found,) = findings(parse_document("x > 1 // lint: ignore[RT15]"))
    assert str(found) == (
        "RT001: there is no code 'RT15'; did you mean 'RT105'?\n"
        "  line 1, column 23:\n"
        "    x > 1 // lint: ignore[RT15]\n"
        "                          ^^^^"
    )
