"""Functions of :mod:`rtamt.lazy.functions` are those of their modules, and imported when one is called."""

from __future__ import annotations

import inspect
import math
import pickle
import subprocess
import sys
from copy import deepcopy

import pytest

from rtamt.lazy.functions import Function, Functions

MATH = Functions("math")


def test_modules_are_imported_when_one_of_their_functions_is_called():
    lines = (
        "import sys; from rtamt.lazy.functions import Functions",
        "colorsys = Functions('colorsys'); convert = colorsys.rgb_to_hsv; assert 'colorsys' not in sys.modules",
        "assert convert(0, 0, b=1)[2] == 1 and 'colorsys' in sys.modules",
    )
    subprocess.run([sys.executable, "-c", "\n".join(lines)], check=True)


def test_a_function_is_the_same_object_every_time_and_calls_that_of_the_module():
    assert MATH.hypot is MATH.hypot
    assert MATH.hypot(3, 4) == 5
    assert MATH.isclose(1, 2, rel_tol=0.9)


def test_errors_are_those_of_the_function():
    with pytest.raises(ValueError, match=r"nonnegative|domain"):
        MATH.sqrt(-1)
    with pytest.raises(AttributeError, match="no_such_function"):
        MATH.no_such_function()


def test_inspection_reads_the_function():
    assert inspect.unwrap(Functions("textwrap").dedent) is __import__("textwrap").dedent
    assert repr(MATH.hypot) == "<function math.hypot>"


@pytest.mark.parametrize("copied", [deepcopy, lambda each: pickle.loads(pickle.dumps(each))])
def test_a_copy_calls_the_same_function(copied):
    assert isinstance(copied(MATH.hypot), Function)
    assert copied(MATH.hypot).__wrapped__ is math.hypot
    assert copied(MATH).hypot(3, 4) == 5
