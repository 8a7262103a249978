"""The file format of the corpus: one case per line, JSON, every number with all digits (see README.md)."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

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


def read(name: str) -> list[Case]:
    """Return the cases of one file of the corpus."""
    with (FOLDER / name).open(encoding="utf-8") as lines:
        return [Case(**each(json.loads(line), number)) for line in lines]


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
