"""Patterns of :mod:`rtamt.lazy.patterns` behave as those of the standard library."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rtamt.lazy.patterns import lazy_pattern


def test_patterns_are_those_of_the_standard_library_and_compiled_at_their_first_use():
    lines = (
        "import re, rtamt.lazy.patterns as ours",
        "compiled = []; compile = re.compile",
        "re.compile = lambda *given: compiled.append(given) or compile(*given)",
        "word = ours.lazy_pattern('(?P<word>[a-z]+)', re.ASCII); assert not compiled",
        "assert word.fullmatch('word')['word'] == 'word' and word.pattern == '(?P<word>[a-z]+)'",
        "assert word.fullmatch('w1') is None and word.flags & re.ASCII and len(compiled) <= 2",
    )
    subprocess.run([sys.executable, "-c", "\n".join(lines)], check=True)
    with pytest.raises(AttributeError):
        _ = lazy_pattern("x").no_such_attribute
