"""The docstring of a package lists its modules: it is the map of the code."""

import importlib
import re
from pathlib import Path

import pytest

import rtamt

SRC = Path(rtamt.__file__).parent
PACKAGES = sorted(
    folder.name
    for folder in SRC.iterdir()
    if len([path for path in folder.glob("*.py") if path.name != "__init__.py"]) > 1
)


def modules(folder: Path) -> set[str]:
    files = {path.stem for path in folder.glob("*.py*") if path.stem != "__init__"}
    return files | {path.parent.name for path in folder.glob("*/__init__.py")}


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_lists_each_of_its_modules(package: str) -> None:
    doc = importlib.import_module(f"rtamt.{package}").__doc__ or ""
    rows = doc.split("\n\n")
    listed = set(re.findall(r"^(\w+)  +\S", next(r for r in rows if r.startswith("===")), re.MULTILINE))
    listed -= {"module"}
    named = listed | set(re.findall(r"``(\w+)``", doc))
    assert modules(SRC / package) - named == set()
    assert listed - modules(SRC / package) == set()


def test_the_folders_of_unit_tests_are_the_packages_of_the_library() -> None:
    folders = {path.parent.name for path in Path(__file__).parent.glob("*/__init__.py")}
    assert folders - {"docs"} <= {path.parent.name for path in SRC.glob("*/__init__.py")}
    assert set(PACKAGES) <= folders
