"""Many traces in one array for each variable, a trace in each row."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.arrays import TIME, as_array, is_mapping
from rtamt.signals.data_errors import missing_variable
from rtamt.signals.time_columns import check_mapping

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Rows:
    """Traces of samples: ``columns[name][i, :lengths[i]]`` are those of a variable in trace ``i``.

    ``times``: timestamps as the caller gave them, common to all traces or a row for each; None without.
    """

    columns: Mapping[str, NDArray[Any]]
    lengths: NDArray[np.int64]
    times: NDArray[Any] | None

    @classmethod
    def of(
        cls, data: Any, names: Sequence[str], lengths: Any, new_rows: Callable[[int, int], FloatArray]
    ) -> Rows:
        """Return the rows of a mapping from variable to an array of shape (traces, samples); values are not checked.

        ``lengths``: how many samples of each row belong to the trace; None: all of them. ``new_rows``: makes the
        arrays of doubles, of any content.
        """
        if not is_mapping(data):
            raise TraceError(
                f"expected a mapping from variable to an array of shape (traces, samples), got {type(data).__name__}"
            )
        if TIME not in data:
            check_mapping(data, TIME, names)
        columns = {}
        for name in names:
            if name not in data:
                raise missing_variable(name, [str(key) for key in data if key != TIME])
            columns[name] = _array(
                data[name], name, (2,), "give an array of shape (traces, samples)", new_rows
            )
        shapes = {name: column.shape for name, column in columns.items()}
        if not shapes:
            raise UsageError("the formula reads no variable, so that there is nothing to evaluate in a batch")
        first, shape = next(iter(shapes.items()))
        for name, other in shapes.items():
            if other != shape:
                raise TraceError(
                    f"'{first}' has the shape {shape} and '{name}' {other}: give one value of each at every sample",
                    variable=name,
                )
        times = None
        if TIME in data:
            times = _array(
                data[TIME], TIME, (1, 2), "give timestamps for all traces, or a row of them for each", None
            )
            if times.shape not in (shape, shape[1:]):
                raise TraceError(
                    f"'{TIME}' has the shape {times.shape} and '{first}' {shape}: give one timestamp for every sample",
                    variable=TIME,
                )
        return cls(columns, _lengths(lengths, *shape), times)

    def __len__(self) -> int:
        return len(self.lengths)

    @property
    def width(self) -> int:
        """The number of samples in a row."""
        return int(next(iter(self.columns.values())).shape[1])

    def row(self, i: int) -> dict[str, Any]:
        """Return one trace as it would be evaluated alone."""
        n = self.lengths[i]
        row: dict[str, Any] = {name: column[i, :n] for name, column in self.columns.items()}
        for name, values in row.items():
            if values.dtype.kind in "OU":  # names of members, or no numbers
                row[name] = values.tolist()
        if self.times is not None:
            row[TIME] = self.times[i, :n] if self.own_times else self.times[:n]
        return row

    @property
    def plain(self) -> bool:
        """Whether all values are numbers that doubles can hold."""
        return all(column.dtype == np.float64 for column in self.columns.values())

    @property
    def own_times(self) -> bool:
        """Whether each trace has timestamps of its own."""
        return self.times is not None and self.times.ndim == 2

    @property
    def has_nan(self) -> bool:
        """Whether a sample is NaN; samples after the end of their trace do not count."""
        for column in self.columns.values():
            if column.size and np.isnan(column.min()):  # no array of truths where there is none
                wrong = np.isnan(column) & (np.arange(self.width) < self.lengths[:, None])
                if wrong.any():
                    return True
        return False


def _array(
    values: Any,
    name: str,
    dimensions: tuple[int, ...],
    how: str,
    new_rows: Callable[[int, int], FloatArray] | None,
) -> NDArray[Any]:
    """Return a copy of the values; with ``new_rows``, doubles where all of them are numbers of at most 64 bits."""
    try:
        raw = as_array(values)
    except (TypeError, ValueError):
        raise TraceError(
            f"'{name}' has rows of different lengths: fill them up, and give lengths=", variable=name
        ) from None
    if isinstance(values, np.ma.MaskedArray) and values.mask.any():
        raise TraceError(
            f"'{name}' has masked values, and samples of a batch cannot be missing: evaluate the traces one by one",
            variable=name,
        )
    if raw.ndim not in dimensions:
        expected = " or ".join(map(str, dimensions))
        raise TraceError(f"'{name}' has {raw.ndim} dimensions, expected {expected}: {how}", variable=name)
    if new_rows is not None and raw.dtype.kind in "fiub" and raw.dtype.itemsize <= 8:
        numbers = new_rows(*raw.shape)
        np.copyto(numbers, raw, casting="unsafe")
        return numbers
    return np.array(raw, order="C")


def _lengths(lengths: Any, count: int, width: int) -> NDArray[np.int64]:
    if lengths is None:
        return np.full(count, width, np.int64)
    array = np.asarray(lengths)
    if array.shape != (count,) or (count and array.dtype.kind not in "iu"):
        raise UsageError(
            f"lengths is {shown(lengths)}; give a whole number of samples for each of the {count} traces"
        )
    outside = (array < 0) | (array > width)
    if outside.any():
        i = int(outside.argmax())
        raise UsageError(f"lengths[{i}] is {array[i]}; the rows have {width} samples")
    return array.astype(np.int64)
