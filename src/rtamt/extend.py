"""Extend the language with custom operators: the records, formula constructors, and the C++ header.

See ``docs/how-to/extend.md`` for worked examples. A new operator is one record; ``STL.extend(...)``
returns a language with it, for ``language=`` of :func:`rtamt.parse` and ``--language`` on the command line.

>>> from rtamt.extend import STL, Fixity, Operator, Sort
>>> import rtamt
>>> between = Operator("between", ("between",), Fixity.FUNCTION, 200, (Sort.NUMBER,) * 3, Sort.NUMBER,
...     "The first operand, held between the others.", "between(x, 0, 1) >= 1",
...     definition=lambda x, low, high: x.clip(low, high))
>>> spec = rtamt.parse("always(between(x, 0, 1) >= y)", language=STL.extend(between))
>>> spec.evaluate({"x": [5, 0.5], "y": [0, 0]}).robustness
0.5
"""

from __future__ import annotations

from pathlib import Path

from rtamt.engine.native import core
from rtamt.language.contents import variables
from rtamt.language.definitions.dense import QUARTERS, Steps
from rtamt.language.formula import Apply, Const, Formula, Interval, Var
from rtamt.language.operators import STL
from rtamt.language.records import Blocks, Bounds, Compiled, Fixity, Language, Operator, Sort, Tense
from rtamt.rewrite.truth import truth

__all__ = [
    "QUARTERS",
    "STL",
    "Apply",
    "Blocks",
    "Bounds",
    "Compiled",
    "Const",
    "Fixity",
    "Formula",
    "Interval",
    "Language",
    "Operator",
    "Sort",
    "Steps",
    "Tense",
    "Var",
    "get_cmake_dir",
    "get_include",
    "truth",
    "variables",
]


def get_include() -> str:
    """Return the folder of the header ``rtamt/kernel.hpp``, for a compiler's ``-I``."""
    return str(_find_installed("include"))


def get_cmake_dir() -> str:
    """Return the folder of ``rtamt-config.cmake``, for CMake's ``-Drtamt_DIR=``."""
    return str(_find_installed("cmake"))


def _find_installed(folder: str) -> Path:
    # Next to the compiled core, which an editable install keeps apart from the Python files.
    return Path(str(core().__file__)).parents[1] / folder
