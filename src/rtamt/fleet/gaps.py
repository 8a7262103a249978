"""The policies for gaps between the samples of a key."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, slots=True)
class Gaps:
    """The policy for a gap between two samples of a key that is not the period.

    ``code``: in a state. ``restart``: whether it starts a new trace. ``filled``: for how many samples at most the last
    value is held; 0 if gaps are not filled.
    """

    name: str
    code: int
    restart: bool = False
    filled: int = 0


#: THE LIST of policies for gaps.
GAPS: Mapping[str, Gaps] = MappingProxyType(
    {
        each.name: each
        for each in (Gaps("reject", 0), Gaps("restart", 1, restart=True), Gaps("hold", 2, filled=10_000))
    }
)
