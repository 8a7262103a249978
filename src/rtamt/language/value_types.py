"""The types of variables that are no plain numbers: Booleans and enumerations.

A Boolean is 1 or 0 in data, a member of an enumeration is its code; recordings may also have its name.
"""

from __future__ import annotations

from functools import cached_property

from rtamt.errors import did_you_mean
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

#: The types of numbers without a fraction.
WHOLE = ("int", "long")

#: The Booleans, as they are written.
LITERALS = {"true": True, "false": False}

#: Members that a message lists at most.
_LISTED = 12


@dataclass(frozen=True, slots=True)
class Boolean:
    """The type of variables that are true or false; see :data:`BOOLEAN`."""

    name: str = "bool"


#: The only type of its class.
BOOLEAN = Boolean()


@dataclass(frozen=True)
class Enumeration:
    """A type whose values have names. ``members``: each name with its code, in the order of the declaration.

    >>> mode = Enumeration("Mode", (("MANUAL", 0), ("AUTO", 4)))
    >>> mode.code("AUTO"), mode.code("RTL"), mode.member(0.0), mode.member(7.0)
    (4, None, 'MANUAL', None)
    """

    name: str
    members: tuple[tuple[str, int], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the members."""
        return tuple(name for name, _ in self.members)

    def code(self, member: str) -> int | None:
        """Return the code of a member; None for any other name."""
        return self._codes.get(member)

    def member(self, code: float) -> str | None:
        """Return the name of the member with a code; None if there is none."""
        return next((name for name, own in self.members if own == code), None)

    @cached_property
    def _codes(self) -> dict[str, int]:
        return dict(self.members)

    def listing(self, written: Callable[[str], str] = str) -> str:
        """Return the names of the members for a message. ``written``: how a text writes the member of a name."""
        names = self.names
        more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
        return ", ".join(map(written, names[:_LISTED])) + more

    def lacks(self, member: str) -> str:
        """Return the message for a name that is no member."""
        return f"'{member}' is {self.unknown_member(member)}"

    def unknown_member(self, member: str) -> str:
        """Return the end of the message for a name that is no member."""
        same = next((name for name in self.names if name.lower() == member.lower()), member)
        hint = did_you_mean(same, self.names) or f"; its members are {self.listing()}"
        return f"no member of {self.name}{hint}"


@dataclass(frozen=True, slots=True)
class Ambiguous:
    """The type of a member's name that several enumerations have, until the other operand decides."""

    choices: tuple[Enumeration, ...]


@dataclass(frozen=True, slots=True)
class Unknown:
    """The type of what a parameter of a template stands for, while the template is defined; see :data:`UNKNOWN`."""


#: The only type of its class.
UNKNOWN = Unknown()

#: What the parts of a text may be; None for numbers and formulas.
PartType: TypeAlias = "Boolean | Enumeration | Ambiguous | Unknown | None"
#: The type of a variable; None for numbers.
ValueType: TypeAlias = Boolean | Enumeration


def value_text(value: float, type_: ValueType | None) -> str | None:
    """Return the name of a value for a report: of a member, or ``true`` and ``false``; None for plain numbers.

    >>> value_text(4.0, Enumeration("Mode", (("AUTO", 4),))), value_text(0.0, BOOLEAN), value_text(4.0, None)
    ('AUTO', 'false', None)
    """
    return value_names(type_).get(value)


def value_names(type_: ValueType | None) -> dict[float, str]:
    """Return the name of each value of a type: of members, or ``true`` and ``false``; none of plain numbers.

    >>> value_names(BOOLEAN)
    {0.0: 'false', 1.0: 'true'}
    """
    if isinstance(type_, Enumeration):
        return {float(code): name for name, code in reversed(type_.members)}
    return {0.0: "false", 1.0: "true"} if type_ is BOOLEAN else {}
