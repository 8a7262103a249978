"""Parquet and Arrow files (Feather, IPC), and arrow tables in memory, with pyarrow."""

from __future__ import annotations

import json
from contextlib import suppress
from itertools import chain
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.lazy.modules import np
from rtamt.readers.ahead import ahead
from rtamt.readers.dates import is_date
from rtamt.readers.frames import field_of
from rtamt.readers.source import CHUNK, Field, Source, Table, library
from rtamt.signals.time_columns import is_stamps

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from rtamt.readers.source import Raw


#: Rows that are examined to distinguish dates from other texts.
_SAMPLE = 100
#: Bytes of a column in a Parquet file that are read at a time.
_BUFFER = 2**20
#: Batches of an Arrow file that are one chunk at most: a program that records may write one for each sample.
_BATCHES = 2**10
#: How pandas calls the column of an index without a name.
_INDEX = "__index_level_0__"


def open_parquet(path: str) -> Source:
    """Open a Parquet file; its row groups are read one after another where chunks are requested."""
    parquet, arrow = library("pyarrow.parquet", "Parquet"), library("pyarrow", "Parquet")
    # A buffer for each column: the file is neither read ahead, in memory for ever, nor a row group at once.
    file = parquet.ParquetFile(path, pre_buffer=False, buffer_size=_BUFFER)
    schema = _flat(file.schema_arrow, arrow)
    texts = _texts(schema, arrow)
    first = next(file.iter_batches(_SAMPLE, columns=texts), None) if texts else None
    fields = _fields(schema, arrow, _date_columns(first, texts, arrow))

    def load(wanted: Sequence[Field]) -> list[Raw]:
        return _raws(_flattened(file.read(columns=_columns(wanted)), arrow), wanted)

    def chunks(wanted: Sequence[Field]) -> Iterator[list[Raw]]:
        batches = file.iter_batches(CHUNK, columns=_columns(wanted))
        yield from ahead(_of_batches(batches, wanted, arrow))

    return Source(path, (Table(fields, load, chunks, fresh=True),), close=file.close)


def open_arrow(path: str) -> Source:
    """Open an Arrow file (Feather is one), or a stream that was written into a file."""
    arrow, ipc = library("pyarrow", "Arrow files"), library("pyarrow.ipc", "Arrow files")
    file = arrow.memory_map(path)
    try:
        reader = ipc.open_file(file)
        batches: Iterator[Any] = (reader.get_batch(i) for i in range(reader.num_record_batches))
    except arrow.ArrowInvalid:
        file.seek(0)
        reader = ipc.open_stream(file)
        batches = iter(reader)
    batches = map(_valid, batches)
    schema = _flat(reader.schema, arrow)
    first = next(batches, None)
    batches = chain(() if first is None else (first,), batches)
    fields = _fields(schema, arrow, _date_columns(first, _texts(schema, arrow), arrow))

    def chunks(wanted: Sequence[Field]) -> Iterator[list[Raw]]:
        yield from _of_batches(batches, wanted, arrow)

    def load(wanted: Sequence[Field]) -> list[Raw]:
        whole = arrow.Table.from_batches(list(batches), schema=reader.schema)
        return _raws(_flattened(whole, arrow), wanted)

    return Source(path, (Table(fields, load, chunks),), close=file.close)


def _flat(schema: Any, arrow: Any) -> Any:
    """Return a schema with a column for each field of a struct; an ``empty_table`` of pyarrow imports pandas first."""
    return _flattened(arrow.Table.from_batches([], schema), arrow).schema


def _flattened(table: Any, arrow: Any) -> Any:
    """Return a table with a column for each field of a struct, also of structs in structs."""
    while any(arrow.types.is_struct(column.type) for column in table.schema):
        table = table.flatten()
    return table


def _valid(batch: Any) -> Any:
    """Return a batch whose texts and lists lie in its memory: pyarrow reads them wherever the file points."""
    batch.validate(full=True)
    return batch


def table_of_arrow(table: Any) -> Table:
    """Return an arrow table; a struct is a column for each of its fields, called ``struct.field``."""
    arrow = library("pyarrow", "arrow tables")
    flat = _flattened(table, arrow)
    fields = _fields(flat.schema, arrow, _date_columns(flat, _texts(flat.schema, arrow), arrow))
    return Table(fields, lambda wanted: _raws(flat, wanted))


def table_of_batch(batch: Any) -> Table:
    """Return a record batch as a table."""
    return table_of_arrow(library("pyarrow", "arrow tables").Table.from_batches([batch]))


def _of_batches(batches: Iterable[Any], wanted: Sequence[Field], arrow: Any) -> Iterator[list[Raw]]:
    for several in _gathered(batches):
        flat = _flattened(arrow.Table.from_batches(several), arrow)
        for start in range(0, len(flat), CHUNK):
            yield _raws(flat.slice(start, CHUNK), wanted)


def _gathered(batches: Iterable[Any]) -> Iterator[list[Any]]:
    """Yield batches together that are small: the first chunk decides on the period, which takes two samples."""
    several: list[Any] = []
    rows = 0
    for batch in batches:
        several.append(batch)
        rows += len(batch)
        if rows >= CHUNK or (len(several) >= _BATCHES and rows > 1):
            yield several
            several, rows = [], 0
    if several:
        yield several


def _columns(wanted: Sequence[Field]) -> list[str]:
    return list(dict.fromkeys(field.column for field in wanted))


def _texts(schema: Any, arrow: Any) -> list[str]:
    """Return the columns of texts whose names no other column has."""
    types = arrow.types
    texts = [c.name for c in schema if types.is_string(c.type) or types.is_large_string(c.type)]
    return [name for name in texts if schema.names.count(name) == 1]


def _date_columns(first: Any, texts: Sequence[str], arrow: Any) -> set[str]:
    """Return which columns of texts hold dates, from the first text that is not missing."""
    if first is None or not texts:
        return set()
    head = first if isinstance(first, arrow.Table) else _flattened(arrow.Table.from_batches([first]), arrow)
    cells = {name: head.column(name).slice(0, _SAMPLE).to_pylist() for name in texts}
    return {name for name in texts if is_date(next((c for c in cells[name] if c is not None), None))}


def _fields(schema: Any, arrow: Any, dated: Collection[str]) -> tuple[Field, ...]:
    types = arrow.types
    fields = []
    for column in schema:
        type_ = column.type
        if types.is_dictionary(type_) or types.is_run_end_encoded(type_):
            type_ = type_.value_type
        extended = isinstance(type_, arrow.BaseExtensionType)  # such as bool8: a byte for a Boolean
        if extended:
            type_ = type_.storage_type
        kind = ""
        if column.name in dated or (types.is_temporal(type_) and not types.is_time(type_) and not extended):
            kind = "time"
        elif any(
            test(type_) for test in (types.is_integer, types.is_floating, types.is_decimal, types.is_boolean)
        ):
            kind = "number"
        elif extended or not types.is_null(type_):
            kind = "text"
        field = field_of(column.name, kind)
        said = column.metadata or {}
        unit = (said.get(b"unit") or said.get(b"units") or b"").decode(errors="replace")
        axis = column.name == _INDEX and types.is_floating(type_)
        fields.append(Field(field.column, field.name, unit or field.unit, kind, axis=axis))
    return (*_described_times(schema), *fields)


def _described_times(schema: Any) -> tuple[Field, ...]:
    """Return the timestamps that are a range in the notes of pandas on its index, and no column.

    A table keeps these notes when rows are left out, so that they are not to be relied on.
    """
    with suppress(AttributeError, KeyError, TypeError, ValueError):
        for index in json.loads(schema.metadata[b"pandas"])["index_columns"]:
            if isinstance(index, dict) and index["name"] not in (None, *schema.names):
                field = field_of(str(index["name"]), "number")
                return (field,) if is_stamps(field.name) else ()
    return ()


def _raws(table: Any, wanted: Sequence[Field]) -> list[Raw]:
    for field in wanted:
        if field.column not in table.column_names:
            raise TraceError(
                f"the timestamps '{field.column}' are a pandas index that was saved without its values: save "
                f"frame.reset_index(), or read without timestamps (time='', --time-column '')"
            )
    return [_raw(table.column(field.column)) for field in wanted]


def _raw(column: Any) -> Raw:
    kind = str(column.type)
    if kind.startswith("decimal"):
        column = column.cast("string").cast("float64")  # to the nearest double, which a direct cast may miss
    if not column.null_count and kind in _NUMBERS:
        return values_of(column)
    missing = column.is_null().to_numpy() if column.null_count else None
    if kind.startswith(("timestamp", "date", "duration")):
        times: Raw = column.to_numpy()
        return times
    if kind == "bool":
        column = column.cast("uint8")
    elif kind in {"null", "string", "large_string"} or not _is_plain(column):
        return np.array(list(chain(column.to_pylist(), [None])), dtype=object)[:-1]
    if missing is None:
        numbers: Raw = column.to_numpy()
        return numbers
    return np.ma.masked_array(column.fill_null(0).to_numpy(), missing)


#: Types of columns whose memory is that of an array of numpy.
_NUMBERS = {"float": "f4", "double": "f8"} | {
    f"{sign}int{bits}": f"{sign or 'i'}{bits // 8}" for sign in ("", "u") for bits in (8, 16, 32, 64)
}


def values_of(column: Any) -> Raw:
    """Return a column of numbers without missing ones; ``to_numpy`` of pyarrow imports pandas first."""
    parts = [values_in_place(chunk) for chunk in column.chunks if len(chunk)]
    if len(parts) == 1:
        return parts[0]
    return np.concatenate(parts) if parts else np.empty(0, _NUMBERS[str(column.type)])


def values_in_place(chunk: Any) -> Raw:
    """Return an array of arrow, of numbers without missing ones, as one of numpy in the same memory."""
    dtype = np.dtype(_NUMBERS[str(chunk.type)])
    return np.frombuffer(chunk.buffers()[1], dtype, len(chunk), chunk.offset * dtype.itemsize)


def _is_plain(column: Any) -> bool:
    try:
        return bool(np.issubdtype(column.type.to_pandas_dtype(), np.number))
    except NotImplementedError:  # types without an array of numpy, such as times of day
        return False
