"""A comment that silences a checker gives its reason in the same line."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PYTHON = re.compile(r"# (?:noqa\b(?::(?: ?[A-Z]+\d+,?)+)?|type: ignore\b(?:\[[\w, -]+\])?)(?P<reason>.*)")
CPP = re.compile(r"// NOLINT(?:NEXTLINE|BEGIN)?(?:\([^)]*\))?(?P<reason>.*)")
SILENCED = {".py": PYTHON, ".pyi": PYTHON, ".cpp": CPP, ".hpp": CPP}
REASON = re.compile(r"( - | # |: )\w+")


def test_each_silenced_warning_has_its_reason():
    found = []
    for folder in ("src", "core", "tests", "tools", "benchmarks", "conformance", "examples"):
        for path in sorted((ROOT / folder).rglob("*")):
            pattern = SILENCED.get(path.suffix)
            if pattern is None or "third_party" in path.parts or path == Path(__file__):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                silenced = pattern.search(line)
                if silenced and not REASON.match(silenced["reason"]):
                    found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert found == []
