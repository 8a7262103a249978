"""The instructions of formulas, for programs that report sub-formulas."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.language.formula import Formula


class Places(Mapping["Formula", int]):
    """A mapping from formulas to instructions that hashes the formulas on first use: few programs need it.

    >>> from rtamt.language.formula import Var
    >>> places = Places([(Var("x"), 0), (Var("y"), 1)])
    >>> places[Var("y")], len(places)
    (1, 2)
    """

    def __init__(self, pairs: Sequence[tuple[Formula, int]]) -> None:
        self._pairs = pairs

    def __getitem__(self, formula: Formula) -> int:
        return self._found[formula]

    def __iter__(self) -> Iterator[Formula]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    @cached_property
    def _found(self) -> dict[Formula, int]:
        return dict(self._pairs)
