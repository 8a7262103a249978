"""The topics of a result, their schemas, and their messages in JSON.

=========================================  ===================  =====================================================
topic                                      schema               messages
=========================================  ===================  =====================================================
``/rtamt/summary``                         ``rtamt.Summary``    one, at the start: a row for each requirement
``/rtamt/signals/NAME``                    ``rtamt.Signal``     each sample of a variable
``/rtamt/requirements/NAME/robustness``    ``rtamt.Number``     the robustness at each instant
``/rtamt/requirements/NAME/interval``      ``rtamt.Interval``   its bounds at each instant
``/rtamt/requirements/NAME/verdict``       ``rtamt.Verdict``    the verdict at the start, and at every change
``/rtamt/requirements/NAME/violations``    ``rtamt.Violation``  two for each episode of violation: its begin, its end
``/rtamt/requirements/NAME/known``         ``rtamt.Interval``   bounds of the robustness at the start, after each sample
=========================================  ===================  =====================================================

JSON has no infinities: a field whose number is infinite is left out, and a second field, such as ``value_infinite``,
is ``"inf"`` or ``"-inf"``. Every schema gives a field one type, because Foxglove reads no others.
"""

from __future__ import annotations

import heapq
import json
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rtamt.telemetry.content import Bounded, Content, Finding, Variable

#: Nanoseconds, JSON.
Message = tuple[int, dict[str, Any]]

_SECOND = 10**9
ROOT = "/rtamt"
SUMMARY = f"{ROOT}/summary"


def signal_topic(key: str) -> str:
    """Return the topic of a variable."""
    return f"{ROOT}/signals/{key}"


def topic(finding: Finding, what: str) -> str:
    """Return a topic of a requirement; ``what``: robustness, interval, verdict, violations or known."""
    return f"{ROOT}/requirements/{finding.key}/{what}"


def _object(**members: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": members}


_TEXT, _NUMBER, _WHOLE = {"type": "string"}, {"type": "number"}, {"type": "integer"}
_TIME = _object(sec=_WHOLE, nsec=_WHOLE)


def _numbers(*names: str) -> dict[str, dict[str, Any]]:
    return {key: kind for name in names for key, kind in ((name, _NUMBER), (f"{name}_infinite", _TEXT))}


_ROW = _object(
    requirement=_TEXT,
    formula=_TEXT,
    verdict=_TEXT,
    **_numbers("robustness", "lower", "upper"),
    first_violation=_TIME,
    episodes=_WHOLE,
)
#: The schemas by name.
SCHEMAS: Mapping[str, dict[str, Any]] = MappingProxyType(
    {
        "rtamt.Signal": _object(timestamp=_TIME, **_numbers("value", "lower", "upper"), name=_TEXT),
        "rtamt.Number": _object(timestamp=_TIME, **_numbers("value")),
        "rtamt.Interval": _object(timestamp=_TIME, **_numbers("lower", "upper")),
        "rtamt.Verdict": _object(timestamp=_TIME, requirement=_TEXT, verdict=_TEXT),
        "rtamt.Violation": _object(
            timestamp=_TIME,
            requirement=_TEXT,
            event=_TEXT,
            begin=_TIME,
            end=_TIME,
            at=_TIME,
            **_numbers("worst"),
        ),
        "rtamt.Summary": _object(timestamp=_TIME, requirements={"type": "array", "items": _ROW}),
    }
)


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """A topic: the name of its schema, its metadata, and its messages in order of time."""

    topic: str
    schema: str
    metadata: Mapping[str, str]
    messages: Callable[[], Iterator[Message]]


def channels(content: Content) -> list[Channel]:
    """Return all topics of a result."""
    found = [Channel(SUMMARY, "rtamt.Summary", {}, lambda: _summary(content))]
    found += [_signal(variable) for variable in content.variables]
    for finding in content.findings:
        found += _of(finding)
    return found


def in_order(found: list[Channel]) -> Iterator[tuple[int, int, dict[str, Any]]]:
    """Yield (nanoseconds, number of the channel, message), in order of time."""

    def numbered(number: int) -> Iterator[tuple[int, int, dict[str, Any]]]:
        for time, message in found[number].messages():
            yield time, number, message

    return heapq.merge(*map(numbered, range(len(found))), key=lambda each: each[:2])


def text(message: dict[str, Any]) -> bytes:
    """Return a message in JSON."""
    return json.dumps(message, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()


def foxglove_time(nanoseconds: int) -> dict[str, int]:
    """Return a time as Foxglove expects it.

    >>> foxglove_time(1_700_000_000_000_000_001)
    {'sec': 1700000000, 'nsec': 1}
    """
    seconds, rest = divmod(nanoseconds, _SECOND)
    return {"sec": seconds, "nsec": rest}


def number(name: str, value: float) -> dict[str, Any]:
    """Return the member of a number, or that of an infinity.

    >>> number("value", 2.0), number("value", float("-inf"))
    ({'value': 2.0}, {'value_infinite': '-inf'})
    """
    return {name: value} if isfinite(value) else {f"{name}_infinite": str(value)}


def _signal(variable: Variable) -> Channel:
    def messages() -> Iterator[Message]:
        for time, lower, upper in _points(variable.samples):
            if lower == upper:
                name = variable.names.get(lower)
                yield time, number("value", lower) | ({} if name is None else {"name": name})
            else:
                yield time, number("lower", lower) | number("upper", upper)

    metadata = {"variable": variable.name} | ({"unit": variable.unit} if variable.unit else {})
    return Channel(signal_topic(variable.key), "rtamt.Signal", metadata, _with_time(messages))


def _of(finding: Finding) -> list[Channel]:
    metadata = {"requirement": finding.name, "formula": finding.formula}

    def robustness() -> Iterator[Message]:
        times, values = finding.robustness.known
        for time, value in zip(times.tolist(), values.tolist(), strict=True):
            yield time, number("value", value)

    def interval(bounded: Bounded) -> Callable[[], Iterator[Message]]:
        return lambda: (
            (time, number("lower", lower) | number("upper", upper)) for time, lower, upper in _points(bounded)
        )

    def verdicts() -> Iterator[Message]:
        for time, verdict in finding.verdicts:
            yield time, {"requirement": finding.name, "verdict": verdict}

    rows: list[tuple[str, str, Callable[[], Iterator[Message]]]] = [
        ("robustness", "rtamt.Number", robustness),
        ("interval", "rtamt.Interval", interval(finding.robustness)),
        ("verdict", "rtamt.Verdict", verdicts),
        ("violations", "rtamt.Violation", lambda: _violations(finding)),
    ]
    if finding.known is not None:
        rows.append(("known", "rtamt.Interval", interval(finding.known)))
    return [
        Channel(topic(finding, what), schema, metadata, _with_time(messages))
        for what, schema, messages in rows
    ]


def _violations(finding: Finding) -> Iterator[Message]:
    for episode in finding.episodes:
        whole = {
            "begin": foxglove_time(episode.begin),
            "end": foxglove_time(episode.end),
            "at": foxglove_time(episode.at),
            **number("worst", episode.worst),
        }
        yield episode.begin, {"requirement": finding.name, "event": "begin", **whole}
        yield episode.end, {"requirement": finding.name, "event": "end", **whole}


def _summary(content: Content) -> Iterator[Message]:
    rows = []
    for finding in content.findings:
        lower, upper = float(finding.robustness.lower[0]), float(finding.robustness.upper[0])
        first = finding.first_violation
        rows.append(
            {
                "requirement": finding.name,
                "formula": finding.formula,
                "verdict": finding.verdict,
                **(number("robustness", lower) if lower == upper else {}),
                **number("lower", lower),
                **number("upper", upper),
                **({} if first is None else {"first_violation": foxglove_time(first)}),
                "episodes": len(finding.episodes),
            }
        )
    yield content.start, {"timestamp": foxglove_time(content.start), "requirements": rows}


def _points(bounded: Bounded) -> Iterator[tuple[int, float, float]]:
    return zip(bounded.times.tolist(), bounded.lower.tolist(), bounded.upper.tolist(), strict=True)


def _with_time(messages: Callable[[], Iterator[Message]]) -> Callable[[], Iterator[Message]]:
    """Return messages with their times as their first member."""
    return lambda: ((time, {"timestamp": foxglove_time(time)} | message) for time, message in messages())
