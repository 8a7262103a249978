"""The formats of other tools, once: each with what reads it and what writes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import UsageError, choices
from rtamt.interchange.breach import read_breach, write_breach
from rtamt.interchange.c2po import read_c2po
from rtamt.interchange.c2po_writing import write_c2po
from rtamt.interchange.fret.export import write_fret
from rtamt.interchange.fret.project import read_fret
from rtamt.interchange.mtl import read_mtl, write_mtl
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from rtamt.interchange.conversion import Conversion
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class Format:
    """A format of requirements.

    Attributes:
        about: what it is, for help.
        read: converts a text and a sampling period (None for the default) to a specification.
        write: converts a specification, with the name of the component (None for the default).
    """

    about: str
    read: Callable[[str, Fraction | None], Conversion]
    write: Callable[[Specification, str | None], Conversion]


FORMATS: dict[str, Format] = {
    "breach": Format("Breach: its files of signal temporal logic, .stl", read_breach, write_breach),
    "c2po": Format("C2PO: the specifications of R2U2", read_c2po, write_c2po),
    "fret": Format("FRET: structured English, as FRET's JSON or as lines of text", read_fret, write_fret),
    "mtl": Format("py-metric-temporal-logic: formulas as lines of text", read_mtl, write_mtl),
}


def format_named(name: str) -> Format:
    """Return a format; raise :class:`UsageError` if there is none of that name."""
    if name not in FORMATS:
        raise UsageError(f"there is no format '{name}'{choices(name, FORMATS, 'formats')}")
    return FORMATS[name]
