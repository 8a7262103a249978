"""Monitors start without :mod:`typing`, whose names are those of the standard library to a type checker.

Nor do they import modules of this package whose functions they do not call.
"""

from __future__ import annotations

import subprocess
import sys
import typing

import pytest

from rtamt.lazy import typing as lazy_typing

MONITOR = "assert rtamt.parse('always[0:1](x >= 3)').monitor().update(0, x=1.0) is None"


#: How many modules of this package such a monitor imports at most: each costs it 0.2 ms.
MODULES = 96

#: What a monitor of plain numbers in discrete time leaves out, by package.
UNUSED = {
    "": "datetime inspect",
    "rtamt.": "extras files",
    "rtamt.compiler.": "metadata",
    "rtamt.engine.": "offline time_axis",
    "rtamt.language.": "definitions enumerations expansions parameters shares tables printing",
    "rtamt.language.parsing.": "diagnostics ranges sampling_clause templates",
    "rtamt.language.units.": "dimensions pint_units rules",
    "rtamt.rewrite.": "merge presence",
    "rtamt.signals.": "dense_arrays episodes listing resampling samples sampling slicing ticks trace unit_conversion",
}


@pytest.mark.parametrize("module", ["typing", "numpy", "dataclasses", "copy", "datetime", "inspect"])
def test_a_monitor_is_parsed_made_and_updated_without(module):
    code = f"import sys; sys.modules[{module!r}] = None; import rtamt; {MONITOR}"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_monitor_imports_no_module_that_it_does_not_use():
    unused = [package + name for package, names in UNUSED.items() for name in names.split()]
    code = f"import sys; sys.modules |= dict.fromkeys({unused!r}); import rtamt; {MONITOR}"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_monitor_imports_no_module_by_the_library_that_imports_others():
    code = f"import sys, rtamt; {MONITOR}; import importlib; library = (importlib, importlib.import_module); "
    code += "ours = [module for name, module in sys.modules.items() if name.startswith('rtamt')]; "
    code += "assert not [m for m in ours for value in vars(m).values() for each in library if value is each]"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_first_monitor_imports_no_more_modules_than_before():
    code = f"import sys, rtamt; {MONITOR}; print(*(name for name in sys.modules if name.startswith('rtamt')))"
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert len(said.split()) <= MODULES, said


def test_every_name_is_one_of_the_standard_library():
    assert all(hasattr(typing, name) for name in lazy_typing.__all__)
    assert all(hasattr(lazy_typing, name) for name in lazy_typing.__all__)


@pytest.mark.parametrize("names", [typing, lazy_typing], ids=lambda names: names.__name__)
def test_what_runs_behaves_as_in_the_standard_library(names):
    class Sized(names.Protocol):
        kind: names.ClassVar[str] = "row"

    class Row(Sized):
        pass

    assert Row.kind == "row"
    assert names.cast("int", "a") == "a"
    assert names.TYPE_CHECKING is False
