"""The exceptions that the library raises.

::

    StlError                     base of all
    ├── SpecificationError       the text of a requirement is wrong: .text, .span
    │   ├── ParseError           a syntax error
    │   ├── NameInFormulaError   an undeclared name
    │   └── BoundError           an invalid interval
    ├── TraceError               the data is wrong: .variable, .index, .time
    ├── EvaluationError          the data makes a sub-formula undefined (0/0, sqrt(-1), inf - inf)
    │   └── WaitedError          the same for a sample that waited in a fleet: .key, .time
    ├── UsageError               an invalid call, option or setting
    └── RTAMTException           raised by the paper's API; str() begins "RTAMT Exception: "
        └── STLParseException    the same, for text

A message is one sentence: what is wrong, where, and how to fix it. Errors about text also show
the line with a caret under the position.
"""

from __future__ import annotations

import reprlib

from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import re
    from collections.abc import Iterable

    from rtamt.language.formula import Span

#: The number of characters of a long line shown on each side of a position.
_SHOWN = 60

#: The largest number of names that a message lists.
_LISTED = 16

#: A word longer than any reasonable path or name.
_PAGES = lazy_pattern(r"\S{600,}")


def _abbreviate(word: re.Match[str]) -> str:
    text = word.group()
    return f"{text[:_SHOWN]}… (abbreviated: {len(text)} characters) …{text[-_SHOWN:]}"


class StlError(Exception):
    """Base class of all exceptions of this library.

    Very long words of a message, such as a number of a million digits, are abbreviated.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("x >= 3").evaluate({"y": [1]})
    ... except rtamt.StlError as error:
    ...     print(error)
    the data has no 'x'; signals: y
    """

    def __init__(self, message: object = "", *more: object) -> None:
        super().__init__(_PAGES.sub(_abbreviate, message) if isinstance(message, str) else message, *more)


class SpecificationError(StlError):
    """The text of a requirement is invalid.

    ``message`` is the sentence alone; ``str()`` adds line, column and a caret if the text is known.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("x >= 3 y")
    ... except rtamt.SpecificationError as error:
    ...     print(error.message, error.span)
    expected an operator between '3' and 'y' Span(start=7, end=8)
    """

    def __init__(self, message: str, text: str | None = None, span: Span | None = None) -> None:
        super().__init__(message, text, span)
        self.message: str = self.args[0]
        self.text = text
        self.span = span

    def __str__(self) -> str:
        if self.text is None or self.span is None:
            return self.message
        return f"{self.message}\n{caret(self.text, self.span)}"


class ParseError(SpecificationError):
    """The text is not a formula or specification file.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("x >= 3 y")
    ... except rtamt.ParseError as error:
    ...     print(error.message)
    expected an operator between '3' and 'y'
    """


class NameInFormulaError(SpecificationError):
    """A name in the text is not declared.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("float speed; sped <= 3")
    ... except rtamt.NameInFormulaError as error:
    ...     print(error)
    'sped' is not declared; did you mean 'speed'?
      line 1, column 14:
        float speed; sped <= 3
                     ^^^^
    """


class BoundError(SpecificationError):
    """An interval is reversed, negative, not a multiple of the period, or unbounded where this is not allowed.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("once[2:1](x >= 3)")
    ... except rtamt.BoundError as error:
    ...     print(error.message)
    the interval [2:1] is reversed: it ends before it begins
    """


class TraceError(StlError):
    """The data is invalid; the message names the variable, the index and the time.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("x >= 3").evaluate({"x": [1, float("nan")]})
    ... except rtamt.TraceError as error:
    ...     print(error.variable, error.index)
    x 1
    """

    def __init__(
        self,
        message: str,
        *,
        variable: str | None = None,
        index: int | None = None,
        time: float | None = None,
    ) -> None:
        super().__init__(message)
        self.variable = variable
        self.index = index
        self.time = time


class EvaluationError(StlError):
    """A sub-formula is undefined at an instant; the message names both.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("sqrt(x) >= 1").evaluate({"x": [1, -1]})
    ... except rtamt.EvaluationError as error:
    ...     print(str(error).partition(":")[0])
    'sqrt(x)' has no value at sample 1, time 1 s
    """


class WaitedError(EvaluationError):
    """A sample that waited in a fleet makes a sub-formula undefined; ``key`` and ``time``: which one.

    It rejects each batch that would release it, until :meth:`rtamt.Fleet.discard` forgets it. ``reason``: the message
    without this advice.

    >>> import rtamt
    >>> error = rtamt.WaitedError("'sqrt(x)' has no value for key 7 at 1 s", 7, 1.0)
    >>> print(error)
    'sqrt(x)' has no value for key 7 at 1 s; forget the sample with discard(7, 1.0), then give the batch again
    """

    def __init__(self, reason: str, key: Any, time: float) -> None:
        super().__init__(
            f"{reason}; forget the sample with discard({key!r}, {time!r}), then give the batch again"
        )
        self.reason, self.key, self.time = reason, key, time

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.reason, self.key, self.time)


class UsageError(StlError):
    """A call, option or setting is invalid.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("x >= 3", time="discreet")
    ... except rtamt.UsageError as error:
    ...     print(error)
    unknown time domain 'discreet'; did you mean 'discrete'? (time domains: discrete, dense)
    """


class RTAMTException(StlError):  # noqa: N818 - the name is the paper's API
    """Raised by the classes of the paper's API.

    >>> import rtamt
    >>> try:
    ...     rtamt.StlDiscreteTimeSpecification().evaluate({"time": [0]})
    ... except rtamt.RTAMTException as error:
    ...     print(error)
    RTAMT Exception: no specification has been read; set spec and call parse() first
    """

    def __str__(self) -> str:
        return f"RTAMT Exception: {super().__str__()}"


class STLParseException(RTAMTException):
    """Raised by the paper's API for text that cannot be parsed.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeSpecification()
    >>> spec.spec = "always(x >= "
    >>> try:
    ...     spec.parse()
    ... except rtamt.STLParseException as error:
    ...     print(str(error).splitlines()[0])
    RTAMT Exception: expected an operand after '>=', got the end of the text
    """


def line_and_column(text: str, offset: int) -> tuple[int, int]:
    r"""Return the line and the column of a character of ``text``, both from 1.

    A line ends at ``\n``, ``\r\n`` or ``\r``.

    >>> line_and_column("a >= 3\nb", 7)
    (2, 1)
    """
    start = _line_start(text, offset)
    return 1 + sum(text.count(end, 0, start) for end in "\r\n") - text.count(
        "\r\n", 0, start
    ), offset - start + 1


def _line_start(text: str, offset: int) -> int:
    return max(text.rfind("\n", 0, offset), text.rfind("\r", 0, offset)) + 1


def caret(text: str, span: Span) -> str:
    """Return the line of ``text`` in which ``span`` starts, with carets under the span.

    >>> from rtamt.language.formula import Span
    >>> print(caret("a >= ) b", Span(5, 6)))
      line 1, column 6:
        a >= ) b
             ^
    """
    start = min(span.start, len(text))
    line_start = _line_start(text, start)
    ends = [end for end in (text.find("\n", start), text.find("\r", start)) if end >= 0]
    line_end = min(ends, default=len(text))
    number, column = line_and_column(text, start)
    # Generated lines may have a million characters: show only the surroundings of the position.
    shown_from = max(line_start, start - _SHOWN) if start - line_start > _SHOWN + 10 else line_start
    shown_to = min(line_end, start + _SHOWN) if line_end - start > _SHOWN + 10 else line_end
    before = "... " if shown_from > line_start else ""
    after = " ..." if shown_to < line_end else ""
    line = before + text[shown_from:shown_to] + after
    # Tabs are kept, so that the caret is aligned with its character.
    pad = "".join("\t" if c == "\t" else " " for c in before + text[shown_from:start])
    width = max(1, min(span.end, shown_to) - start)
    return f"  line {number}, column {column}:\n    {line}\n    {pad}{'^' * width}"


def placed(error: StlError, where: str) -> StlError:
    """Return the same error with a message prefixed by its origin, such as the index of a trace.

    >>> raise placed(TraceError("'x' has no samples: give at least one", variable="x"), "trace 7")
    Traceback (most recent call last):
    rtamt.errors.TraceError: trace 7: 'x' has no samples: give at least one
    """
    from copy import copy

    again = copy(error)
    message, *rest = error.args
    again.args = (f"{where}: {message}", *rest)
    if isinstance(again, SpecificationError):
        again.message = again.args[0]
    return again


def shown(value: object) -> str:
    """Return a value for a message: its repr in one line, abbreviated if long.

    >>> shown("abc"), len(shown(10**400)), shown(10**10_000)
    ("'abc'", 40, '<an int of about 10001 digits>')
    """
    text = _AS_SHOWN.repr(value)
    return " ".join(text.split()) if "\n" in text else text


class _Repr(reprlib.Repr):
    def repr_int(self, x: int, level: int) -> str:
        digits = int(x.bit_length() * 0.30103) + 1
        if digits > 4000:  # Python does not convert integers of more than 4300 digits
            return f"<an int of about {digits} digits>"
        return super().repr_int(x, level)


_AS_SHOWN = _Repr()


def with_article(noun: str) -> str:
    """Return a noun with its indefinite article; most type names beginning with "u" are pronounced "you".

    >>> with_article("int"), with_article("Odometry"), with_article("UInt8"), with_article("str")
    ('an int', 'an Odometry', 'a UInt8', 'a str')
    """
    return f"{'an' if noun[:1].lower() in set('aeio') else 'a'} {noun}"


def _near(name: object, known: Iterable[str], most: int) -> list[str]:
    from difflib import get_close_matches

    return get_close_matches(name, list(known), n=most) if isinstance(name, str) else []


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the nearest known name, else an empty string.

    >>> did_you_mean("gmt", ["req", "gnt"])
    "; did you mean 'gnt'?"
    """
    close = _near(name, known, 1)
    return f"; did you mean '{close[0]}'?" if close else ""


def no_specification(given: object) -> UsageError:
    """Return the error for what is no specification, such as the text of one."""
    return UsageError(
        f"expected a specification, got {shown(given)}; write rtamt.parse(...) or rtamt.load(...)"
    )


def changed_state() -> UsageError:
    """Return the error for a state of a monitor that contradicts itself."""
    return UsageError("this is not the state of a monitor of this formula: it was changed after it was saved")


def choices(name: object, known: Iterable[str], noun: str) -> str:
    """Return the nearest known name, then the known names with the nearest first; a long list is cut.

    >>> choices("gmt", ["req", "gnt"], "columns")
    "; did you mean 'gnt'? (columns: gnt, req)"
    >>> choices("speed", ["req", "gnt"], "columns")
    '; columns: req, gnt'
    """
    names = [str(each) for each in known]
    if (alike := _alike(str(name), names)) is not None:
        return (
            f"; '{alike}' differs from it in its Unicode form only: normalise both, such as with "
            f"unicodedata.normalize('NFKC', name)"
        )
    close = _near(name, names, _LISTED)
    names = [*close, *(each for each in names if each not in close)]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    listing = f"{noun}: {', '.join(names[:_LISTED]) or 'none'}{more}"
    return f"; did you mean '{close[0]}'? ({listing})" if close else f"; {listing}"


def _alike(name: str, names: list[str]) -> str | None:
    """Return the name of other characters that stand for the same letters, such as a letter with its accent apart."""
    if name.isascii() and all(map(str.isascii, names)):
        return None
    from unicodedata import normalize

    form = normalize("NFKC", name)
    return next((each for each in names if each != name and normalize("NFKC", each) == form), None)


def escaped(text: str) -> str:
    r"""Return a text with control characters escaped, so that file names cannot control a terminal.

    Line ends and tabs are kept. Bidirectional marks, and bytes of file names that are
    not UTF-8 (Python's surrogate escapes), are escaped, too.

    >>> print(escaped("log\x1b[2J\x07.csv"), escaped("a\u202eb"), escaped("caf\udce9.csv"))
    log\x1b[2J\x07.csv a\u202eb caf\xe9.csv
    """
    return _UNPRINTABLE.sub(lambda match: _format_code(ord(match[0])), text)


#: Control characters (C0, DEL, C1), line separators, bidirectional marks, and surrogates.
_UNPRINTABLE = lazy_pattern(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def readable(text: str) -> str:
    r"""Return a text that can be encoded: bytes of file names that are not UTF-8 are escaped.

    >>> print(readable("caf\udce9.csv"))
    caf\xe9.csv
    """
    return _SURROGATES.sub(lambda match: _format_code(ord(match[0])), text)


_SURROGATES = lazy_pattern("[\ud800-\udfff]")


def _format_code(code: int) -> str:
    if 0xDC80 <= code <= 0xDCFF:
        code -= 0xDC00
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
