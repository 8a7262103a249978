"""Members of enumerations by name to their codes; Booleans are 1 or 0, and nothing else."""

from __future__ import annotations

from enum import Enum
from types import MappingProxyType

from rtamt.errors import TraceError, shown
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from rtamt.language.value_types import ValueType

    #: The types of the variables that are no plain numbers.
    Types = Mapping[str, ValueType]

#: The classes of nearly all values that are no names.
_NO_NAMES = {float, int, bool, type(None)}

#: As many members at most are compared with a whole array, which is faster than looking each value up.
_COMPARED = 12

NO_TYPES: Types = MappingProxyType({})


def codes_of(types: Types) -> dict[str, dict[str, float] | None]:
    """Return types for the compiled core: of an enumeration the code of each member by name, None for a Boolean.

    >>> codes_of({"mode": Enumeration("Mode", (("MANUAL", 0), ("AUTO", 4))), "armed": BOOLEAN})
    {'mode': {'MANUAL': 0.0, 'AUTO': 4.0}, 'armed': None}
    """
    return {
        name: {member: float(code) for member, code in type_.members}
        if isinstance(type_, Enumeration)
        else None
        for name, type_ in types.items()
    }


def encoded(values: Any, name: str, type_: ValueType | None, first: int = 0) -> Any:
    """Return the values of a variable with codes in place of the names of members; others as they are.

    ``first``: the index of ``values[0]`` in the recording. Raises :class:`TraceError` at an unknown name.

    >>> mode = Enumeration("Mode", (("MANUAL", 0), ("AUTO", 4)))
    >>> encoded(["AUTO", 0, None], "mode", mode)
    [4.0, 0, None]
    """
    if not isinstance(type_, Enumeration) or _is_numeric(values):
        return values
    codes: dict[Any, float] = {member: float(code) for member, code in type_.members}
    if isinstance(values, np.ndarray) and values.dtype.kind == "U" and len(codes) <= _COMPARED:
        places = np.zeros(values.shape, np.int8)  # of members, from 1 on
        for place, member in enumerate(codes, 1):
            places += (values == member).view(np.int8) * np.int8(place)
        if places.all():
            return np.array([np.nan, *codes.values()])[places]
    items = list(_items(values))
    classes = set(map(type, items))
    if classes <= _NO_NAMES:
        return items
    if classes == {str} and codes.keys() >= set(items):
        return np.fromiter(map(codes.__getitem__, items), np.float64, len(items))
    return [
        encoded_value(item, name, type_, f"sample {first + i}", first + i) for i, item in enumerate(items)
    ]


def encoded_value(value: Any, name: str, type_: ValueType | None, where: str, index: int) -> Any:
    """Return the code of a member's name, or of a member of a Python ``enum`` with that name; others as they are."""
    if not isinstance(type_, Enumeration):
        return value
    if isinstance(value, Enum):
        return code_of(value.name, name, type_, where, index)
    return code_of(value, name, type_, where, index) if isinstance(value, str) else value


def code_of(member: str, name: str, type_: Enumeration, where: str, index: int) -> float:
    """Return the code of a member; raise :class:`TraceError` if there is none, with those that there are."""
    code = type_.code(member)
    if code is None:
        raise TraceError(
            f"'{name}' is {shown(member)} at {where}, which is {type_.unknown_member(member)}",
            variable=name,
            index=index,
        )
    return float(code)


def require_truths(
    name: str,
    type_: ValueType | None,
    values: NDArray[np.float64],
    where: Callable[[int], str],
    first: int = 0,
) -> None:
    """Raise :class:`TraceError` at the first value of a Boolean that is neither 1 nor 0; ``where``: its place."""
    if type_ is not BOOLEAN:
        return
    wrong = (values != 0.0) & (values != 1.0)
    if wrong.any():
        i = int(wrong.argmax())
        raise no_truth(name, float(values[i]), where(i), first + i)


def no_truth(name: str, value: float, where: str, index: int) -> TraceError:
    """Return the error for a number in place of a Boolean."""
    return TraceError(
        f"'{name}' is {value:.15g} at {where}, and declared as bool, which is 1 or 0 (true or false): "
        f"declare it as float, and compare it",
        variable=name,
        index=index,
    )


def _is_numeric(values: Any) -> bool:
    dtype = getattr(values, "dtype", None)
    return isinstance(dtype, np.dtype) and dtype.kind in "fiub"


def _items(values: Any) -> Any:
    """Return the values of any container one by one, missing ones as None."""
    if hasattr(values, "to_pylist"):  # Arrow
        return values.to_pylist()
    return values.tolist() if isinstance(values, np.ndarray) else values
