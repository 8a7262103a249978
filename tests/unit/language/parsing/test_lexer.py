"""Text to tokens."""

import time

import pytest

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_word, quoted, tokenize, unquoted


def texts(text):
    return [token.text for token in tokenize(text, STL)[:-1]]


def kinds(text):
    return [token.kind for token in tokenize(text, STL)]


@pytest.mark.parametrize("text", ["3", "0.5", ".5", "5.", "1e-3", "1.5E+10", "1_000", "1_0.0_1e1_0"])
def test_numbers(text):
    assert texts(text) == [text]
    assert kinds(text) == ["number", "end"]


@pytest.mark.parametrize("text", ["x", "req.value", "a.b.c_1", "$x", "_", "é", "s_prev", "名前"])
def test_names(text):
    assert texts(text) == [text]
    assert kinds(text) == ["name", "end"]


@pytest.mark.parametrize(
    ("text", "tokens"),
    [
        ("a<->b", ["a", "<->", "b"]),
        ("a<-b", ["a", "<", "-", "b"]),
        ("a!==b!=c", ["a", "!==", "b", "!=", "c"]),
        ("a&&b&c||d|e", ["a", "&&", "b", "&", "c", "||", "d", "|", "e"]),
        ("a=>b>=c==d=e", ["a", "=>", "b", ">=", "c", "==", "d", "=", "e"]),
        ("[0:500ms]", ["[", "0", ":", "500", "ms", "]"]),
        ("1.2.3", ["1.2", ".3"]),
        ("x.1", ["x", ".1"]),
    ],
)
def test_the_longest_symbol_wins(text, tokens):
    assert texts(text) == tokens


@pytest.mark.parametrize(
    "text",
    [
        "a // b ?\n and /* ) ? \n // */ b",
        "/**/a/***/and/* * / */b//",
        "\r\n\t a\f and\vb \u00a0",
    ],
)
def test_comments_and_white_space_are_skipped(text):
    assert texts(text) == ["a", "and", "b"]


def test_what_follows_a_comment_is_never_read_out_of_it():
    assert kinds("x // a\n?") == ["name", "unknown", "end"]
    assert kinds("x /* a") == ["name", "unclosed", "end"]
    assert kinds('"x') == ["unclosed", "end"]


def test_places():
    tokens = tokenize("  a >=\n 3  ", STL)
    assert [token.span for token in tokens] == [Span(2, 3), Span(4, 6), Span(8, 9), Span(9, 9)]


@pytest.mark.parametrize("name", ["", "engine speed", 'a "b"', '"', "a\nb", "// no comment"])
def test_quoted_names(name):
    (token, _end) = tokenize(quoted(name), STL)
    assert token.kind == "quoted"
    assert unquoted(token.text) == name


def test_every_spelling_is_one_token():
    for op in STL:
        for spelling in op.spellings:
            assert texts(f" {spelling} ") == [spelling]
            assert kinds(spelling) == ["name" if is_word(spelling) else "symbol", "end"]


@pytest.mark.parametrize("opening", ["/*", '"', "/* ", 'a "', "//", "/*/"])
def test_time_does_not_grow_with_the_square_of_openings_without_an_end(opening):
    start = time.process_time()
    tokens = tokenize(opening * 100_001, STL)
    assert tokens[-1].kind == "end"
    assert time.process_time() - start < 5


def test_tokens_between_two_places_end_where_the_last_one_does():
    part = tokenize("a and (b) or c", STL).between(1, 4)
    assert [token.text for token in part] == ["and", "(", "b", ""]
    assert part[-1] == ("end", "", 8, 8)
