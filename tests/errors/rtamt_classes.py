"""Specifications of RTAMT's classes with messages of their own, for the tests of sentences."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

import rtamt


class Sensor:
    """A message class of the tests."""

    def __init__(self) -> None:
        self.value = 0.0
        self.label = ""


class Picky:
    """A class that cannot be made without arguments."""

    def __init__(self, size: int) -> None:
        self.size = size


def provide(monkeypatch):
    """Provide the module ``some_msgs``."""
    module = ModuleType("some_msgs")
    module.Sensor, module.Picky = Sensor, Picky
    monkeypatch.setitem(sys.modules, "some_msgs", module)


def fresh(text=None, names="x y"):
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.import_module("some_msgs", "Sensor")
    for name in names.split():
        spec.declare_var(name, "float")
    spec.declare_var("sensor", "Sensor")
    if text is not None:
        spec.spec = text
        spec.parse()
    return spec


def message_of(call, kind=rtamt.RTAMTException):
    with pytest.raises(rtamt.RTAMTException) as info:
        call()
    assert type(info.value) is kind
    prefix, _, text = str(info.value).partition(": ")
    assert prefix == "RTAMT Exception"
    return text
