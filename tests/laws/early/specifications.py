"""Laws of whole specifications in dense time: the monitors before the horizon end where ``evaluate`` does.

What a case draws: several requirements, roles and semantics, watched formulas, epoch and sub-second times in all
forms, infinite values, and copies on the way.
"""

from __future__ import annotations

import copy
import pickle
from contextlib import suppress
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import rtamt
from rtamt.errors import EvaluationError, TraceError, UsageError
from rtamt.language.formula import Apply, Formula, fold
from rtamt.language.parsing.grammar import is_number
from rtamt.language.shares import Share, ShareKind
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.early import causeless
from rtamt.rewrite.semantics import SEMANTICS
from tests.laws.early import cases
from tests.laws.early.laws import NothingToCheck

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from random import Random

    from rtamt import Signal, Specification

NAMES = ("x", "y", "z")


class Times(NamedTuple):
    """How ticks are given: in this ``unit`` of numbers, None for dates, from the ``origin`` on."""

    resolution: str
    unit: str | None
    origin: int

    def given(self, tick: int) -> Any:
        ticks = self.origin + tick
        if self.unit is None:
            return np.datetime64(ticks, "ms")
        return ticks / 1000 if self.unit == "s" else ticks

    def tick(self, time: Any) -> int:
        if self.unit is None:
            return int(time.astype("M8[ms]").astype(int)) - self.origin
        return round(time * 1000 if self.unit == "s" else time) - self.origin

    def settings(self) -> dict[str, Any]:
        return {} if self.unit is None else {"time_unit": self.unit}


EPOCH = 1_700_000_000_000
TIMES = [Times("1ms", unit, origin) for unit in ("s", "ms", None) for origin in (0, EPOCH) if unit or origin]


def _in_milliseconds(formula: Formula) -> Formula:
    """Return a formula whose bounds are as many milliseconds as they were seconds."""

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        bounds = node.interval
        if bounds is not None:
            end = None if bounds.end is None else bounds.end / 1000
            bounds = replace(bounds, begin=bounds.begin / 1000, end=end, share=_shorter(bounds.share))
        return Apply(node.op, args, bounds)

    return fold(formula, step)


def _shorter(share: Share | None) -> Share | None:
    if share is None or share.kind is not ShareKind.DURATION:
        return share
    return replace(share, amount=share.amount / 1000)


class Drawn(NamedTuple):
    spec: Specification
    times: Times
    updates: list[tuple[int, dict[str, float]]]

    @property
    def data(self) -> dict[str, Any]:
        columns: dict[str, Any] = {name: ([], []) for name in self.spec.input_names}
        for tick, row in self.updates:
            for name, value in row.items():
                columns[name][0].append(self.times.given(tick))
                columns[name][1].append(value)
        return columns


def drawn(rng: Random, backend: str) -> Drawn:
    """Draw a specification and exact samples of its variables, each in order."""
    times = rng.choice(TIMES)
    lines = [f"{rng.choice(('input', 'output'))} float {name}" for name in NAMES]
    for i in range(rng.choice((1, 1, 2, 3))):
        names = tuple(sorted(rng.sample(NAMES, rng.randint(1, 2))))
        unbounded = rng.random() < 0.3
        formula = cases.formula(
            rng, names, depth=rng.randint(1, 3), dense=True, unbounded=unbounded, odd=False
        )
        text = str(_in_milliseconds(formula))
        lines.append(f"require R{i}: {f'({text}) >= 0' if is_number(formula) else text}")
    spec = rtamt.parse(
        "\n".join(lines),
        time=rtamt.Dense(times.resolution),
        backend=backend,
        semantics=rng.choice(list(SEMANTICS)),
    )
    if not spec.input_names:
        raise NothingToCheck
    samples = []
    for name in spec.input_names:
        tick = rng.choice((0, 0, 1, 4))
        column = []
        for _ in range(rng.randint(1, 5)):
            column.append((tick, name, rng.choice((inf, -inf)) if rng.random() < 0.05 else cases.value(rng)))
            tick += rng.choice((1, 1, 2, 3, 5))
        samples.append(column)
    updates: list[tuple[int, dict[str, float]]] = []
    if rng.random() < 0.5:
        for tick in sorted({tick for column in samples for tick, _, _ in column}):
            row = {name: value for column in samples for t, name, value in column if t == tick}
            updates.append((tick, row))
    else:
        while any(samples):
            tick, name, value = rng.choice([column for column in samples if column]).pop(0)
            updates.append((tick, {name: value}))
    return Drawn(spec, times, updates)


def _twin(rng: Random, monitor: Any) -> Any:
    """Return a monitor, or one that goes on like it."""
    kind = rng.choice(("same", "same", "copy", "pickle"))
    if kind == "copy":
        return copy.copy(monitor)
    return pickle.loads(pickle.dumps(monitor)) if kind == "pickle" else monitor


def _watched(rng: Random, spec: Specification) -> list[str]:
    names = list(spec.requirements) if len(spec.requirements) > 1 else []
    return rng.sample(names, rng.randint(0, len(names)))


def _signal(case: Drawn, semantics: str | None = None) -> tuple[Signal, dict[str, Signal], float]:
    """Return the signals of the whole and of the requirements, and the least value of any at its start."""
    result = case.spec.evaluate(case.data, semantics=semantics, **case.times.settings())
    parts = {name: part.signal for name, part in result.requirements.items()}
    return result.signal, parts, result.robustness


def _at(case: Drawn, signal: Signal) -> dict[int, float]:
    """Return the values of a signal at every tick from its first to its last."""
    points = [(case.times.tick(t), v) for t, v in zip(signal.times, signal.values.tolist(), strict=True)]
    found = dict(points)
    for tick in range(points[0][0], points[-1][0]):
        found.setdefault(tick + 1, found[tick])
    return found


def bounds(rng: Random, backend: str) -> None:
    """Bounds only become narrower, as reported and when asked for, and end in the robustness: copies too."""
    try:
        case = drawn(rng, backend)
        signal, parts, robustness = _signal(case)
    except EvaluationError:
        raise NothingToCheck from None
    every = unbounded_future(case.spec.formula) is None
    names = _watched(rng, case.spec) if every else []
    monitor = case.spec.monitor(verdict="interval", watch=names, **case.times.settings())
    reported: dict[str, dict[int, rtamt.Interval]] = {name: {} for name in ("", *names)}
    start = rtamt.Interval(-inf, inf)

    def look() -> None:
        nonlocal start
        now = monitor.interval()
        assert start.lower <= now.lower <= now.upper <= start.upper
        start = now
        for name, known in reported.items() if every else ():
            for change in monitor[name] if name else monitor.changes():
                for tick in range(case.times.tick(change.begin), case.times.tick(change.end)):
                    before = known.get(tick, rtamt.Interval(-inf, inf))
                    assert before.lower <= change.interval.lower <= change.interval.upper <= before.upper
                    known[tick] = change.interval

    try:
        for tick, row in case.updates:
            monitor.update(case.times.given(tick), **row)
            look()
            monitor = _twin(rng, monitor)
    except EvaluationError:
        raise NothingToCheck from None
    monitor.finish()
    look()
    expected = _at(case, signal)
    assert start == rtamt.Interval(robustness, robustness)
    if not every:
        return
    for tick, value in expected.items():
        assert monitor.interval(case.times.given(tick)) == rtamt.Interval(value, value)
    for name, known in reported.items():
        values = _at(case, parts[name]) if name else expected
        assert {tick: (each.lower, each.upper) for tick, each in known.items()} == {
            tick: (value, value) for tick, value in values.items()
        }


def verdicts(rng: Random, backend: str) -> None:
    """Every instant has one verdict, which is that of the whole recording under any semantics: copies too."""
    try:
        case = drawn(rng, backend)
        signal, parts, _ = _signal(case, "boolean")
    except EvaluationError:
        raise NothingToCheck from None
    names = _watched(rng, case.spec)
    monitor = case.spec.monitor(verdict="eager", watch=names, **case.times.settings())
    told: dict[str, dict[int, bool]] = {name: {} for name in ("", *names)}

    def take(news: list[rtamt.VerdictRun]) -> None:
        for name, known in told.items():
            for run in monitor[name] if name else news:
                for tick in range(case.times.tick(run.begin), case.times.tick(run.end)):
                    assert tick not in known
                    known[tick] = run.satisfied

    try:
        for tick, row in case.updates:
            take(monitor.update(case.times.given(tick), **row))
            monitor = _twin(rng, monitor)
        take(monitor.finish())
    except EvaluationError:
        raise NothingToCheck from None
    for name, known in told.items():
        values = _at(case, parts[name] if name else signal)
        assert known == {tick: value > 0 for tick, value in values.items()}


def as_defined(rng: Random, backend: str) -> None:
    """A monitor of several requirements reports what the definition does, after every event and in every mode."""
    case = drawn(rng, backend)
    verdict = rng.choice(("interval", "eager", "causation"))
    every = unbounded_future(case.spec.formula) is None
    names = _watched(rng, case.spec) if every or verdict == "eager" else []
    if verdict == "causation" and any(
        map(causeless, (each.formula for each in case.spec.requirements.values()))
    ):
        raise NothingToCheck
    settings: dict[str, Any] = {"verdict": verdict, "watch": names, **case.times.settings()}
    if verdict == "interval":
        settings["ranges"] = {name: (-9.0, 9.0) for name in case.spec.input_names if rng.random() < 0.3}
        if rng.random() < 0.3:
            settings["lateness"] = "1s"  # so that first samples wait for the watermark
            settings["on_correction"] = rng.choice(("reject", "replay"))
    made = [
        rtamt.parse(
            case.spec.text, time=case.spec.domain, backend=each, semantics=case.spec.semantics
        ).monitor(**settings)
        for each in (backend, "python")
    ]
    low, newest = (end(tick for tick, _ in case.updates) for end in (min, max))
    for kind, tick, row in _events(rng, case, settings):
        found = [_after(monitor, kind, case.times.given(tick), row) for monitor in made]
        assert found[0] == found[1]
        if isinstance(found[0], str):
            raise NothingToCheck
        beyond = 0 if kind == "finish" else 3
        for t in (*range(low, newest + 1 + beyond), None):
            time = None if t is None else case.times.given(t)
            asked = [_query(monitor, verdict, time, names, every=every) for monitor in made]
            assert asked[0] == asked[1]
        made[0] = _twin(rng, made[0])


def _events(
    rng: Random, case: Drawn, settings: Mapping[str, Any]
) -> Iterator[tuple[str, int, dict[str, Any]]]:
    """Yield the samples of a case, some of them uncertain or corrected, a watermark, and the end."""
    exact = settings["verdict"] == "causation"
    for tick, row in case.updates:
        given: dict[str, Any] = dict(row)
        for name, value in row.items():
            if not exact and abs(value) <= 8 and rng.random() < 0.2:
                given[name] = rng.choice(((value - 1, value + 1), (value, value + 0.5)))
        yield "update", tick, given
        if settings.get("on_correction") == "replay" and rng.random() < 0.3:
            yield "update", tick, {name: cases.value(rng) for name in row}
    if settings["verdict"] != "eager":
        yield "watermark", case.updates[-1][0] + rng.randint(-2, 2), {}
    yield "finish", 0, {}


def _after(monitor: Any, kind: str, time: Any, row: Mapping[str, Any]) -> Any:
    """Return what an event returns, or the class of its error."""
    try:
        if kind == "update":
            return monitor.update(time, **row)
        return monitor.finish() if kind == "finish" else monitor.watermark(time)
    except (EvaluationError, TraceError) as error:
        return type(error).__name__


def _query(monitor: Any, verdict: str, time: Any, names: list[str], *, every: bool) -> Any:
    """Return what a monitor reports of an instant, or of the start, and of what is watched."""
    found: list[Any] = [monitor[name] for name in names]
    if verdict == "eager":
        return found
    ask = monitor.interval if verdict == "interval" else monitor.causation
    if time is None:
        found.append(ask())
        if every:
            found.append(monitor.changes() if verdict == "interval" else monitor.runs())
    elif every:
        for given in ({}, {"prediction": {"x": (-1.0, 2.5)}}) if verdict == "interval" else ({},):
            with suppress(UsageError):  # before the trace, after it, or without the variable
                found.append(ask(time, **given))
    return found
