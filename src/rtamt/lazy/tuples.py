"""``NamedTuple`` of :mod:`typing`, with a constructor that is compiled once a class has some instances.

The standard library compiles it, and the annotation of each field, where a class is defined: 0.1 ms for each of our
classes, of which most programs do not instantiate most, and many of the others only once. These classes have no
``__orig_bases__`` and no documentation of their fields; otherwise they are those of the standard library, also for
pickle and pattern matching.

>>> class Point(NamedTuple):
...     x: float
...     y: float = 0.0
>>> Point(1.0), Point(1.0)._replace(y=2.0), Point(3.0).x
(Point(x=1.0, y=0.0), Point(x=1.0, y=2.0), 3.0)
"""

from __future__ import annotations

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import NamedTuple
else:
    from collections import _tuplegetter

    from rtamt.lazy.dataclasses import INTERPRETED

    class _Bases:
        """The nominal base of classes, replaced by one that makes the class."""

        def __mro_entries__(self, _bases: tuple[Any, ...]) -> tuple[type]:
            return (_Made,)

    class _Maker(type):
        """Makes an ordinary class, whose base is a tuple with methods."""

        def __new__(cls, name: str, bases: tuple[type, ...], body: dict[str, Any]) -> Any:
            if not bases:
                return super().__new__(cls, name, bases, body)
            fields = tuple(body.get("__annotations__", ()))
            defaults = {field: body[field] for field in fields if field in body}
            assert tuple(defaults) == fields[len(fields) - len(defaults) :], "defaults stand last"
            body |= {field: _tuplegetter(place, "") for place, field in enumerate(fields)}
            body |= {
                "__slots__": (),
                "__match_args__": fields,
                "_fields": fields,
                "_field_defaults": defaults,
            }
            made: Any = type(name, (_Methods, *bases[1:]), body)
            if "__new__" not in body:
                made.__new__ = _first_new(made)
            return made

    class _Made(metaclass=_Maker):
        """The base whose metaclass makes the class; it is no base of that."""

    class _Methods(tuple):
        """The methods of every named tuple."""

        __slots__ = ()

        @classmethod
        def _make(cls, values: Iterable[Any]) -> Any:
            made = tuple.__new__(cls, values)
            if len(made) != len(cls._fields):
                raise TypeError(f"Expected {len(cls._fields)} arguments, got {len(made)}")
            return made

        def _replace(self, /, **changes: Any) -> Any:
            made = self._make(map(changes.pop, self._fields, self))
            if changes:
                raise ValueError(f"Got unexpected field names: {list(changes)!r}")
            return made

        def _asdict(self) -> dict[str, Any]:
            return dict(zip(self._fields, self, strict=True))

        def __getnewargs__(self) -> tuple[Any, ...]:
            return tuple(self)

        def __repr__(self) -> str:
            values = [f"{field}={value!r}" for field, value in zip(self._fields, self, strict=True)]
            return f"{type(self).__name__}({', '.join(values)})"

    def _first_new(owner: Any) -> Any:
        """Return a constructor that interprets its first calls, and then replaces itself by one that it compiles."""
        calls = 0

        def first(cls: type, /, *args: Any, **given: Any) -> Any:
            nonlocal calls
            calls += 1
            fields = owner._fields
            if calls <= INTERPRETED and len(args) <= len(fields):
                values = dict(zip(fields, args, strict=False))
                if values.keys().isdisjoint(given):
                    values = {**owner._field_defaults, **values, **given}
                    if values.keys() == {*fields}:
                        return tuple.__new__(cls, [values[field] for field in fields])
            owner.__new__ = made = _compile_new(owner)  # which reports wrong arguments, too
            return made(cls, *args, **given)

        return first

    def _compile_new(owner: Any) -> Any:
        """Return the constructor of a class."""
        defaults, fields = owner._field_defaults, owner._fields
        names = {"_new": tuple.__new__, **{f"_default_{name}": value for name, value in defaults.items()}}
        head = [f"{name}=_default_{name}" if name in defaults else name for name in fields]
        values = "".join(f"{name}, " for name in fields)
        exec(f"def __new__(_cls, {', '.join(head)}): return _new(_cls, ({values}))", names)  # noqa: S102 - our own text
        made = names["__new__"]
        made.__qualname__ = f"{owner.__qualname__}.__new__"
        return made

    NamedTuple = _Bases()

__all__ = ["NamedTuple"]
