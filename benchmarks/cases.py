"""The cases of ``make bench``: formulas, signals, and time limits."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path[:0] = [str(Path(__file__).parents[1] / "conformance" / "peers"), str(Path(__file__).parents[1])]

import timescales  # noqa: E402 - found by the line above

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE = 3.0  # seconds in which a window must be full
LIMIT = 0.03  # seconds of online updates, or of repeated evaluations
LONGEST = 1.0  # the limit of one evaluation in seconds, extrapolated from the previous one

#: Who is asked about the families: the others have no unbounded operators, or take milliseconds a sample.
CAN = ("this", "RTAMT", "Reelay")

#: The paper's section 7.1.
PHI = {
    "φ1": "req >= 3",
    "φ2": "req >= 3 -> gnt >= 3",
    "φ3": "req >= 3 -> eventually[0:5](gnt >= 3)",
    "φ4": "historically(req >= 3 -> (not(req >= 3) until[0:5] (gnt >= 3)))",
}


@dataclass(frozen=True)
class Case:
    """One formula on signals of one size: a point on one curve per tool."""

    group: str
    curve: str
    x: int
    formula: str
    time: str
    mode: str
    workload: dict[str, Any] = field(hash=False)
    #: The tools that run the case; all if empty. "this (python)" is our Python back end.
    tools: tuple[str, ...] = ()

    @property
    def key(self) -> tuple[str, str, str, str]:
        """The name of its curve."""
        return (self.group, self.curve, self.time, self.mode)


def _normal(names: tuple[str, ...], n: int, warm: int = 0) -> dict[str, Any]:
    return {"kind": "normal", "names": names, "n": n, "warm": warm, "patience": PATIENCE}


def paper(quick: bool) -> Iterator[Case]:
    """Scaling with the trace and the formula; Python against C++."""
    sizes = (100, 1000) if quick else (100, 1000, 10_000, 100_000, 1_000_000, 10_000_000)
    for time in ("discrete", "dense"):
        for name, text in PHI.items():
            names = ("req", "gnt") if "gnt" in text else ("req",)
            for n in sizes:
                if time == "dense" and n > 1_000_000:
                    continue  # the samples, as lists that every tool takes, would be 10 GB
                tools = ("this", "RTAMT")
                yield Case(
                    f"paper: offline, {time} time", name, n, text, time, "offline", _normal(names, n), tools
                )
    for k in (100, 1000) if quick else (100, 1000, 10_000, 100_000, 1_000_000):
        text = f"always[0:{k}](a + b >= -2)"
        tools = ("this", "this (python)", "RTAMT")
        workload = _normal(("a", "b"), k + 20_000, k)
        yield Case("paper: back ends, online", "always", k, text, "discrete", "online", workload, tools)


def online(quick: bool) -> Iterator[Case]:
    """Cost of an update over the window length, for every tool that supports it."""
    windows = (10, 100) if quick else (10, 100, 1000, 10_000, 100_000)
    shapes = {
        "historically[0:{k}](a >= -2)": ("discrete", "dense"),
        "always[0:{k}](a >= -2)": ("discrete", "dense"),
        "historically[0:{k}](once[0:{k}](a >= 0))": ("discrete",),
        "always[0:{k}](eventually[0:{k}](a >= 0))": ("discrete",),
        "(a >= -2) since[0:{k}] (a >= 1)": ("discrete", "dense"),
        "(a >= -2) until[0:{k}] (a >= 1)": ("discrete", "dense"),
    }
    for shape, times in shapes.items():
        for time in times:
            for k in windows:
                text = shape.format(k=k)
                warm = 2 * k if shape.count("{k}") > 1 else k
                workload = _normal(("a",), warm + 20_000, warm)
                yield Case(f"online, {time} time", shape, k, text, time, "online", workload)


def whole(quick: bool) -> Iterator[Case]:
    """One window offline, every tool that can."""
    for time in ("discrete", "dense"):
        for n in (100,) if quick else (100, 1000, 10_000):
            text = "always[0:20](a >= -2)"
            yield Case(f"offline, {time} time", text, n, text, time, "offline", _normal(("a",), n))


def families(quick: bool) -> Iterator[Case]:
    """Timescales, past form online and offline, future form offline."""
    for family in timescales.FAMILIES:
        for unit in (1,) if quick else (1, 10, 100):
            for form, mode in (("past", "offline"), ("future", "offline"), ("past", "online")):
                n = 10_000
                workload = {
                    "kind": family, "names": (family, unit, False), "n": 2000 if quick else n,
                    "warm": 0 if quick else 4000 if mode == "online" else 0, "patience": PATIENCE,
                }  # fmt: skip
                text = timescales.formula(family, unit, form)
                yield Case(
                    f"Timescales: {form} form, {mode}", family, unit, text, "discrete", mode, workload, CAN
                )


def parsing() -> Iterator[Case]:
    """A formula of 1 000 characters, from text to a monitor that is ready to run."""
    text = " and ".join(["(a >= 3 -> {}[0:5](a >= 3))"] * 28)
    for name, time, mode in (
        ("eventually", "discrete", "offline"),
        ("once", "discrete", "online"),
        ("eventually", "dense", "online"),
    ):
        yield Case(
            "parsing",
            f"1 000 characters, {name}",
            1,
            text.format(*[name] * 28),
            time,
            mode,
            {"kind": "parse"},
        )


def cases(quick: bool) -> list[Case]:
    """Return everything."""
    return [*paper(quick), *online(quick), *whole(quick), *families(quick), *parsing()]
