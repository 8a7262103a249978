"""The result of a conversion: a text, and the parts of the source that it omits."""

from __future__ import annotations

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.tuples import NamedTuple


class Rejection(NamedTuple):
    """A requirement that the other language cannot express, and the reason, one sentence."""

    name: str
    reason: str


@dataclass(frozen=True, slots=True)
class Conversion:
    """A converted set of requirements.

    Attributes:
        text: the content of the file.
        converted: the names of the requirements that it contains.
        rejected: those that it does not contain, each with the reason.
        notes: where the two languages differ in what these requirements mean.
    """

    text: str
    converted: tuple[str, ...]
    rejected: tuple[Rejection, ...] = ()
    notes: tuple[str, ...] = ()
