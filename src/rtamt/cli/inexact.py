"""Which samples a monitor of a stream takes that are missing, or measured with an error."""

from __future__ import annotations

from rtamt.lazy.dataclasses import dataclass
from rtamt.verdicts.modes import MODES


@dataclass(frozen=True, slots=True)
class Inexact:
    """What the readers of lines make of missing samples and bounds; by default an error that ends there."""

    #: Whether samples may be missing, or bounds.
    taken: bool = False
    #: Whether samples may be late, so that each may hold some of the variables.
    late: bool = False
    #: What messages add about a missing sample, and about bounds, where they are not taken.
    missing: str = ""
    bounds: str = ""


def rejected() -> Inexact:
    """Return the handling of such samples in the modes that take none: an error that names those that do.

    >>> rejected().bounds
    '--verdict eager and --verdict interval take bounds'
    """
    modes = " and ".join(f"--verdict {mode.name}" for mode in MODES.values() if mode.inexact)
    return Inexact(missing=f"{modes} take missing samples", bounds=f"{modes} take bounds")
