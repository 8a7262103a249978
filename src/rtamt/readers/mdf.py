"""Measurement data files (ASAM MDF 3 and 4), with asammdf: a table for each channel group."""

from __future__ import annotations

import ast
import logging
import os
from collections import Counter
from contextlib import ExitStack, contextmanager, redirect_stdout
from datetime import timezone
from io import StringIO
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.value_types import Enumeration
from rtamt.lazy.modules import np
from rtamt.readers.source import Field, Source, Table, damage, library, printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rtamt.readers.source import Raw


#: The greatest compression ratio of a block (deflate).
_DENSEST = 1032
#: Types of channels of MDF 4 that have no bytes in the records: virtual masters and data.
_VIRTUAL = (3, 6)
_VARIABLE_LENGTH = 1
#: What a master channel of MDF 4 may hold other than time.
_AXES = {2: "angle", 3: "distance", 4: "an index"}
#: Types of conversions from numbers, ranges of numbers, or bits to texts, in MDF 4 and before.
_TEXT_TABLES, _OLD_TEXT_TABLES = (7, 8, 11), (11, 12)
#: The flag of an MDF 4 channel with a bit in each record that marks invalid samples.
_HAS_FLAG = 2
#: Types of data that are no numbers: texts, bytes, MIME, dates as bytes. Their lengths lie anywhere in the file.
_NO_NUMBERS = range(6, 15)


#: Of formulas of conversions: what they are made of, and the functions that they may call.
_ARITHMETIC = (ast.BinOp, ast.UnaryOp, ast.Compare, ast.Name, ast.Load, ast.operator, ast.unaryop, ast.cmpop)
_FUNCTIONS = frozenset(
    "abs sqrt exp expm1 log log10 log1p floor ceil sin cos tan sinh cosh tanh arcsin arccos arctan arctan2 "
    "arcsinh arccosh arctanh where".split()
)


def open_mdf(path: str) -> Source:
    """Open a measurement file; channels of one name in several groups are called ``group.name``.

    They are ``group[0].name`` and ``group[1].name`` where the groups have one name, too, and ``group[0].name[0]`` and
    ``group[0].name[1]`` in one group.

    Channels whose values are texts for numbers (modes, states) are read as the numbers, or as the codes of an
    enumeration, whose members are found by these texts. Where a conversion has texts for some numbers and scales the
    others, samples that are texts are NaN.
    """
    asammdf = library("asammdf", "MDF")
    with _collect_warnings() as complaints:
        try:
            file = asammdf.MDF(path)
        except Exception as error:
            _abandon(error)
            raise
    with ExitStack() as stack:
        stack.callback(file.close)
        most = _DENSEST * os.path.getsize(path)
        for number, group in enumerate(file.groups):
            _check_group(path, number, group, most)
        stack.pop_all()
    tables = tuple(_table(file, number, names) for number, names in enumerate(_names(file.groups)))
    start = file.start_time
    origin = np.datetime64(start.astimezone(timezone.utc).replace(tzinfo=None), "ns")
    return Source(path, tables, origin=origin, losses=damage(complaints), close=file.close)


def _group_name(group: Any, number: int) -> str:
    return getattr(group.channel_group, "acq_name", "") or f"group{number}"


def _names(groups: Sequence[Any]) -> list[list[str]]:
    """Return the names of the channels of each group: of each the shortest that no other channel has."""
    prefixes = [_group_name(group, number) for number, group in enumerate(groups)]
    places = [(i, channel.name) for i, group in enumerate(groups) for channel in group.channels]
    short = [name for _, name in places]
    grouped = [f"{prefixes[i]}.{name}" for i, name in places]
    counted = _counted(prefixes)
    numbered = [f"{counted[i]}.{name}" for i, name in places]
    forms = (short, grouped, numbered, _counted(numbered))
    counts = [Counter(form) for form in forms]
    names: list[list[str]] = [[] for _ in groups]
    for (i, _), candidates in zip(places, zip(*forms, strict=True), strict=True):
        names[i].append(
            next(name for name, count in zip(candidates, counts, strict=True) if count[name] == 1)
        )
    return names


def _counted(names: Sequence[str]) -> list[str]:
    """Return each name with its place among those that equal it.

    >>> _counted(["a", "b", "a"])
    ['a[0]', 'b[0]', 'a[1]']
    """
    before: Counter[str] = Counter()
    result = []
    for name in names:
        result.append(f"{name}[{before[name]}]")
        before[name] += 1
    return result


def _table(file: Any, number: int, names: Sequence[str]) -> Table:
    group = file.groups[number]
    master = file.masters_db.get(number)
    prefix = _group_name(group, number)
    places: dict[str, int] = {}
    fields, time_field, losses = [], None, []
    for index, (channel, name) in enumerate(zip(group.channels, names, strict=True)):
        kind = "text" if _is_text(channel) else ""
        field = Field(name, name, _unit(channel), kind)
        over = _AXES.get(getattr(channel, "sync_type", 1), "") if index == master else ""
        if over:
            losses.append(
                f"{printable(prefix)} is recorded over {over}, not over time, so that it has no timestamps"
            )
        elif index == master:
            time_field = field = Field(name, name, "s", "number")
        places[name] = index
        fields.append(field)

    def load(wanted: Sequence[Field]) -> list[Raw]:
        for field in wanted:
            if field.kind == "text" and not isinstance(field.type, Enumeration):
                raise TraceError(f"the channel '{field.column}' holds texts or bytes, expected numbers")
        return [
            np.asarray(file.get_master(number))
            if field == time_field
            else _samples(file, number, places[field.column], field, losses)
            for field in wanted
        ]

    return Table(tuple(fields), _quietly(load), time_field=time_field, has_unit=True, losses=losses)


def _quietly(load: Callable[[Sequence[Field]], list[Raw]]) -> Callable[[Sequence[Field]], list[Raw]]:
    """Return a function that drops what asammdf prints, where the robustness of a command line goes."""

    def quiet(wanted: Sequence[Field]) -> list[Raw]:
        with redirect_stdout(StringIO()):
            return load(wanted)

    return quiet


@contextmanager
def _collect_warnings() -> Iterator[list[str]]:
    """Collect the messages of asammdf about a damaged file, of which it skips the rest and continues."""
    complaints: list[str] = []

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            complaints.append(record.getMessage())

    logger = logging.getLogger("asammdf")
    handlers, logger.handlers, logger.propagate = logger.handlers, [Collector()], False
    try:
        yield complaints
    finally:
        logger.handlers, logger.propagate = handlers, True


def _abandon(error: Exception) -> None:
    """Close what asammdf could not open: it would do so when it is deleted, fail, and print that to stderr."""
    for frame, _ in walk_tb(error.__traceback__):
        half: Any = frame.f_locals.get("self")
        if getattr(half, "_closed", True) is False and hasattr(half, "_tempfile"):
            half._closed = True
            half._tempfile.close()


def _check_group(path: str, number: int, group: Any, most: int) -> None:
    """Raise :class:`TraceError` at what asammdf would do whatever it leads to.

    It takes memory for any number of records, reads a channel that lies outside its records wherever that is
    in memory, and evaluates any formula. ``most``: bytes that a file of this size can hold.
    """
    size = group.channel_group.samples_byte_nr
    marks = getattr(group.channel_group, "invalidation_bytes_nr", 0)
    flags = 8 * marks
    records = group.channel_group.cycles_nr
    if records * max(size + marks, 1) > most:
        raise TraceError(
            f"'{path}' cannot be read as MDF: group {number} claims {records:,} records of {size + marks} bytes, "
            f"more than a file of its size can hold; the file is damaged: copy or export it again"
        )
    for channel in group.channels:
        if hasattr(channel, "byte_offset"):  # MDF 4; before, a channel begins at a bit
            end = 8 * channel.byte_offset + channel.bit_offset + channel.bit_count
            flag = channel.pos_invalidation_bit if channel.flags & _HAS_FLAG else -1
        else:
            end = 8 * channel.additional_byte_offset + channel.start_offset + channel.bit_count
            flag = -1
        problem = ""
        if getattr(channel, "channel_type", 0) not in _VIRTUAL and (end > 8 * size or flag >= flags):
            problem = f"lies outside its records of {size} bytes"
        for formula in _formulas(channel.conversion):
            if not is_arithmetic(formula):
                problem = f"has a conversion that is no arithmetic, '{printable(formula)}'"
        if problem:
            raise TraceError(
                f"'{path}' cannot be read as MDF: the channel '{printable(channel.name)}' of group {number} "
                f"{problem}; the file is damaged: copy or export it again"
            )


def _formulas(conversion: Any) -> Iterator[str]:
    """Yield the texts of formulas in a conversion, and in those that it refers to."""
    if isinstance(getattr(conversion, "formula", None), str) and conversion.formula:
        yield conversion.formula
    for block in (getattr(conversion, "referenced_blocks", None) or {}).values():
        yield from _formulas(block)


def is_arithmetic(formula: str) -> bool:
    """Return whether the text of a conversion is arithmetic, without powers of constants, which have no end.

    asammdf runs it: by numexpr, and what that refuses as Python by sympy, where that is installed.

    >>> is_arithmetic("2*X1**2 + sin(X)"), is_arithmetic("9**9**9 * X"), is_arithmetic("exit(X)")
    (True, False, False)
    """
    try:
        tree = ast.parse(formula.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return False
    return all(map(_is_arithmetic, ast.walk(tree)))


def _is_arithmetic(node: ast.AST) -> bool:
    if isinstance(node, ast.Constant):
        return type(node.value) in (int, float)
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id in _FUNCTIONS and not node.keywords
    if isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Pow, ast.LShift)):
        return any(isinstance(part, ast.Name) for part in ast.walk(node.left))
    return isinstance(node, _ARITHMETIC)


def _text(value: Any) -> Any:
    return value.decode("utf-8", "replace").rstrip("\0").strip() if isinstance(value, bytes) else value


def _is_text(channel: Any) -> bool:
    return hasattr(channel, "byte_offset") and (
        channel.data_type in _NO_NUMBERS or channel.channel_type == _VARIABLE_LENGTH
    )


def _has_texts(channel: Any) -> bool:
    """Return whether a channel has texts for numbers."""
    tables = _TEXT_TABLES if hasattr(channel, "byte_offset") else _OLD_TEXT_TABLES
    return getattr(channel.conversion, "conversion_type", None) in tables


def _has_numbers(conversion: Any) -> bool:
    """Return whether a table of texts also scales some of its numbers; before MDF 4 none does."""
    blocks = [block for block in (getattr(conversion, "referenced_blocks", None) or {}).values() if block]
    return any(
        not isinstance(block, bytes) and (block.conversion_type not in _TEXT_TABLES or _has_numbers(block))
        for block in blocks
    )


def _members(values: Sequence[Any], type_: Enumeration) -> Iterator[Any]:
    """Yield texts of a value table, and for numbers without a text a number that is the code of no member."""
    codes = {code for _, code in type_.members}
    for value in map(_text, values):
        yield max(codes) + 1 if isinstance(value, int | float) and value in codes else value


def _unit(channel: Any) -> str:
    conversion = getattr(channel, "conversion", None)
    return str(channel.unit or getattr(conversion, "unit", "") or "").strip()


def _samples(file: Any, group: int, index: int, field: Field, losses: list[str]) -> Raw:
    """Return the values of a channel; of an enumeration the texts that its value table has for numbers."""
    channel = file.groups[group].channels[index]
    signal = file.get(group=group, index=index, ignore_invalidation_bits=True)
    bits = signal.invalidation_bits
    missing = None if bits is None else np.asarray(bits, dtype=bool)
    samples: Raw = signal.samples
    has_texts, is_text = _has_texts(channel), samples.dtype.kind in "SUO"
    if has_texts or is_text:
        raw = file.get(group=group, index=index, ignore_invalidation_bits=True, raw=True).samples
        coded = raw.dtype.kind in "fiub"
        # Of texts and numbers, asammdf would return the numbers only.
        values = (
            channel.conversion.convert(raw, as_object=True) if coded and has_texts else samples
        ).tolist()
        if isinstance(field.type, Enumeration):
            samples = np.array([*_members(values, field.type), None], dtype=object)[:-1]
        elif coded and has_texts and _has_numbers(channel.conversion):
            samples = _scaled(values, missing, field, losses)
        elif coded:
            samples = raw
    return samples if missing is None else np.ma.masked_array(samples, missing)


def _scaled(values: Sequence[Any], missing: Raw | None, field: Field, losses: list[str]) -> Raw:
    """Return the numbers of a conversion with texts for some of them: NaN where a sample is a text."""
    texts = np.array([isinstance(value, bytes) for value in values], dtype=bool)
    found = np.flatnonzero(texts if missing is None else texts & ~missing)
    if len(found):
        name, text = printable(field.column), printable(_text(values[found[0]]))
        what = (
            f"1 sample of {name} is NaN, because its conversion maps it to the text '{text}'"
            if len(found) == 1
            else f"{len(found):,} samples of {name} are NaN, because its conversion maps them to texts such as '{text}'"
        )
        losses.append(
            f"{what}; declare {name} as an enumeration to read {'it' if len(found) == 1 else 'them'}"
        )
    return np.array([np.nan if isinstance(value, bytes) else value for value in values], dtype=np.float64)
