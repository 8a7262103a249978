"""The formulas of instructions, for messages and for programs that report sub-formulas; few are ever read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from rtamt.language.formula import Formula


class Deferred(Mapping[Any, Any]):
    """A mapping that is computed on first use, such as from formulas to their instructions.

    >>> from rtamt.language.formula import Var
    >>> places = Deferred(lambda: [(Var("x"), 0), (Var("y"), 1)])
    >>> places[Var("y")], len(places)
    (1, 2)
    """

    def __init__(self, pairs: Callable[[], Iterable[tuple[Any, Any]]]) -> None:
        self._pairs = pairs

    def __getitem__(self, key: Any) -> Any:
        return self._found[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)

    @cached_property
    def _found(self) -> dict[Any, Any]:
        return dict(self._pairs())

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (self._found,)


class Origins(Sequence["Formula | None"]):
    """The formula of each instruction, computed on first use.

    >>> from rtamt.language.formula import Var
    >>> origins = Origins(lambda: [Var("x"), None])
    >>> origins[0], len(origins)
    (<formula x>, 2)
    """

    def __init__(self, origins: Callable[[], Iterable[Formula | None]]) -> None:
        self._origins = origins

    def __getitem__(self, place: Any) -> Any:
        return self._found[place]

    def __len__(self) -> int:
        return len(self._found)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self._found == tuple(other)

    def __hash__(self) -> int:
        return hash(self._found)

    @cached_property
    def _found(self) -> tuple[Formula | None, ...]:
        return tuple(self._origins())

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (self._found,)
