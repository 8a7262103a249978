"""Specifications of the paper's API can be copied and pickled, at any time; a copy goes its own way."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING, Any

import pytest

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

Copy = pytest.mark.parametrize(
    "copied",
    [copy.copy, copy.deepcopy, lambda spec: pickle.loads(pickle.dumps(spec))],
    ids=["copy", "deepcopy", "pickle"],
)


class Message:
    """What a program for RTAMT imports and declares."""

    def __init__(self, value: float = 0.0) -> None:
        self.value = value


def specified(cls: type, text: str) -> Any:
    spec = cls()
    spec.declare_var("x", "float")
    spec.declare_const("limit", "float", 3)
    spec.spec = text
    spec.parse()
    return spec


@Copy
def test_a_parsed_specification_copies_without_cannot_pickle_mappingproxy(
    copied: Callable[[Any], Any],
) -> None:
    twin = copied(specified(rtamt.StlDiscreteTimeSpecification, "once[0:1](x >= limit)"))
    assert twin.evaluate({"time": [0, 1], "x": [5, 4]}) == [[0.0, 2.0], [1.0, 2.0]]
    twin.spec = "x >= limit + 1"
    twin.parse()
    assert twin.evaluate({"time": [0], "x": [5]}) == [[0.0, 1.0]]


@Copy
@pytest.mark.parametrize("compiled", [True, False])
def test_a_copied_discrete_monitor_drove_the_original(
    copied: Callable[[Any], Any], compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not compiled:
        monkeypatch.setattr("rtamt.compat.backends.is_compiled", lambda: False)
    spec = specified(rtamt.StlDiscreteTimeOnlineSpecification, "once[0:1](x >= limit)")
    assert [spec.update(0, [("x", 9)]), spec.update(1.5, [("x", 0)])] == [6.0, 6.0]
    twin = copied(spec)
    assert [twin.get_value("x"), twin.get_value("x >= limit"), twin.sampling_violation_counter] == [
        0.0,
        -3.0,
        1,
    ]
    assert [twin.update(2.5, [("x", 1)]), twin.update(3.5, [("x", 8)])] == [-2.0, 5.0]
    assert [spec.update(2.5, [("x", 2)]), spec.get_value("x"), twin.get_value("x")] == [-1.0, 2.0, 8.0]
    twin.reset()
    assert [twin.update(0, [("x", 4)]), spec.update(3.5, [("x", 0)])] == [1.0, -1.0]


@Copy
def test_a_copied_dense_monitor_goes_on_where_the_original_was(copied: Callable[[Any], Any]) -> None:
    spec = specified(rtamt.StlDenseTimeOnlineSpecification, "once[0:2](x >= limit)")
    assert spec.update(["x", [[0, 9], [1, 0]]]) == [[0, 6.0], [1, 6.0]]
    twin = copied(copied(spec))
    assert twin.get_value("x >= limit") == [[0, 6.0], [1, -3.0]]
    assert twin.update(["x", [[4, 1]]]) == [[3, -3.0], [4, -2.0]]
    assert spec.update(["x", [[2, 5], [5, 0]]]) == [[3, 2.0], [5, 2.0]]


@Copy
@pytest.mark.parametrize(
    ("cls", "data"),
    [
        (rtamt.StlDiscreteTimeOfflineSpecification, [{"time": [0, 1], "x": [5, 1]}]),
        (rtamt.StlDenseTimeOfflineSpecification, [["x", [[0, 5], [1, 1]]]]),
    ],
)
def test_a_copy_knows_what_was_evaluated(copied: Callable[[Any], Any], cls: type, data: list[Any]) -> None:
    spec = specified(cls, "always(x >= limit)")
    spec.evaluate(*data)
    values = spec.get_value("x >= limit")
    twin = copied(spec)
    spec.spec = "x >= 0"
    spec.parse()
    assert twin.get_value("x >= limit") == values
    assert twin.explain().summary[0] == "violated, robustness -2: always(x >= 3)"


@Copy
def test_a_specification_over_imported_messages_copies_without_cannot_pickle_module(
    copied: Callable[[Any], Any],
) -> None:
    spec = rtamt.StlDiscreteTimeOnlineSpecification()
    spec.import_module(__name__, "Message")
    spec.declare_var("x", "Message")
    spec.declare_var("rob", "Message")
    spec.spec = "rob.value = once(x.value >= 3)"
    spec.parse()
    first = spec.update(0, [("x", Message(5))])
    twin = copied(spec)
    assert twin.update(1, [("x", Message(9))]).value == 6.0
    assert (first.value, spec.get_value("rob.value")) == (2.0, 2.0)
    assert twin.modules == spec.modules
