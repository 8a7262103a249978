"""The law of whole sessions: whatever is asked after any event, both back ends report the same.

What a case draws: a time domain, several requirements, semantics, a mode and its settings, times in all forms, samples
that are late, missing, uncertain, outside their ranges or corrections, watermarks, copies, the end and a reset.
"""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING, Any, NamedTuple

import rtamt
from rtamt.errors import EvaluationError, SpecificationError, StlError
from rtamt.language.parsing.grammar import is_number
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.semantics import SEMANTICS
from tests.laws.early import cases
from tests.laws.early.laws import NothingToCheck
from tests.laws.early.specifications import NAMES, TIMES, Times, _in_milliseconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from random import Random

#: What the core forgets at no fixed instant, and the definition never.
FORGOTTEN = "which are those from"


class Case(NamedTuple):
    text: str
    settings: dict[str, Any]
    domain: Any
    semantics: str
    times: Times

    def monitor(self, backend: str) -> Any:
        spec = rtamt.parse(self.text, time=self.domain, backend=backend, semantics=self.semantics)
        return spec.monitor(**self.settings)


def _drawn(rng: Random) -> Case:
    dense = rng.random() < 0.5
    times = rng.choice(TIMES)
    lines = [f"{rng.choice(('input', 'output'))} float {name}" for name in NAMES]
    for i in range(rng.choice((1, 1, 2, 3))):
        names = tuple(sorted(rng.sample(NAMES, rng.randint(1, 2))))
        if rng.random() < 0.15:
            formula = cases.partial(rng)
        else:
            unbounded = rng.random() < 0.3
            formula = cases.formula(rng, names, depth=rng.randint(1, 3), dense=dense, unbounded=unbounded)
        text = str(_in_milliseconds(formula))
        if rng.random() < 0.15:
            asked = f"valid({rng.choice(names)})"
            text = rng.choice(("{1} -> {0}", "{0} or not {1}", "once[0:2ms]({1}) and {0}")).format(
                f"({text}) >= 0" if is_number(formula) else f"({text})", asked
            )
            lines.append(f"require R{i}: {text}")
            continue
        lines.append(f"require R{i}: {f'({text}) >= 0' if is_number(formula) else text}")
    domain = rtamt.Dense("1ms") if dense else rtamt.Discrete("1ms")
    spec = rtamt.parse("\n".join(lines), time=domain)
    if not spec.input_names:
        raise NothingToCheck
    settings: dict[str, Any] = {"verdict": rng.choice(("eager", "interval", "interval", "causation"))}
    every = unbounded_future(spec.formula) is None or settings["verdict"] == "eager"
    requirements = list(spec.requirements) if every and len(spec.requirements) > 1 else []
    settings["watch"] = rng.sample(requirements, rng.randint(0, len(requirements)))
    if settings["verdict"] != "causation" and rng.random() < 0.5:
        settings["ranges"] = {name: (-3.0, 3.0) for name in spec.input_names if rng.random() < 0.6}
    if settings["verdict"] == "eager":
        settings["explain"] = rng.random() < 0.2
    if settings["verdict"] == "interval":
        settings |= {"lateness": rng.choice(("2ms", "5ms", 0))} if rng.random() < 0.6 else {}
        settings |= {"on_correction": "replay"} if rng.random() < 0.4 else {}
        settings |= {"at": "start"} if rng.random() < 0.2 else {}
    return Case("\n".join(lines), settings | times.settings(), domain, rng.choice(list(SEMANTICS)), times)


def _events(rng: Random, case: Case, names: tuple[str, ...]) -> Iterator[tuple[str, int, dict[str, Any]]]:
    """Yield updates, watermarks and copies, then the end and a reset: what, a tick, and values."""
    late, exact = "lateness" in case.settings, case.settings["verdict"] == "causation"
    order = list(range(rng.randint(2, 8)))
    if late and rng.random() < 0.6:
        order.sort(key=lambda tick: tick + rng.randint(0, 3))

    def value() -> Any:
        drawn, kind = cases.value(rng), rng.random()
        if exact or kind >= 0.25:
            return drawn
        return None if kind < 0.1 else (drawn - 0.5, drawn + 0.5)

    for tick in order:
        some = isinstance(case.domain, rtamt.Dense) or (late and rng.random() < 0.5)
        yield "update", tick, {name: value() for name in names if not some or rng.random() < 0.7}
        kind = rng.choice(("copy", "pickle", "watermark", "advance", "correction", *[""] * 5))
        if kind == "correction" and late:
            yield "update", tick, {name: cases.value(rng) for name in names}
        elif kind == "watermark" and case.settings["verdict"] != "eager":
            yield "watermark", tick + rng.randint(-2, 1), {}
        elif kind == "advance" and case.settings["verdict"] == "interval":
            yield "advance", tick + rng.randint(-1, 7), {}
        elif kind in {"copy", "pickle"}:
            yield kind, tick, {}
    yield "finish", max(order), {}
    if rng.random() < 0.3:
        yield "reset", 0, {}
        yield "update", 0, dict.fromkeys(names, 1.0)


def _try(call: Callable[..., Any], *given: Any, **values: Any) -> Any:
    """Return what a call returns, or its error; of several undefined operations each back end names one."""
    try:
        return call(*given, **values)
    except EvaluationError:
        return EvaluationError
    except StlError as error:
        return type(error), str(error)


def _after(monitor: Any, kind: str, time: Any, row: dict[str, Any]) -> tuple[Any, Any]:
    """Return a monitor after an event, and what that returned."""
    if kind == "copy":
        return copy.copy(monitor), None
    if kind == "pickle":
        return pickle.loads(pickle.dumps(monitor)), None
    given = [] if kind in {"finish", "reset"} else [time]
    if kind == "watermark" and not hasattr(monitor, "watermark"):
        return monitor, None
    return monitor, _try(getattr(monitor, kind), *given, **row)


def _reports(monitor: Any, case: Case, tick: int, *, finished: bool) -> Iterator[Any]:
    """Yield all that a monitor reports."""
    yield monitor.samples
    for name in case.settings["watch"]:
        yield _try(monitor.__getitem__, name)
    verdict = case.settings["verdict"]
    if verdict == "eager":
        return
    ask = monitor.interval if verdict == "interval" else monitor.causation
    yield _try(ask)
    yield _try(monitor.changes if verdict == "interval" else monitor.runs)
    for asked in (0, tick, tick + 1)[: 2 if finished else 3]:
        time = case.times.given(asked)
        yield _try(ask, time)
        if verdict == "interval":
            yield _try(ask, time, prediction={"x": (-1.0, 2.5)})


def _same_reports(one: Any, other: Any) -> bool:
    forgotten = isinstance(one, tuple) and isinstance(one[-1], str) and FORGOTTEN in one[-1]
    return bool(one == other) or forgotten


def as_defined(rng: Random, backend: str) -> None:
    """A monitor reports what the one of the definition does, whatever comes, and whatever is asked."""
    case = _drawn(rng)
    try:
        monitors = [case.monitor(each) for each in (backend, "python")]
    except (SpecificationError, rtamt.UsageError):  # no causation, or a setting that the formula rules out
        raise NothingToCheck from None
    finished = False
    for kind, tick, row in _events(rng, case, monitors[0].input_names):
        time = case.times.given(tick)
        (one, first), (other, second) = (_after(monitor, kind, time, row) for monitor in monitors)
        assert first == second
        monitors = [one, other]
        finished = kind == "finish" or (finished and kind != "reset")
        if case.settings.get("explain") and isinstance(first, list) and first:
            assert _try(one.explain, first[-1]) == _try(other.explain, second[-1])
        reports = [list(_reports(monitor, case, tick, finished=finished)) for monitor in monitors]
        assert all(map(_same_reports, *reports))
