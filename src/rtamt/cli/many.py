"""``rtamt check --engine``: requirements on very many recordings, with a manifest, on any engine."""

from __future__ import annotations

import csv
import os
import sys
import time
from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rtamt.cli.arguments import is_specification, prepared_specs, specification_files
from rtamt.cli.command import CommandError, json_number, json_text, short, warn, warnings_of
from rtamt.cli.outcome import nothing_checked
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.cli.reading_options import skipping
from rtamt.cli.terminal import Progress, say, table, use_color, width_of
from rtamt.cli.written_formats import VERDICTS, format_of
from rtamt.errors import UsageError, escaped
from rtamt.extras import library
from rtamt.files import replacing
from rtamt.fleet.suite import Suite
from rtamt.fleet.verdict_table import VerdictTable, arrow_fields
from rtamt.lazy.dataclasses import replace
from rtamt.readers.formats import is_bag
from rtamt.ros.bags import columns_of
from rtamt.scale.engines import check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of
from rtamt.signals.data_errors import FILE_MENDS, NAN_MEND

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator, Sequence

    from rtamt.fleet.verdict_table import Row
    from rtamt.scale.engines import Progress as Far

#: Errors that are printed; the table has all.
_PRINTED = 10
#: Options of 'rtamt check' for single recordings, and what each is left out as.
_SINGLE = {
    **dict.fromkeys(("early", "junit", "sarif", "html", "resample", "how", "sql", "query"), None),
}
#: How to mend a missing sample where recordings are not resampled.
_GAP_MENDS = "fill the gap, hold the value before it (--hold-for DURATION), or use dense time (--time dense)"
_VERDICTS = ("satisfied", "violated", "unchecked", "error")


def run(args: argparse.Namespace) -> int:
    """Check all recordings, and print how many satisfy each requirement."""
    for name, default in _SINGLE.items():
        if getattr(args, name) not in (default, False):
            raise CommandError(
                f"--{name} is for recordings that are checked one by one: leave it out, or --engine and --manifest"
            )
    texts, patterns = _split([args.spec, *args.traces])
    specs = prepared_specs(args, texts)
    if not args.quiet:
        for spec, text in zip(specs, texts, strict=True):
            warn([one for one in warnings_of(spec, args.ignore) if one.severity != "note"], text)
    options = {
        "time": args.time_column,
        "time_unit": args.time_unit,
        "sheet": args.sheet,
        "skip_nan": tuple(args.skip_nan),
        "hold_for": args.hold_for,
        "recover": args.recover,
    }
    given = {name: value for name, value in options.items() if value not in (None, (), False)}
    recordings = recordings_of(patterns)
    if all(is_bag(recording.path) for recording in recordings):
        specs = [replace(spec, columns={**columns_of(spec), **spec.columns}) for spec in specs]
    job = Job(Suite(specs), **given)
    summary = _Summary([requirement.name for requirement in job.suite.requirements])
    with Progress() as progress, _row_writer(args.output) as write:
        counter = _Counter(progress)
        tables = check_recordings(
            job,
            recordings,
            engine=args.engine or "local",
            manifest=args.manifest,
            jobs=args.jobs,
            progress=counter.show,
        )
        for found in map(_with_options, tables):
            summary.add(found)
            write(found)
            if args.json and not args.quiet:
                progress.clear()
                for row in found:
                    say(_as_json(row))
    for error in summary.errors:
        complain(error)
    if not args.quiet and not args.json:
        color = use_color(args.color, sys.stdout)
        say(summary.text(len(recordings), counter.known, color), color=color)
    return summary.code


def _split(given: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the specifications and the recordings, in any order; folders of ``.stl`` files are specifications."""
    texts: list[str] = []
    rest: list[str] = []
    for each in given:
        files = specification_files(each) if os.path.isdir(each) else []
        if files:
            texts += files
        else:
            (texts if is_specification(each) else rest).append(each)
    if not texts:
        texts, rest = rest[:1], rest[1:]
    if not rest:
        raise CommandError("there is no recording to check: name files, folders or patterns")
    return texts, rest


class _Counter:
    """The progress line, with the time that remains at the pace so far."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._begin = time.monotonic()
        self.known = 0

    def show(self, far: Far) -> None:
        self.known = far.known
        self._progress.bar(far.known + far.done, far.total, self.remaining(far))

    def remaining(self, far: Far) -> str:
        """Return the remaining time as text; empty until one recording is done."""
        if not far.done:
            return ""
        left = far.total - far.known - far.done
        seconds = round(left * (time.monotonic() - self._begin) / far.done)
        minutes, seconds = divmod(seconds, 60)
        hours, minutes = divmod(minutes, 60)
        return f"{hours}:{minutes:02}:{seconds:02} left"


class _Summary:
    """The table of each requirement: how many recordings satisfy it, and where its robustness is worst."""

    def __init__(self, names: Sequence[str]) -> None:
        self._counts: dict[str, Counter[str]] = {name: Counter() for name in names}
        self._worst: dict[str, tuple[float, str]] = {}
        self._errors: dict[str, None] = {}
        self._total: Counter[str] = Counter()
        self._lacking = False  # whether a recording has the signals of no requirement

    def add(self, found: VerdictTable) -> None:
        verdicts = [_verdict(row) for row in found]
        if verdicts and set(verdicts) == {"unchecked"}:
            self._lacking = True
            self._errors[nothing_checked(found.rows[0].recording)] = None
        for row, verdict in zip(found, verdicts, strict=True):
            self._counts[row.requirement][verdict] += 1
            self._total[verdict] += 1
            if row.robustness is not None:
                worst = self._worst.get(row.requirement)
                if worst is None or row.robustness < worst[0]:
                    self._worst[row.requirement] = row.robustness, row.recording
            if row.error is not None and len(self._errors) <= _PRINTED:
                place = "" if row.recording in row.error else f"{row.recording}: "
                self._errors[f"{place}{row.error}"] = None

    @property
    def errors(self) -> list[str]:
        errors = list(self._errors)
        return (
            [*errors[:_PRINTED], "there are more errors; -o FILE writes all"]
            if len(errors) > _PRINTED
            else errors
        )

    @property
    def code(self) -> int:
        if self._total["error"] or self._lacking:
            return ERROR
        return VIOLATED if self._total["violated"] else OK

    def text(self, recordings: int, known: int, color: bool) -> str:
        rows: list[tuple[str, ...]] = [("requirement", *_VERDICTS, "worst robustness", "recording")]
        for name, counts in self._counts.items():
            worst, where = self._worst.get(name, (None, "-"))
            cells = [str(counts[verdict]) for verdict in _VERDICTS]
            rows.append((name, *cells, "-" if worst is None else short(worst), where))
        verdicts = ", ".join(f"{self._total[each]} {each}" for each in _VERDICTS if self._total[each])
        earlier = f", {known} of them from the manifest" if known else ""
        return (
            f"{table(rows, (1, 2, 3, 4, 5), width=width_of(sys.stdout), color=color)}\n\n"
            f"{recordings} recording{'' if recordings == 1 else 's'}{earlier}: {escaped(verdicts)}"
        )


def _with_options(found: VerdictTable) -> VerdictTable:
    """Return rows whose errors about NaN and gaps name the options that this command has."""
    if all(row.error is None for row in found):
        return found
    return VerdictTable([row._replace(error=_mended(row.error)) for row in found], found.select)


def _mended(error: str | None) -> str | None:
    if error is None or not error.endswith(NAN_MEND):
        return error and error.replace(FILE_MENDS, _GAP_MENDS)
    name = error.partition("'")[2].partition("' is NaN")[0]  # it begins with the variable
    return f"{error}{skipping(name)}"


def _verdict(row: Row) -> str:
    if row.error is not None or row.unchecked is not None:
        return "error" if row.error is not None else "unchecked"
    return "satisfied" if row.satisfied else "violated"


def _as_json(row: Row) -> str:
    known: dict[str, Any] = {"requirement": row.requirement, "trace": row.recording}
    if row.error is not None:
        return json_text({**known, "error": row.error})
    if row.unchecked is not None:
        return json_text({**known, "unchecked": row.unchecked})
    values = {
        "satisfied": row.satisfied,
        "robustness": None if row.robustness is None else json_number(row.robustness),
        "first_violation": row.first_violation,
    }
    return json_text({**known, **values})


@contextmanager
def _row_writer(path: str | None) -> Iterator[Callable[[VerdictTable], None]]:
    """Yield the writer of the rows of a recording to a table: Parquet or CSV, complete or not at all."""
    if path is None:
        yield lambda _table: None
        return
    suffix = format_of(path, VERDICTS, "with --engine, write the table")
    try:
        with replacing(path) as new:
            if suffix == ".csv":
                with open(new, "w", newline="", encoding="utf-8") as file:
                    writer = csv.writer(file)
                    writer.writerow(VerdictTable([]).columns)
                    yield lambda table: writer.writerows(map(_as_cells, table))
            else:
                with _parquet(new) as write:
                    yield write
    except OSError as error:
        raise UsageError(f"cannot write '{path}': {error.strerror or error}") from None


def _as_cells(row: Row) -> Row:
    """Return a row that spreadsheets show: they would compute a path that begins like a formula."""
    if not row.recording.startswith(("=", "+", "-", "@")):
        return row
    return row._replace(recording=os.path.join(".", row.recording))


@contextmanager
def _parquet(path: str) -> Iterator[Callable[[VerdictTable], None]]:
    arrow = library("pyarrow", "a table in Parquet", "data")
    parquet = library("pyarrow.parquet", "a table in Parquet", "data")
    waiting: list[Row] = []

    def write(found: VerdictTable) -> None:
        waiting.extend(found)
        if len(waiting) >= 2**16:  # a row group
            flush()

    def flush() -> None:
        if waiting:
            writer.write_table(VerdictTable(waiting).to_arrow())
            waiting.clear()

    with parquet.ParquetWriter(path, arrow.schema(arrow_fields())) as writer:
        yield write
        flush()
