"""The file format of the corpus: one case per line, JSON, every number with all digits (see README.md)."""

from __future__ import annotations

import json
import math
from dataclasses import MISSING, asdict, dataclass, field, fields
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

FOLDER = Path(__file__).parent / "corpus"
FILES = ("corners.jsonl", "discrete.jsonl", "dense.jsonl")
#: Cases of groups, whose members appear and disappear.
QUANTIFIED = "quantified.jsonl"

SEMANTICS = (
    "standard",
    "boolean",
    "output_robustness",
    "input_vacuity",
    "input_robustness",
    "output_vacuity",
)

#: Operators whose values differ between C libraries in the last bits, and the relative tolerance of formulas with them.
ROUNDED = frozenset(
    "exp ln log pow sin cos tan asin acos atan atan2 hypot sinh cosh tanh degrees radians".split()
)
TOLERANCE = 1e-12


class CorpusError(ValueError):
    """A file of the corpus is malformed: one sentence with the file, the line and the id of the case."""


@dataclass
class Case:
    """A formula, a trace and the answer; README.md says what each field holds."""

    id: str
    time: str
    formula: str
    step: str
    signals: dict[str, list[Any]]
    tree: dict[str, Any] = field(default_factory=dict, kw_only=True)
    semantics: str = "standard"
    inputs: list[str] = field(default_factory=list)
    values: list[Any] = field(default_factory=list)
    end: int | None = None
    known: list[Any] | None = None

    @property
    def seconds(self) -> Fraction:
        """The sampling period, or the length of a tick."""
        return Fraction(self.step)

    @property
    def instants(self) -> list[int]:
        """Of a dense trace, the ticks at which some signal has a sample, in order."""
        return sorted({t for samples in self.signals.values() for t, _ in samples})


def read(name: str, seen: dict[str, str] | None = None) -> list[Case]:
    """Return the cases of one file of the corpus; raise :class:`CorpusError` where it is malformed.

    ``seen``: where the ids of earlier files are.
    """
    cases = []
    for where, record in records(FOLDER / name, Case, ("tree", "values", "known"), seen):
        case = Case(**record)
        if case.time not in ("discrete", "dense"):
            raise CorpusError(f"{where}: the time is {case.time!r}, and must be 'discrete' or 'dense'")
        if case.semantics not in SEMANTICS:
            raise CorpusError(f"{where}: the semantics is {case.semantics!r}, and must be one of {SEMANTICS}")
        if case.time == "dense" and case.end is None:
            raise CorpusError(f"{where}: the field 'end' is missing, which dense cases have")
        if not isinstance(case.signals, dict) or not isinstance(case.values, list):
            raise CorpusError(f"{where}: 'signals' must be an object, and 'values' a list")
        samples = len(next(iter(case.signals.values()), []))
        if case.time == "discrete" and len(case.values) != samples:
            raise CorpusError(f"{where}: there are {len(case.values)} values for {samples} samples")
        cases.append(case)
    return cases


def robustness() -> list[Case]:
    """Return all cases of robustness, which the tools are asked; raise :class:`CorpusError` as :func:`read` does."""
    seen: dict[str, str] = {}
    return [case for name in FILES for case in read(name, seen) if case.semantics == "standard"]


def records(
    path: Path, kind: Any, stored: Iterable[str], seen: dict[str, str] | None = None
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the fields of each case of a file, and where it is.

    Args:
        path: the file.
        kind: the class of its cases.
        stored: the fields that each line has, though they have default values.
        seen: where the ids of other files are; those of this file are added.
    """
    known = [each.name for each in fields(kind)]
    plain = {each.name for each in fields(kind) if each.default is each.default_factory is MISSING}
    needed = [name for name in known if name in {*plain, *stored}]
    places = {} if seen is None else seen
    for k, line in enumerate(path.read_bytes().splitlines(), 1):
        where = f"{path}, line {k}"
        try:
            record = json.loads(line)
        except ValueError as error:
            raise CorpusError(f"{where}: no JSON ({error})") from None
        if not isinstance(record, dict):
            raise CorpusError(f"{where}: a case is an object, not {json.dumps(record)[:40]}")
        where += f", case '{record['id']}'" if "id" in record else ""
        for name in needed:
            if name not in record:
                raise CorpusError(f"{where}: the field '{name}' is missing")
        for name in record:
            if name not in known:
                raise CorpusError(f"{where}: there is no field '{name}'; the fields are {', '.join(known)}")
        if record["id"] in places:
            raise CorpusError(f"{where}: {places[record['id']]} has this id, too")
        places[record["id"]] = f"{path.name}, line {k},"
        yield where, each(record, number)


def write(name: str, cases: list[Case]) -> None:
    """Write one file of the corpus; fields with default values are left out."""
    with (FOLDER / name).open("w", encoding="utf-8") as file:
        file.writelines(line(case) + "\n" for case in cases)


def line(case: Case) -> str:
    """Return a case as one line of the file."""
    kept = {k: v for k, v in asdict(case).items() if k == "known" or v not in ("standard", [], None)}
    return json.dumps(each(kept, text), separators=(",", ":"), allow_nan=False, ensure_ascii=False)


def each(value: Any, change: Any) -> Any:
    """Change every number of a signal or an answer: JSON has no infinity."""
    if isinstance(value, dict):
        return {k: each(v, change) for k, v in value.items()}
    return [each(v, change) for v in value] if isinstance(value, list) else change(value)


def text(value: Any) -> Any:
    """Return an infinity as JSON has it; everything else stays."""
    return str(value) if isinstance(value, float) and math.isinf(value) else value


def number(value: Any) -> Any:
    """Return an infinity as Python has it; everything else stays."""
    return float(value) if value in ("inf", "-inf") else value
