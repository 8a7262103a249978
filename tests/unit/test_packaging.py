"""What is installed, what it needs, and that the tasks and examples named in the documents exist."""

import ast
import re
import subprocess
import sys
from importlib.metadata import entry_points, metadata, requires
from importlib.resources import files
from pathlib import Path

import pytest

import rtamt
from rtamt.engine.native import core

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")


def make(*arguments: str) -> str:
    """Return what make prints."""
    done = subprocess.run(["make", *arguments], cwd=ROOT, check=True, capture_output=True, text=True)
    return done.stdout


def test_the_version_is_written_once():
    assert metadata("rtamt")["Version"] == rtamt.__version__
    assert re.fullmatch(r"\d+\.\d+\.\d+(\.dev\d+)?", rtamt.__version__)


def test_numpy_is_the_only_thing_a_user_must_install():
    needed = [line for line in requires("rtamt") or [] if "extra ==" not in line]
    assert needed == ["numpy>=1.23"]


def test_the_command_is_installed_and_can_be_loaded():
    (command,) = (entry for entry in entry_points(group="console_scripts") if entry.name == "rtamt")
    assert command.value == "rtamt.cli:main"
    assert callable(command.load())


def test_type_checkers_see_our_annotations():
    assert (files("rtamt") / "py.typed").is_file()


def test_the_readme_lists_every_extra():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"pip install '\.\[(\w+)\]'", readme)) == set(
        PROJECT["project"]["optional-dependencies"]
    )


def test_the_editable_build_has_what_an_isolated_build_asks_for():
    assert set(PROJECT["build-system"]["requires"]) <= set(PROJECT["dependency-groups"]["build"])


def test_make_alone_lists_every_task_once():
    (phony,) = re.findall(r"^\.PHONY: (.*)$", MAKEFILE, flags=re.MULTILINE)
    listed = re.findall(r"^make ([a-z-]+) +\S", make(), flags=re.MULTILINE)
    assert listed == phony.split()


@pytest.mark.parametrize("document", ["README.md", "CONTRIBUTING.md"])
def test_every_task_that_a_document_names_exists(document):
    named = set(
        re.findall(
            r"^make ([a-z-]+)|`make ([a-z-]+)`", (ROOT / document).read_text(encoding="utf-8"), re.MULTILINE
        )
    )
    tasks = {first or second for first, second in named}
    assert tasks
    assert tasks <= set(re.findall(r"^make ([a-z-]+)", make("help"), flags=re.MULTILINE))


def test_every_path_in_the_table_of_contributing_exists():
    rows = re.findall(r"^\|.*\|$", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    paths = {path for row in rows for path in re.findall(r"`((?:src|core|tests)/[\w./]*)`", row)}
    assert len(paths) > 10
    assert {path for path in paths if not (ROOT / path).exists()} == set()


def test_the_stub_names_what_the_core_has():
    stub = ast.parse((ROOT / "src/rtamt/engine/_core.pyi").read_text(encoding="utf-8"))
    described = {
        node.name: {inner.name for inner in node.body if isinstance(inner, ast.FunctionDef)}
        if isinstance(node, ast.ClassDef)
        else set()
        for node in stub.body
        if isinstance(node, (ast.ClassDef, ast.FunctionDef))
    }
    public = {name for name in vars(core()) if not name.startswith("_")}
    assert set(described) == public
    for name, methods in described.items():
        assert {method for method in methods if not hasattr(getattr(core(), name), method)} == set()


def test_the_binding_uses_the_stable_abi_alone():
    """Wheels for Python 3.12 and newer are compiled for it; the macros of other builds are in one header."""
    unstable = re.compile(r"\bPy[A-Z]\w*?_(?:Fast_)?(?:AS|GET|SET)_[A-Z]+\b|->tp_\w+|\b_Py\w+")
    sources = sorted((ROOT / "core/python").glob("*.[ch]pp"))
    found = {path.name: set(unstable.findall(path.read_text(encoding="utf-8"))) for path in sources}
    assert {"PyFloat_AS_DOUBLE", "PyTuple_GET_ITEM", "PySequence_Fast_GET_SIZE"} <= found.pop("cpython.hpp")
    assert {name: names for name, names in found.items() if names} == {}
    assert PROJECT["tool"]["scikit-build"]["wheel"]["py-api"] == "cp312"


def test_every_vendored_folder_is_in_the_file_of_licences():
    """The file is part of wheels and of the source distribution by the pattern in pyproject.toml."""
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    vendored = {
        found[1]
        for found in map(re.compile(r"(.*/(?:third_party/[^/]+|vendor))/").match, tracked.split())
        if found
    }
    assert len(vendored) >= 3
    licences = ROOT / "LICENSE-THIRD-PARTY.txt"
    assert (
        set(re.findall(r"^.+ \((.+): .+\)$", licences.read_text(encoding="utf-8"), re.MULTILINE)) == vendored
    )
    assert [licences.match(name) for name in PROJECT["tool"]["scikit-build"]["wheel"]["license-files"]] == [
        True
    ]
