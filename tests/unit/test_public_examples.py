"""Every public class has an example in its docstring; the doctests of the modules run them."""

import inspect

import pytest

import rtamt

CLASSES = sorted(name for name in rtamt.__all__ if inspect.isclass(getattr(rtamt, name)))


@pytest.mark.parametrize("name", CLASSES)
def test_a_public_class_has_an_example(name: str) -> None:
    assert ">>> " in (getattr(rtamt, name).__doc__ or "")
