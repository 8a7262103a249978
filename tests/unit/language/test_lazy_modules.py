"""Every function that the operator table names exists: they are imported only when they are called."""

from __future__ import annotations

from functools import partial

import pytest

from rtamt.language.operators import STL
from rtamt.language.unwritten import UNWRITTEN
from rtamt.lazy.dataclasses import fields
from rtamt.lazy.functions import Function


def functions(operator):
    values = [getattr(operator, field.name) for field in fields(operator)]
    return [value.func if isinstance(value, partial) else value for value in values]


@pytest.mark.parametrize(
    "operator", [*STL.operators, *UNWRITTEN.values()], ids=lambda operator: operator.name
)
def test_functions_of_an_operator_exist(operator):
    named = [value for value in functions(operator) if isinstance(value, Function)]
    assert all(callable(function.__wrapped__) for function in named)


def test_the_table_names_its_functions():
    assert (
        sum(isinstance(value, Function) for operator in STL.operators for value in functions(operator)) > 150
    )
