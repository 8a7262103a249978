"""A fault-tolerant elevator control system of an aircraft: two elevators, each moved by one of two actuators.

What is public of such systems is followed: four actuators (left outer LO, left inner LI, right inner
RI, right outer RO), three hydraulic circuits (H1 for LO, H2 for both inner ones, H3 for RO), two flight
control units (PFCU1 left, PFCU2 right), a full-range and a limited-range control law, and five modes
of an actuator. No transfer function of one is public. Every number is therefore *declared*, here::

    OUTER, INNER   the actuators           FLOATING   an elevator that nothing moves
    LIMITED        the limited-range law   TAKE_OVER  the time that a change of hands takes
    STEP           samples and mode logic

The logic, declared as well where nothing is public:

- An actuator that has failed is *Isolated*, for good; without pressure, or without a control unit, it is *Off*.
- The outer actuators are *Active* and the inner ones *Standby* while both outer ones work.
- As soon as one outer actuator is lost the inner pair takes over, and an outer one that still works goes to
  *Standby*: both sides move alike. Until the take-over is complete the inner ones are *Passive*.
- If an inner one is lost as well, each side uses what it has; with nothing left its elevator floats.
- A control unit that fails leaves both sides to the other one, which then has the limited-range law for all.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

STEP = 0.02  # s
TAKE_OVER = 0.1  # s
LIMITED = 1.4  # the greatest command of the limited-range law; commands have no unit


@dataclass(frozen=True)
class Actuator:
    """A position servo of second order: natural frequency, damping, and limits of rate and position."""

    frequency: float  # rad/s
    damping: float
    rate: float  # 1/s
    reach: float  # to either side

    def acceleration(self, command: float, position: float, rate: float) -> float:
        """Return what the servo does (1/s^2); at its limit of rate it accelerates no further."""
        wanted = max(-self.reach, min(self.reach, command))
        made = self.frequency**2 * (wanted - position) - 2 * self.damping * self.frequency * rate
        return 0.0 if abs(rate) >= self.rate and made * rate > 0 else made


OUTER = Actuator(frequency=9.0, damping=1.0, rate=10.0, reach=2.0)
INNER = Actuator(frequency=7.2, damping=1.0, rate=5.0, reach=2.0)
FLOATING = Actuator(frequency=1.5, damping=0.7, rate=3.0, reach=2.0)  # the air drives it to 0

CIRCUIT = {"LO": "H1", "LI": "H2", "RI": "H2", "RO": "H3"}
SIDES = {"left": ("LO", "LI"), "right": ("RO", "RI")}  # outer first
UNITS = ("PFCU1", "PFCU2")
FAULTS = (*CIRCUIT, "H1", "H2", "H3", *UNITS)


class Mode(Enum):
    """What an actuator does."""

    ISOLATED = "Isolated"
    OFF = "Off"
    PASSIVE = "Passive"
    STANDBY = "Standby"
    ACTIVE = "Active"


def modes(faults: Mapping[str, float], time: float) -> dict[str, Mode]:
    """Return the mode of each actuator at a time; ``faults``: from what fails to when (seconds)."""
    failed = {name for name, since in faults.items() if since <= time}
    found = {}
    for name, circuit in CIRCUIT.items():
        if name in failed:
            found[name] = Mode.ISOLATED
        elif circuit in failed or failed.issuperset(UNITS):
            found[name] = Mode.OFF
        else:
            found[name] = Mode.STANDBY
    ready = {name for name, mode in found.items() if mode is Mode.STANDBY}
    use_inner = not {"LO", "RO"} <= ready and {"LI", "RI"} <= ready
    for pair in SIDES.values():
        order = reversed(pair) if use_inner else pair
        chosen = next((name for name in order if name in ready), None)
        if chosen in {"LI", "RI"}:
            handed = _handed_over(faults, time)
            found[chosen] = Mode.ACTIVE if time >= handed + TAKE_OVER else Mode.PASSIVE
        elif chosen is not None:
            found[chosen] = Mode.ACTIVE
    return found


def _handed_over(faults: Mapping[str, float], time: float) -> float:
    """Return when the inner actuators were called: at the first loss of an outer one or of its circuit."""
    return min(since for name, since in faults.items() if name in {"LO", "RO", "H1", "H3"} and since <= time)


@dataclass(frozen=True)
class Elevators:
    """The plant: called with the pilot's command, yields it with both positions at every step.

    ``faults``: from what fails (an actuator, a hydraulic circuit or a control unit) to when, in seconds.

    >>> steady = list(Elevators(duration=3)(lambda time: 1.0))
    >>> round(steady[-1][1]["lep"], 3), round(steady[-1][1]["rep"], 3)
    (1.0, 1.0)
    """

    duration: float = 10.0
    faults: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in self.faults:
            if name not in FAULTS:
                raise ValueError(f"'{name}' cannot fail; these can: {', '.join(FAULTS)}")

    def __call__(self, pc: Callable[[float], float]) -> Iterator[tuple[float, dict[str, float]]]:
        """Simulate; yields ``(time, {"pc", "lep", "rep"})``."""
        state = dict.fromkeys(SIDES, (0.0, 0.0))
        for k in range(round(self.duration / STEP) + 1):
            time = k * STEP
            command = pc(time)
            yield time, {"pc": command, "lep": state["left"][0], "rep": state["right"][0]}
            allowed = self._law(command, time)
            for side, actuator in self._moved_by(time).items():
                state[side] = _moved(actuator, allowed, state[side])

    def _law(self, command: float, time: float) -> float:
        limited = any(self.faults.get(unit, float("inf")) <= time for unit in UNITS)
        return max(-LIMITED, min(LIMITED, command)) if limited else command

    def _moved_by(self, time: float) -> dict[str, Actuator]:
        now = modes(self.faults, time)
        return {
            side: OUTER if now[outer] is Mode.ACTIVE else INNER if now[inner] is Mode.ACTIVE else FLOATING
            for side, (outer, inner) in SIDES.items()
        }


def _moved(actuator: Actuator, command: float, state: tuple[float, float]) -> tuple[float, float]:
    """Integrate one side over one step, the command held."""
    target = 0.0 if actuator is FLOATING else command

    def derivative(_time: float, now: tuple[float, float]) -> tuple[float, float]:
        position, rate = now
        return rate, actuator.acceleration(target, position, rate)

    position, rate = solve_ivp(derivative, (0.0, STEP), state, rtol=1e-6, atol=1e-9).y[:, -1]
    return float(position), max(-actuator.rate, min(actuator.rate, float(rate)))


def after_h1(pc: Callable[[float], float]) -> Iterator[tuple[float, dict[str, float]]]:
    """Simulate 10 s in which the first hydraulic circuit fails at 2 s: the plant of problem.toml."""
    return Elevators(faults={"H1": 2.0})(pc)
