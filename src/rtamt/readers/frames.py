"""Data that is in memory already: pandas, polars and xarray objects, arrow tables, numpy arrays, dicts.

No library is imported for them: who has such an object has imported it.
"""

from __future__ import annotations

from collections.abc import Mapping
from decimal import InvalidOperation, localcontext
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.lazy.modules import np
from rtamt.readers.dates import is_date
from rtamt.readers.source import Field, Source, Table
from rtamt.signals.arrays import TIME, as_array, is_masked
from rtamt.signals.time_columns import check_index, is_stamps, split_unit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rtamt.readers.source import Raw


def source_of(data: Any) -> Source | None:
    """Return the object as a source; None where it is of no kind that is known here."""
    for base in type(data).__mro__:  # first: an xarray dataset is a mapping as well
        opener = _OPENERS.get((base.__module__.split(".")[0], base.__name__))
        if opener is not None:
            return opener(data)
    if isinstance(data, Mapping):
        return _dict(data)
    return _read_structured(data) if isinstance(data, np.ndarray) else None


def field_of(column: str, kind: str = "") -> Field:
    """Return a field called ``column``, with the unit that is written behind its name."""
    name, unit = split_unit(column)
    return Field(column, name, unit, kind)


def kind_of(raw: Raw) -> str:
    """Return the kind of a column; for objects and texts, whether the first that is not missing is a date."""
    if raw.dtype.kind in "OUS":
        first = next((value for value in raw if value is not None and value is not np.ma.masked), None)
        return "time" if is_date(first) else "" if raw.dtype.kind == "O" else "text"
    return {"f": "number", "i": "number", "u": "number", "b": "number", "M": "time", "m": "time"}.get(
        raw.dtype.kind, ""
    )


def table_of(
    columns: Mapping[str, Raw],
    time_column: str | None = None,
    units: Mapping[str, str] | None = None,
    axis: str | None = None,
) -> Table:
    """Return arrays of one length as a table.

    ``time_column``: the column that is known to hold the timestamps; ``axis``: one that looks like them.
    """
    fields = {}
    for column, raw in columns.items():
        field = field_of(str(column), kind_of(raw))
        unit = (units or {}).get(column, field.unit)
        fields[field.column] = Field(field.column, field.name, unit, field.kind, axis=column == axis)
    by_column = {str(column): raw for column, raw in columns.items()}
    _check_lengths(by_column)
    return Table(
        tuple(fields.values()),
        lambda wanted: [by_column[field.column] for field in wanted],
        time_field=None if time_column is None else fields[time_column],
    )


def _check_lengths(columns: Mapping[str, Raw]) -> None:
    lengths = {column: len(raw) for column, raw in columns.items()}
    if len(set(lengths.values())) > 1:
        (a, n), *rest = lengths.items()
        b, m = next((b, m) for b, m in rest if m != n)
        raise TraceError(f"'{a}' has {n} and '{b}' has {m} samples: give one value of each at every sample")


def _array(values: Any, name: str) -> Raw:
    try:
        raw = values if is_masked(values) else as_array(values)
    except (TypeError, ValueError):  # lists of different lengths, for numpy
        raise TraceError(f"'{name}' cannot be read as a sequence of numbers", variable=name) from None
    if raw.dtype.kind in "US" and not isinstance(values, np.ndarray):
        raw = np.asarray(values, dtype=object)  # numpy would convert numbers next to a text to text
    if raw.ndim != 1:
        raise TraceError(
            f"'{name}' has {raw.ndim} dimensions, expected 1: give one number a sample", variable=name
        )
    return raw


# ---- one function for each kind ------------------------------------------------------------------


def _dict(data: Mapping[Any, Any]) -> Source:
    from rtamt.signals import dense_arrays

    if TIME not in data and data and all(_is_dense(value) for value in data.values()):
        tables = []
        for name, samples in data.items():
            times, values = dense_arrays.split(samples, str(name))
            columns = {TIME: _array(times, TIME), str(name): _array(values, str(name))}
            shared = table_of(columns, TIME)
            assert shared.time_field is not None
            # Each has its own column of timestamps, which no caller selects by name.
            tables.append(Table(shared.fields[1:], shared.load, time_field=shared.time_field))
        return Source("a dict", tuple(tables))
    if not any(is_stamps(field_of(str(name)).name) for name in data):
        for name, values in data.items():
            check_index(values, str(name))
    return Source("a dict", (table_of({str(k): _array(v, str(k)) for k, v in data.items()}),))


def _is_dense(value: Any) -> bool:
    if isinstance(value, tuple):
        return len(value) == 2 and all(np.ndim(part) == 1 for part in value)
    return isinstance(value, (list, np.ndarray)) and np.ndim(value) == 2 and np.shape(value)[1:] == (2,)


def _read_structured(data: np.ndarray[Any, Any]) -> Source:
    if data.dtype.names is None:
        raise TraceError(
            f"an array of {data.ndim} dimensions does not say what is in it: give a dict from name to values, "
            f"or an array with named fields"
        )
    return Source("an array", (table_of({name: _array(data[name], name) for name in data.dtype.names}),))


def _pandas(frame: Any) -> Source:
    columns = {str(column): _pandas_column(frame.iloc[:, i]) for i, column in enumerate(frame.columns)}
    if len(columns) < len(frame.columns):
        names = list(map(str, frame.columns))  # 1 and "1" are one name
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise TraceError(f"the pandas frame has two columns called '{twice}'; rename one of them")
    index, time_column, axis = frame.index, None, None
    if type(index).__name__ == "PeriodIndex":
        index = index.to_timestamp()
    if index.nlevels > 1:
        levels = {
            str(name): index.get_level_values(i) for i, name in enumerate(index.names) if name is not None
        }
        columns = {name: _pandas_column(each.to_series()) for name, each in levels.items()} | columns
    elif getattr(index, "step", 0) != 1 or is_stamps(field_of(str(index.name)).name):  # 1: numbers of rows
        name = str(index.name) if index.name is not None else "index"
        dated = type(index).__name__ in {"DatetimeIndex", "TimedeltaIndex"}
        # A column that has the name of timestamps comes first, as in an evaluation of the frame.
        named = any(is_stamps(field_of(column).name) for column in columns)
        if name not in columns:
            columns = {name: _pandas_column(index.to_series()), **columns}
            time_column = name if not named and (dated or is_stamps(field_of(name).name)) else None
            axis = name if index.dtype.kind == "f" else None
    return Source("a pandas frame", (table_of(columns, time_column, axis=axis),))


def _pandas_column(series: Any) -> Raw:
    if getattr(series.dtype, "tz", None) is not None:
        series = series.dt.tz_convert("UTC").dt.tz_localize(None)
    kind = series.dtype.kind
    # NaN is how pandas writes that a value is missing; a signaling one among decimals is no error.
    with localcontext() as decimals:
        decimals.traps[InvalidOperation] = False
        missing = series.isna().to_numpy()
    if kind in "Mm":
        times: Raw = series.to_numpy()
        return times
    if kind in "fiub" and not missing.any():
        values = series.to_numpy()
    elif kind in "iu":
        values = series.fillna(0).to_numpy(series.dtype.numpy_dtype)
    elif kind in "fb":
        values = series.to_numpy(dtype=np.float64, na_value=np.nan)
    else:
        values = series.astype(object).to_numpy()
    return np.ma.masked_array(values, missing) if missing.any() else values


def _pandas_series(series: Any) -> Source:
    return _pandas(series.to_frame(series.name if series.name is not None else "x"))


def _polars(frame: Any) -> Source:
    return Source("a polars frame", (table_of({s.name: _polars_column(s) for s in frame.get_columns()}),))


def _polars_column(series: Any) -> Raw:
    missing = series.is_null().to_numpy() if series.null_count() else None
    kind = type(series.dtype).__name__
    if kind == "Datetime":
        zoned = series if series.dtype.time_zone is None else series.dt.convert_time_zone("UTC")
        series = zoned.dt.replace_time_zone(None)
    if kind in {"Datetime", "Date", "Duration"}:
        times: Raw = series.to_numpy()
        return times
    if not series.dtype.is_numeric() and kind != "Boolean":
        return np.array([*series.to_list(), None], dtype=object)[:-1]
    if missing is None and kind != "Decimal":
        return as_array(series)
    if kind != "Decimal" and series.dtype.is_integer():
        values = as_array(series.fill_null(0))
    else:
        values = np.array([0.0 if value is None else float(value) for value in series.to_list()])
    return values if missing is None else np.ma.masked_array(values, missing)


def _arrow(table: Any) -> Source:
    from rtamt.readers.arrow import table_of_arrow

    return Source("an arrow table", (table_of_arrow(table),))


def _arrow_batch(batch: Any) -> Source:
    from rtamt.readers.arrow import table_of_batch

    return Source("an arrow batch", (table_of_batch(batch),))


def _xarray(data: Any) -> Source:
    """Return a table for each dimension: the variables along it, and its coordinate as timestamps."""
    for name, variable in data.variables.items():
        _require_decoded(str(name), variable.attrs)
    tables, left_out = [], [str(name) for name, v in data.data_vars.items() if v.ndim != 1]
    for dim in data.dims:
        along = {str(name): v for name, v in data.data_vars.items() if v.dims == (dim,)}
        if not along:
            continue
        # The coordinate of the dimension comes first: it may hold the timestamps, whatever its name.
        columns = {str(dim): data.coords[dim].values} if dim in data.coords else {}
        columns.update((name, _floats(v.values)) for name, v in along.items())
        units = {name: str(v.attrs.get("units", "")) for name, v in along.items()}
        for coord in [c for c in data.coords if data.coords[c].dims == (dim,)]:
            columns[str(coord)] = data.coords[coord].values
            units[str(coord)] = str(data.coords[coord].attrs.get("units", ""))
        time_column, axis = None, None
        if dim in data.coords:
            kind = kind_of(columns[str(dim)])
            timed = kind == "time" or is_stamps(field_of(str(dim)).name)
            time_column = str(dim) if timed else None
            # Rows are numbered by integers: what is measured is no number of a row.
            axis = str(dim) if columns[str(dim)].dtype.kind == "f" else None
        units = {name: unit for name, unit in units.items() if unit}
        tables.append(table_of(columns, time_column, units, axis))
    notes = (f"left out, not one-dimensional: {', '.join(left_out)}",) if left_out else ()
    return Source("an xarray dataset", tuple(tables), notes=notes)


#: Attributes of numbers in a file that stand for others; xarray removes them where it decodes a file.
_ENCODED = ("scale_factor", "add_offset", "_FillValue", "missing_value")


def _require_decoded(name: str, attributes: Mapping[Any, Any]) -> None:
    """Raise :class:`TraceError` for a variable of xarray whose values are those of a file, before they are decoded."""
    found = next((key for key in _ENCODED if key in attributes), None)
    since = " since " in str(attributes.get("units", ""))
    if found is not None or since:
        problem = f"the attribute '{found}'" if found is not None else f"the unit '{attributes['units']}'"
        raise TraceError(
            f"'{name}' of an xarray dataset has {problem}, so that its values are not decoded: read "
            f"xarray.decode_cf(dataset)",
            variable=name,
        )


def _floats(raw: Raw) -> Raw:
    """Return values with NaN masked: it is how xarray writes that a value is missing."""
    missing = np.isnan(raw) if raw.dtype.kind == "f" else np.zeros(raw.shape, dtype=bool)
    return np.ma.masked_array(raw, missing) if missing.any() else raw


def _xarray_array(data: Any) -> Source:
    return _xarray(data.to_dataset(name=data.name if data.name is not None else "x"))


_OPENERS: dict[tuple[str, str], Callable[[Any], Source]] = {
    ("pandas", "DataFrame"): _pandas,
    ("pandas", "Series"): _pandas_series,
    ("polars", "DataFrame"): _polars,
    ("pyarrow", "Table"): _arrow,
    ("pyarrow", "RecordBatch"): _arrow_batch,
    ("xarray", "Dataset"): _xarray,
    ("xarray", "DataArray"): _xarray_array,
}


def known_kinds() -> Sequence[str]:
    """Return the kinds of objects that can be read, for messages."""
    return ["a dict", "a structured numpy array", *(f"{a}.{b}" for a, b in _OPENERS)]
