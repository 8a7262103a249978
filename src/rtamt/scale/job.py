"""The job on one recording, shared by all engines."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any, TypedDict

from rtamt.errors import StlError, UsageError, choices
from rtamt.fleet.verdict_table import Row, VerdictTable
from rtamt.readers.assemble import trace_of
from rtamt.readers.read import choice, opened
from rtamt.scale.recordings import fetched

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from typing_extensions import Unpack

    from rtamt.fleet.suite import Suite
    from rtamt.signals.trace import Trace

#: Increased with every change of what an operator means: results of other versions are computed again.
SEMANTICS_VERSION = 1


class ReaderOptions(TypedDict, total=False):
    """The reading settings of recordings, see :func:`rtamt.read`; ``skip_nan`` has variables of the requirements."""

    time: str | None
    time_unit: str | None
    sheet: str | None
    skip_nan: Sequence[str]
    hold_for: str | None
    recover: bool


class Job:
    r"""A suite, and how recordings are read for it.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> job = Job(rtamt.Suite(rtamt.parse("always(speed <= 30)", period=1)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t,speed\n0,5\n1,31\n")
    ...     job.table(str(path)).rows[0][2:5]
    (-1.0, False, 1.0)
    """

    def __init__(self, suite: Suite, **options: Unpack[ReaderOptions]) -> None:
        for name in options:
            if name not in ReaderOptions.__annotations__:
                known = ReaderOptions.__annotations__
                raise UsageError(f"there is no reader option '{name}'{choices(name, known, 'options')}")
        for name in options.get("skip_nan", ()):
            if name not in suite.input_names:
                raise UsageError(f"skip_nan has '{name}', which no requirement reads")
        self.suite = suite
        self.options = options

    @property
    def key(self) -> str:
        """A hash of everything but the recording that decides about its rows: programs, options, semantics."""
        parts = [self.suite.fingerprint, self.suite.select, SEMANTICS_VERSION]
        parts += [[name, self.options[name]] for name in sorted(self.options)]  # type: ignore[literal-required] # its own names
        return hashlib.sha256(json.dumps(parts, default=list).encode()).hexdigest()

    def table(self, path: str) -> VerdictTable:
        """Return the rows of a recording in a file, local or remote; what is wrong becomes the error in all of them."""

        def source() -> Trace:
            with fetched(path) as local:
                return self._read(local)

        return self._table(path, source)

    def table_of(self, name: str, source: Callable[[], Any]) -> VerdictTable:
        """Return the rows of a recording in memory; ``source`` returns it, as :func:`rtamt.read` takes it."""
        return self._table(name, lambda: self._read(source()))

    def _table(self, name: str, read: Callable[[], Trace]) -> VerdictTable:
        try:
            return self.suite.evaluate(read(), recording=name)
        except StlError as error:
            return self.failed(name, str(error))
        except Exception as error:  # noqa: BLE001 - one recording of many, which must not end the job
            return self.failed(name, f"{name} cannot be checked: {type(error).__name__}: {error}")

    def failed(self, path: str, error: str) -> VerdictTable:
        """Return the rows of a recording that cannot be read."""
        rows = [Row(path, each.name, error=error) for each in self.suite.requirements]
        return VerdictTable(rows, self.suite.select)

    def _read(self, data: Any) -> Trace:
        """Read what the requirements read of a recording, under the names that it has there."""
        options = self.options
        with opened(data, options.get("sheet"), None, options.get("recover", False)) as source:
            columns: dict[str, None] = {}
            skipped: dict[str, None] = {}
            types: dict[str, Any] = {}
            whole = self.suite.reads_everything
            for way in self.suite.ways:
                places = way.binding.found_in({*source.signals, *source.aliases})
                for name in way.inputs:
                    column = places.get(name, name)
                    if column not in source.signals and column not in source.aliases:
                        whole = True  # messages then list what there is
                    columns[column] = None
                    if name in way.types:
                        types[column] = way.types[name]
                    if name in options.get("skip_nan", ()) or (way.rule is not None and way.rule.skip_nan):
                        skipped[column] = None
            return trace_of(
                source,
                choice(
                    options.get("time"),
                    None if whole else columns,
                    None,
                    None,
                    [column for column in skipped if column in source.signals],
                    options.get("hold_for"),
                    options.get("time_unit"),
                    types,
                ),
            )

    def __reduce__(self) -> tuple[Any, ...]:
        return _job, (*self.suite.sent(), dict(self.options))


def _job(make: Callable[..., Suite], given: Iterable[Any], options: dict[str, Any]) -> Job:
    return Job(make(*given), **options)
