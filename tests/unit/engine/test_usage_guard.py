"""A monitor that two calls use at once because a value or a field calls it back.

Each sample is taken whole or refused, in some order, as if one call had come after the other; what is raised
is an error of the library's.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import pytest

import rtamt
from rtamt.errors import StlError
from tests.unit.engine.meddling import (
    BACKENDS,
    CALLING,
    TAKING,
    Meddler,
    Message,
    after_actions,
    observe,
    start_monitor,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    Action = Callable[[Any], Any]


@pytest.mark.parametrize("calling", CALLING)
@pytest.mark.parametrize(
    ("domain", "taking"), [(domain, taking) for domain, ways in TAKING.items() for taking in ways]
)
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_value_that_calls_its_monitor_leaves_it_as_one_call_after_the_other_would(
    backend: str, domain: str, taking: str, calling: str
) -> None:
    take, call = TAKING[domain][taking], CALLING[calling]
    monitor = start_monitor(domain, backend)
    value = Meddler(lambda: call(monitor))
    after_actions(monitor, lambda m: take(m, value))
    assert value.again
    plain: Action = lambda m: take(m, 2.0)  # noqa: E731 - one of several actions
    orders: tuple[tuple[Action, ...], ...] = ((call, plain), (plain, call), (call,), (plain,), ())
    assert observe(monitor) in [
        observe(after_actions(start_monitor(domain, backend), *order)) for order in orders
    ]


@pytest.mark.parametrize("calling", ["update", "reset", "finish", "update_many", "copy"])
@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_field_that_calls_its_monitor_leaves_it_as_one_call_after_the_other_would(
    backend: str, domain: str, calling: str
) -> None:
    options: dict[str, Any] = {"period": 1, "tolerance": 1e9} if domain == "discrete" else {"time": "dense"}
    call: dict[str, Action] = {
        "update": lambda m: m.update(10.0, req=Message(7.0)),
        "update_many": lambda m: m.update_many({"time": [11.0], "req.value": [8.0]}),
        **{name: CALLING[name] for name in ("reset", "finish", "copy")},
    }

    def fresh() -> Any:
        made = rtamt.parse("once[0:2](req.value >= 3)", backend=backend).monitor(**options)
        return after_actions(made, lambda m: m.update(2.0, req=Message(1.0)))

    def after(m: Any) -> list[str]:
        return [
            str(m.samples),
            *(
                repr(after_actions(m, lambda m, t=t: m.update(t, req=Message(t))).samples)
                for t in (50.0, 51.0)
            ),
        ]

    monitor = fresh()
    value = Meddler(lambda: call[calling](monitor))
    after_actions(monitor, lambda m: m.update(3.0, req=Message(value)))
    assert value.again
    plain: Action = lambda m: m.update(3.0, req=Message(2.0))  # noqa: E731 - one of several actions
    orders: tuple[tuple[Action, ...], ...] = (
        (call[calling], plain),
        (plain, call[calling]),
        (call[calling],),
    )
    assert after(monitor) in [after(after_actions(fresh(), *order)) for order in orders]


@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_value_that_is_read_by_reading_itself_ends_and_spares_the_monitor(
    backend: str, domain: str
) -> None:
    monitor = start_monitor(domain, backend)
    before = observe(copy.copy(monitor))

    class Endless(Meddler):
        def __float__(self) -> float:
            monitor.update(3.0, x=self)
            return 1.0

    with pytest.raises((RecursionError, StlError)):
        monitor.update(3.0, x=Endless(print))
    assert observe(monitor) == before


@pytest.mark.parametrize("domain", ["discrete", "dense"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_what_a_value_raises_by_itself_reaches_the_caller_and_spares_the_monitor(
    backend: str, domain: str
) -> None:
    monitor = start_monitor(domain, backend)
    before = observe(copy.copy(monitor))

    class Rude(Meddler):
        def __float__(self) -> float:
            raise LookupError("mine")

    for call in TAKING[domain].values():
        with pytest.raises(LookupError, match=r"^'?mine'?$"):
            call(monitor, Rude(print))
    assert observe(monitor) == before


def test_a_list_that_is_emptied_while_it_is_read_is_no_danger() -> None:
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y"):
        spec.declare_var(name, "float")
    spec.spec = "x - y"
    spec.parse()
    spec.update(0, [("x", 1.0), ("y", 1.0)])
    sample: list[Any] = []
    sample += [["x", Meddler(sample.clear)], ["y", 5.0]]
    assert spec.update(1, sample) == 1.0  # y, which was gone by then, keeps its value
