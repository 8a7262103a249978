"""The job on one recording, shared by all engines."""

from __future__ import annotations

import hashlib
import json
import os
from functools import partial
from typing import TYPE_CHECKING, Any, TypedDict

from rtamt.errors import StlError, UsageError, choices
from rtamt.fleet.verdict_table import Row, VerdictTable
from rtamt.lazy.dataclasses import replace
from rtamt.readers.assemble import trace_of
from rtamt.readers.formats import is_bag
from rtamt.readers.read import choice, opened
from rtamt.scale.bags import table_of_bag
from rtamt.scale.members import over_members
from rtamt.scale.recordings import fetched
from rtamt.signals.arrays import TIME

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Sequence

    from typing_extensions import Unpack

    from rtamt.fleet.groups import Way
    from rtamt.fleet.suite import Suite
    from rtamt.readers.selection import Choice
    from rtamt.readers.source import Source
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification

#: Increased with every change of what an operator means: results of other versions are computed again.
SEMANTICS_VERSION = 3


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

        def found() -> VerdictTable:
            with fetched(path) as local:
                table = self._table(path, lambda: self._evaluate(path, local))
            return table if local == path else _with_name(table, local, path)

        return self._table(path, found)

    def table_of(self, name: str, source: Callable[[], Any]) -> VerdictTable:
        """Return the rows of a recording in memory; ``source`` returns it, as :func:`rtamt.read` takes it."""
        return self._table(name, lambda: self._evaluate(name, source()))

    def _table(self, name: str, evaluate: Callable[[], VerdictTable]) -> VerdictTable:
        try:
            return evaluate()
        except StlError as error:
            return self.failed(name, str(error))
        except Exception as error:  # noqa: BLE001 - one recording of many, which must not end the job
            return self.failed(name, f"{name} cannot be checked: {type(error).__name__}: {error}")

    def failed(self, path: str, error: str) -> VerdictTable:
        """Return the rows of a recording that cannot be read."""
        rows = [Row(path, each.name, error=error) for each in self.suite.requirements]
        return VerdictTable(rows, self.suite.select)

    def _evaluate(self, name: str, data: Any) -> VerdictTable:
        """Evaluate all requirements on what they read of a recording, under the names that it has there."""
        options, suite = self.options, self.suite
        with opened(data, options.get("sheet"), None, options.get("recover", False)) as source:
            if isinstance(data, (str, os.PathLike)) and is_bag(os.fspath(data)):
                return table_of_bag(suite, source, partial(self._choice, bag=True), name)
            signals = source.signals
            trace = None if suite.reads_everything else self._together(source)
        if trace is not None:
            return suite.evaluate(trace, recording=name, signals=signals)

        def read(way: Way, spec: Specification | None) -> tuple[Specification | None, Trace]:
            # Many a source can be read only once.
            with opened(data, options.get("sheet"), None, options.get("recover", False)) as source:
                if spec is None or not spec.groups:
                    return None, trace_of(source, self._choice(signals, [way]))
                complete = way.domain.sampled and way.rule is None
                return over_members(
                    source, spec, lambda mine: self._choice(signals, [mine]), name, complete=complete
                )

        return suite.evaluate_apart(signals, read, recording=name)

    def _together(self, source: Source) -> Trace | None:
        """Return what the requirements that can be checked read of a recording; None where one cannot read it."""
        signals, suite = source.signals, self.suite
        choice = self._choice(signals, suite.ways_over(signals))
        if not signals.issuperset(name for name in choice.columns or () if name != TIME):
            return None
        try:
            return trace_of(source, choice)
        except StlError:  # reported with the requirements that it concerns
            return None

    def _choice(self, signals: Collection[str], ways: Iterable[Way], *, bag: bool = False) -> Choice:
        """Return what some requirements read of a recording with these signals; ``bag``: whether it is a bag."""
        options = self.options
        columns: dict[str, None] = {}
        skipped: dict[str, None] = {}
        types: dict[str, Any] = {}
        gaps = bag
        for way in ways:
            # In discrete time a gap is an error, unless each signal has its own time base, or is sampled.
            gaps = gaps or way.domain.own_time_bases or way.rule is not None
            places = way.binding.found_in(signals)
            for name in way.inputs:
                column = places.get(name, name)
                columns[column] = None
                if name in way.types:
                    types[column] = way.types[name]
                if name in options.get("skip_nan", ()) or (way.rule is not None and way.rule.skip_nan):
                    skipped[column] = None
        made = choice(
            options.get("time"),
            columns or None,
            None,
            None,
            [column for column in skipped if column in signals],
            options.get("hold_for"),
            options.get("time_unit"),
            types,
        )
        return replace(made, gaps=gaps)

    def __reduce__(self) -> tuple[Any, ...]:
        return _job, (*self.suite.sent(), dict(self.options))


def _job(make: Callable[..., Suite], given: Iterable[Any], options: dict[str, Any]) -> Job:
    return Job(make(*given), **options)


def _with_name(table: VerdictTable, local: str, path: str) -> VerdictTable:
    """Return rows whose errors name a recording by its address, in place of the temporary copy."""
    rows = [row if row.error is None else row._replace(error=row.error.replace(local, path)) for row in table]
    return VerdictTable(rows, table.select)
