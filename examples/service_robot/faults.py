"""What may go wrong, in which component, from when on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: From a component to what may go wrong in it; the seed chooses.
FAULTS = {
    "planner": ("cut off",),  # the tree is cut off, and its last branch joined to the goal unchecked
    "perception": ("drift", "jump"),  # of the localisation
    "controller": ("stuck drive", "wrong gain"),  # the lateral drive stands still or not; a sign is wrong
}


@dataclass(frozen=True)
class Fault:
    """A fault: its component and kind, when it begins (s), where to (rad) and with which sign."""

    component: str
    kind: str
    onset: float
    direction: float
    side: float

    def active(self, component: str, time: float) -> str | None:
        """Return the kind of the fault if it is in this component and has begun."""
        return self.kind if component == self.component and time >= self.onset else None


def draw(component: str | None, seed: int) -> Fault | None:
    """Return the fault of a seed in a component; None for a healthy robot."""
    if component is None:
        return None
    rng = np.random.default_rng([seed, 4])
    return Fault(
        component,
        kind=str(rng.choice(FAULTS[component])),
        onset=round(float(rng.uniform(8.0, 12.0)), 1),
        direction=float(rng.uniform(0.0, 2 * np.pi)),
        side=float(rng.choice([-1.0, 1.0])),
    )
