"""Syntax error messages: one sentence and the position for each kind of error."""

from __future__ import annotations

from rtamt.errors import choices, did_you_mean
from rtamt.language.formula import Span
from rtamt.language.operators import Fixity
from rtamt.language.parsing.lexer import NAME, NO_ARROW, is_word, quoted
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.operators import Language
    from rtamt.language.parsing.lexer import Token

    Complaint = tuple[str, Span]
    Tokens = Sequence[Token]

#: Replacements for characters of other notations.
_MEANT = {
    "#": "a comment begins with //",
    **{
        character: f"write {text}"
        for characters, text in {
            "≥⩾": ">=",
            "≤⩽": "<=",
            "≠": "!=",
            "∧⋀": "and",
            "∨⋁": "or",
            "¬": "not",
            "→⇒⟶⟹": "->",
            "↔⇔⟷⟺": "<->",
            "⊕⊻": "xor",
            "□☐◻": "always",
            "◇◊⋄♢": "eventually",
            "∞": "inf",
            "×·⋅": "*",
            "÷": "/",
            "−–—": "-",
            "^": "pow(x, 2) for a power",
            "~": "not",
            "“”„'‘’`": 'names in double quotes, such as "engine speed"',
            "{}": "intervals in brackets, such as always[0:5], and formulas in parentheses",
        }.items()
        for character in characters
    },
}


#: Replacements for operators of other notations that are two tokens here: before an operand, and between two.
_MEANT_BEFORE = {"[]": "always", "<>": "eventually"}
_MEANT_BETWEEN = {"**": "pow(x, 2) for a power", "<>": "!=", "=<": "<=", "==>": "->"}


def no_operand(tokens: Tokens, at: int) -> Complaint:
    """Return the error for a missing operand."""
    token = tokens[at]
    bad = _bad_character(token)
    if bad is not None:
        return bad
    foreign = _foreign(tokens, at, _MEANT_BEFORE) or _foreign(tokens, at - 1, _MEANT_BETWEEN)
    if foreign is not None:
        return foreign
    hint = "; write abs(x) for an absolute value" if token.text == "|" else ""
    if at == 0:
        message = "the text is empty" if token.kind == "end" else f"expected a formula, got {token}{hint}"
        return message, token.span
    return f"expected an operand after {tokens[at - 1]}, got {token}{hint}", token.span


def _foreign(tokens: Tokens, at: int, meant: Mapping[str, str]) -> Complaint | None:
    """Return the error for an operator of another notation that is read as two tokens."""
    if at < 0 or at + 1 >= len(tokens) or tokens[at].end != tokens[at + 1].start:
        return None
    first, second = tokens[at : at + 2]
    if first.text + second.text not in meant:
        return None
    text = first.text + second.text
    return f"'{text}' is no operator; write {meant[text]}", Span(first.start, second.end)


def no_operator(language: Language, tokens: Tokens, at: int, expected: str = "the end") -> Complaint:
    """Return the error for a missing operator (or a missing ``expected``)."""
    token, before = tokens[at], tokens[at - 1]
    bad = _bad_character(token)
    if bad is not None:
        return bad
    if token.text == NO_ARROW:
        return f"'{NO_ARROW}' is no operator; write '->' for an implication, '>=' for at least", token.span
    if token.text == "=":
        return "'=' gives a name to a formula; use == for equality", token.span
    if token.text in (")", "]"):
        opening = {")": "(", "]": "["}[token.text]
        return f"expected an operator or {expected}, got {token}, which no '{opening}' opens", token.span
    if token.text == "[" and (name := _element(tokens, at)):
        return (
            f"expected an operator or {expected}, got '['; if {name} is the name of a signal, "
            f"write it in quotes: {quoted(name)}",
            Span(before.start, token.end),
        )
    if token.text == "[":
        return f"expected an operator or {expected}, got '['; intervals follow temporal operators", token.span
    if token.text == "(" and before.kind == "name":
        functions = [s for op in language if op.fixity is Fixity.FUNCTION for s in op.spellings]
        words = [s for op in language for s in op.spellings if is_word(s) and op.fixity is not Fixity.ATOM]
        near = did_you_mean(before.text, words)
        hint = choices(before.text, functions, "functions")
        if near and near not in hint:  # always, until, ...
            hint = f"{near} ({choices('', functions, 'functions').removeprefix('; ')})"
        return f"'{before.text}' is not a function{hint}", before.span
    if token.kind in ("name", "number", "quoted") or token.text == "(" or language.opening(token.text):
        if token.kind in ("name", "number", "quoted") and is_function(language, before.text):
            return f"expected '(' after {before}, got {token}; write {before.text}(...)", token.span
        hint, meant = _misspelled(language, before, token)
        if not hint and before.kind == "number" and token.kind == "name" and tokens[at + 1].text == "/":
            hint = "; numbers have no unit: declare that of the signal, such as float speed [m/s]"
        return f"expected an operator between {before} and {token}{hint}", meant.span
    return f"expected an operator or {expected}, got {token}{_after_number(tokens, at)}", token.span


def _after_number(tokens: Tokens, at: int) -> str:
    """Return what to write instead of a character after a number, as the end of a sentence; or ""."""
    before, token = tokens[at - 1 : at + 1]
    if before.kind != "number":
        return ""
    if token.text == "%":
        return "; percentages are shares of a window, such as atleast[0:10](95%, x >= 1)"
    if token.text == "," and before.end == token.start and tokens[at + 1].start == token.end:
        after = tokens[at + 1]
        if at >= 2 and tokens[at - 2].text == "(":
            return "; intervals are in brackets, such as always[0:5]"
        if after.kind == "number" and before.text.isdigit():
            return f"; write {before.text}.{after.text} with a decimal point"
    return ""


def no_close(language: Language, tokens: Tokens, at: int, opening: Token, expected: str = "')'") -> Complaint:
    """Return the error for an unclosed parenthesis: at its opening if the text ends, else at the next token."""
    if tokens[at].kind == "end":
        return "this '(' is never closed", opening.span
    return no_operator(language, tokens, at, expected)


def no_word(tokens: Tokens, at: int, word: str) -> Complaint:
    """Return the error for a missing word of a choice."""
    token = tokens[at]
    return _bad_character(token) or (
        f"expected '{word}' after {tokens[at - 1]}, got {token}; a choice is written if x > 3 then 1 else 0, "
        f'and a variable with this name "if"',
        token.span,
    )


def _bad_character(token: Token) -> Complaint | None:
    if token.kind == "unknown":
        meant = _MEANT.get(token.text, "")
        return f"unexpected character {token}{meant and f'; {meant}'}", token.span
    if token.kind == "unclosed":
        what = "comment" if token.text == "/*" else "quoted name"
        return f"this {what} is never closed", token.span
    return None


def combining_characters(text: str, span: Span) -> Complaint | None:
    """Return the error for a name without quotes that has combining characters, at the position of another error."""
    from unicodedata import category, normalize

    def is_combining(at: int) -> bool:
        return 0 <= at < len(text) and category(text[at]).startswith("M")

    def is_in_name(at: int) -> bool:
        return 0 <= at < len(text) and (text[at].isalnum() or text[at] in "_$." or is_combining(at))

    place = next((at for at in (span.start, span.end) if is_combining(at)), None)
    if place is None:
        return None
    start, end = place, place + 1
    while is_in_name(start - 1):
        start -= 1
    while is_in_name(end):
        end += 1
    name = text[start:end]
    composed = NAME.fullmatch(normalize("NFC", name)) is not None
    return (
        f"'{name}' has the combining character U+{ord(text[place]):04X}, and names without quotes have none: "
        f"{'normalise the text to Unicode NFC, or ' if composed else ''}write {quoted(name)}, as the data has it",
        Span(start, end),
    )


def _element(tokens: Tokens, at: int) -> str:
    """Return the name that an element of an array has in logs (``q[2]``, ``battery[1].voltage``), or ""."""
    if at + 2 >= len(tokens):
        return ""
    before, opening, index, closing = tokens[at - 1 : at + 3]
    glued = before.end == opening.start and opening.end == index.start and index.end == closing.start
    if not (glued and before.kind == "name" and index.text.isdigit() and closing.text == "]"):
        return ""
    name = f"{before.text}[{index.text}]"
    after = tokens[at + 3 : at + 5]
    if (
        len(after) == 2
        and after[0].text == "."
        and after[1].kind == "name"
        and after[0].end == after[1].start
    ):
        name += f".{after[1].text}"
    return name


def is_function(language: Language, word: str) -> bool:
    """Return whether a word is an operator whose operands are in parentheses: ``rise``, ``abs``."""
    return any(op.fixity is Fixity.FUNCTION and word in op.spellings for op in language)


def _misspelled(language: Language, before: Token, token: Token) -> tuple[str, Token]:
    """Return the probably intended operator, and its position: ``x adn y``, ``alway x``."""
    infix = [s for op in language for s in op.spellings if language.infix(s) is op and len(s) > 2]
    prefix = [s for op in language for s in op.spellings if op.fixity is Fixity.PREFIX and len(s) > 2]
    for suspect, words in ((token, infix), (before, prefix)):
        hint = did_you_mean(suspect.text.lower(), words) if suspect.kind == "name" else ""
        if hint:
            return hint, suspect
    return "", token


#: How the message for comparisons in a row begins.
NO_CHAIN = "only comparisons in one direction chain"


def no_chain(text: str, whole: Span, middle: Span, symbol: Span) -> str:
    """Return the message for comparisons in a row that have no common direction."""
    first, between = text[whole.start : middle.end], text[middle.start : middle.end]
    second = f"{between} {text[symbol.start : symbol.end]} {text[symbol.end : whole.end].strip()}"
    return f"{NO_CHAIN}; write {first} and {second}, or use parentheses"
