"""What is falsified: the formulas as they were published, as they are monitored here, and what others report.

Published formulas are those of the configurations and entries of the competition's participants; where these
differ, both are printed. `reported` is how often and after how many simulations, on average, FalCAuN falsified
the formula in 10 runs (its summary for the competition of 2024; it did not take part in those left out).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import cars
import rtamt
import transmission
from rtamt.search import PiecewiseConstant, Problem

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Benchmark:
    """One requirement of the competition."""

    name: str
    published: tuple[str, ...]  # in the order of what is monitored here, then other versions
    formula: str
    reported: str = "-"

    def problem(self) -> Problem:
        """Return the search: piecewise constant inputs, each number held for 5 s."""
        plant, duration, period, inputs = _of_transmission() if self.name.startswith("AT") else _of_cars()
        return Problem(rtamt.parse(self.formula, period=period), plant, inputs, duration)


def _of_transmission() -> tuple[Callable[..., object], float, str, dict[str, PiecewiseConstant]]:
    inputs = {"throttle": PiecewiseConstant(6, 0, 100), "brake": PiecewiseConstant(6, 0, 325)}
    return transmission.drive, transmission.DURATION, "10ms", inputs


def _of_cars() -> tuple[Callable[..., object], float, str, dict[str, PiecewiseConstant]]:
    inputs = {"throttle": PiecewiseConstant(20, 0, 1), "brake": PiecewiseConstant(20, 0, 1)}
    return cars.chase, cars.DURATION, "25ms", inputs


def _at5(gear: int) -> Benchmark:
    there = f"abs(gear - {gear}) <= 0.5"
    return Benchmark(
        f"AT5{gear}",
        (
            f"G[0,30] ((not g{gear} and F[0.001,0.1] g{gear}) -> F[0.001,0.1] G[0,2.5] g{gear})",
            f"G[0,30] ((not g{gear} and X g{gear}) -> X G[0,2.5] g{gear})",
        ),
        f"always[0:30]((not({there}) and eventually[10ms:100ms]({there})) -> "
        f"eventually[10ms:100ms](always[0:2.5]({there})))",
    )


def _at6(letter: str, end: int, speed: int, reported: str, other: tuple[str, ...] = ()) -> Benchmark:
    return Benchmark(
        f"AT6{letter}",
        (f"G[0,30] (rpm < 3000) -> G[0,{end}] (speed < {speed})", *other),
        f"always[0:30](rpm < 3000) -> always[0:{end}](speed < {speed})",
        reported,
    )


BENCHMARKS = (
    Benchmark("AT1", ("G[0,20] speed < 120",), "always[0:20](speed < 120)", "10/10, 896"),
    Benchmark("AT2", ("G[0,10] rpm < 4750",), "always[0:10](rpm < 4750)", "10/10, 256"),
    _at5(1),
    _at5(2),
    _at5(3),
    _at5(4),
    _at6("a", 4, 35, "10/10, 1002"),
    _at6("b", 8, 50, "0/10"),
    _at6("c", 20, 65, "10/10, 898", ("G[0,30] (rpm < 3000) -> G[0,4] (speed < 70)",)),
    Benchmark("CC1", ("G[0,100] y5 - y4 <= 40",), "always[0:100](y5 - y4 <= 40)", "10/10, 396"),
    Benchmark(
        "CC2",
        ("G[0,70] F[0,30] y5 - y4 >= 15",),
        "always[0:70](eventually[0:30](y5 - y4 >= 15))",
        "10/10, 76",
    ),
    Benchmark(
        "CC3",
        (
            "G[0,80] ((G[0,20] y2 - y1 <= 20) or (F[0,20] y5 - y4 >= 40))",
            "G[0,80] ((G[0,20] y2 - y1 <= 20) or (F[0,20] y5 - y4 <= 40))",
        ),
        "always[0:80](always[0:20](y2 - y1 <= 20) or eventually[0:20](y5 - y4 >= 40))",
        "10/10, 122",
    ),
    Benchmark(
        "CC4",
        ("G[0,65] F[0,30] G[0,5] y5 - y4 >= 8",),
        "always[0:65](eventually[0:30](always[0:5](y5 - y4 >= 8)))",
        "4/10, 1256.5",
    ),
    Benchmark(
        "CC5",
        ("G[0,72] F[0,8] ((G[0,5] y2 - y1 >= 9) -> (G[5,20] y5 - y4 >= 9))",),
        "always[0:72](eventually[0:8](always[0:5](y2 - y1 >= 9) -> always[5:20](y5 - y4 >= 9)))",
    ),
    Benchmark(
        "CCx",
        ("and of G[0,50] y(i+1) - y(i) > 7.5, i = 1..4",),
        " and ".join(f"always[0:50](y{i + 1} - y{i} > 7.5)" for i in range(1, 5)),
        "0/10",
    ),
)
