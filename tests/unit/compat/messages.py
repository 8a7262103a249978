"""Specifications over numbers and over objects with fields."""

from __future__ import annotations

from dataclasses import dataclass, field

import rtamt


@dataclass
class Inner:
    """A message inside a message."""

    level: float = 0.0


@dataclass
class Message:
    """A message with a number, a text and a nested message."""

    value: float = 0.0
    label: str = ""
    inner: Inner = field(default_factory=Inner)

    @classmethod
    def get_fields_and_field_types(cls):
        """Return the types of the fields, as classes of messages do."""
        return {"value": "double", "label": "string", "inner": "some_msgs/Inner"}


def declared(text, names="x y", cls=rtamt.StlDiscreteTimeSpecification, **constants):
    spec = cls()
    for name in names.split():
        spec.declare_var(name, "float")
    for name, value in constants.items():
        spec.declare_const(name, "float", value)
    spec.spec = text
    spec.parse()
    return spec


def with_messages(text, names="req rob"):
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.import_module("some_msgs", "Message")
    for name in names.split():
        spec.declare_var(name, "Message")
    spec.spec = text
    spec.parse()
    return spec
