"""The part of :mod:`dataclasses` that this package uses, with methods generated on first use.

The standard library compiles five methods for each class when it is defined, which took a third of the time of every
command; most classes are not instantiated by most commands, and many of the others only once. Here ``__init__`` is
interpreted until a class has some instances, then compiled, and the other methods are closures over the fields. A
frozen class with slots stores through the descriptors of its slots, in half the time of ``object.__setattr__``. The
functions of :mod:`dataclasses` accept instances of these classes.

>>> from dataclasses import asdict
>>> @dataclass(frozen=True, slots=True)
... class Point:
...     x: float
...     y: float = 0.0
>>> replace(Point(1.0), y=2.0), asdict(Point(1.0))
(Point(x=1.0, y=2.0), {'x': 1.0, 'y': 0.0})
"""

from __future__ import annotations

from operator import attrgetter
from types import MappingProxyType

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Collection
    from dataclasses import dataclass, field, fields, replace
else:

    def dataclass(cls: type | None = None, /, **options: bool) -> Any:
        """Generate the methods of a class, as :func:`dataclasses.dataclass` with these options does."""
        return _process(cls) if cls is not None else lambda cls: _process(cls, **options)

    def field(**options: Any) -> Any:
        """Return the description of a field, as :func:`dataclasses.field` does."""
        return Field(**options)

    def fields(of: Any) -> tuple[Field, ...]:
        """Return the fields of a class or an instance."""
        return tuple(of._record_fields.values())

    def replace(instance: Any, /, **changes: Any) -> Any:
        """Return a copy of an instance with other values of some fields."""
        own = {name: getattr(instance, name) for name, each in instance._record_fields.items() if each.init}
        return type(instance)(**{**own, **changes})


__all__ = ["dataclass", "field", "fields", "replace"]

_MISSING: Any = object()
#: Calls before __init__ is compiled, which takes as long as to interpret about so many.
INTERPRETED = 16


class Field:
    """A field of a class; ``name`` and ``annotation`` are known once the class is."""

    __slots__ = ("annotation", "compare", "default", "default_factory", "init", "name", "repr")

    def __init__(
        self,
        *,
        default: Any = _MISSING,
        default_factory: Any = _MISSING,
        init: bool = True,
        repr: bool = True,  # noqa: A002 - the names of the standard library
        compare: bool = True,
    ) -> None:
        self.name = ""
        self.annotation: Any = None
        self.default = default
        self.default_factory = default_factory
        self.init = init
        self.repr = repr
        self.compare = compare

    def standard(self) -> tuple[str, Any, Any]:
        """Return the name, the annotation and the description that :func:`dataclasses.make_dataclass` takes."""
        import dataclasses

        options: dict[str, Any] = {
            "init": self.init,
            "repr": self.repr,
            "compare": self.compare,
            "kw_only": True,
        }
        for name in ("default", "default_factory"):
            if (given := getattr(self, name)) is not _MISSING:
                options[name] = given
        return self.name, self.annotation, dataclasses.field(**options)


class _StandardFields:
    """The attribute by which :mod:`dataclasses` recognizes its classes, and finds their fields."""

    def __get__(self, _instance: object, cls: Any) -> Any:
        import dataclasses

        found = [each.standard() for each in cls._record_fields.values()]
        made: Any = dataclasses.make_dataclass(cls.__name__, found)
        fields = made.__dataclass_fields__
        type.__setattr__(cls, "__dataclass_fields__", fields)  # from now on without this descriptor
        return fields


def _process(
    cls: Any,
    *,
    frozen: bool = False,
    slots: bool = False,
    eq: bool = True,
    repr: bool = True,  # noqa: A002 - as above
    init: bool = True,
) -> Any:
    """Return the class with its methods; with slots it is another class, as in the standard library."""
    inherited = [vars(base).get("_record_fields", {}) for base in reversed(cls.__mro__[1:])]
    found: dict[str, Field] = {name: each for base in inherited for name, each in base.items()}
    own = _own_fields(cls)
    found |= own
    attributes: dict[str, Any] = {"_record_fields": found, "__dataclass_fields__": _StandardFields()}
    attributes["__match_args__"] = tuple(name for name, each in found.items() if each.init)
    given = vars(cls)
    if repr and "__repr__" not in given:
        attributes["__repr__"] = _repr_of([name for name, each in found.items() if each.repr])
    if eq:
        key = _key_of([name for name, each in found.items() if each.compare])
        if "__eq__" not in given:
            attributes["__eq__"] = _eq_by(key)
        if given.get("__hash__") is None:  # ... also where Python has set it to None because of __eq__
            attributes["__hash__"] = (lambda self: hash(key(self))) if frozen else None
    if frozen:
        attributes |= {"__setattr__": _frozen, "__delattr__": _frozen}
    if not any("__getstate__" in vars(base) for base in cls.__mro__[:-1]) and (frozen or not slots):
        attributes |= {"__getstate__": _state, "__setstate__": _restore}
    if init:
        attributes["__init__"] = _first_init(frozen=frozen)
    if slots:
        return _with_slots(cls, own, attributes)
    for name, value in attributes.items():
        setattr(cls, name, value)
    return cls


def _with_slots(cls: Any, own: Collection[str], attributes: dict[str, Any]) -> Any:
    """Return the same class with slots for its own fields, except for those that have one in a base class."""
    body = {name: value for name, value in vars(cls).items() if name not in (*own, "__dict__", "__weakref__")}
    body |= attributes
    taken = {slot for base in cls.__mro__[1:] for slot in vars(base).get("__slots__", ())}
    body["__slots__"] = tuple([name for name in own if name not in taken])
    made = type(cls)(cls.__name__, cls.__bases__, body)
    made.__qualname__ = cls.__qualname__
    return made


def _own_fields(cls: Any) -> dict[str, Field]:
    """Return the fields that a class itself declares; as class attributes, only their defaults remain."""
    found: dict[str, Field] = {}
    for name, annotation in cls.__annotations__.items():
        if str(annotation).startswith("ClassVar"):
            continue
        default = vars(cls).get(name, _MISSING)
        each = default if isinstance(default, Field) else Field(default=default)
        each.name, each.annotation = name, annotation
        found[name] = each
        if each.default is not _MISSING:
            setattr(cls, name, each.default)
        elif default is not _MISSING:
            delattr(cls, name)
    return found


def _first_init(*, frozen: bool) -> Callable[..., None]:
    """Return a method that interprets its first calls, and then replaces itself by one that it compiles."""
    owner: Any = None
    stored: Any = None
    calls = 0

    def first(self: Any, *args: Any, **given: Any) -> None:
        nonlocal owner, stored, calls
        if owner is None:
            owner = next(cls for cls in type(self).__mro__ if vars(cls).get("__init__") is first)
            stored = _interpreter(owner, frozen=frozen)
        calls += 1
        if calls <= INTERPRETED and stored(self, args, given):
            if hasattr(owner, "__post_init__"):
                self.__post_init__()
        else:
            owner.__init__ = made = _compile_init(owner, frozen=frozen)
            made(self, *args, **given)

    return first


def _interpreter(cls: Any, *, frozen: bool) -> Callable[[Any, tuple[Any, ...], dict[str, Any]], bool]:
    """Return a function that stores the values of the fields, and returns whether the arguments were valid.

    The compiled method reports an error.
    """
    names, accepted = cls.__match_args__, {*cls.__match_args__}
    fields = {name: each for name, each in cls._record_fields.items() if each.init or not _is_required(each)}
    defaults = {name: each.default for name, each in fields.items()}
    required = {name for name, each in fields.items() if _is_required(each)}
    factories = [
        (name, each.default_factory) for name, each in fields.items() if each.default_factory is not _MISSING
    ]
    setters: list[Any] = (
        [getattr(getattr(cls, name, None), "__set__", None) for name in fields] if frozen else [None]
    )
    store = object.__setattr__ if frozen else setattr

    def stored(self: Any, args: tuple[Any, ...], given: dict[str, Any]) -> bool:
        own = dict(zip(names, args, strict=False))
        if len(args) > len(names) or not own.keys().isdisjoint(given):
            return False
        own.update(given)
        if not required <= own.keys() <= accepted:
            return False
        values = {**defaults, **own}
        for name, make in factories:
            if name not in own:
                values[name] = make()
        if None in setters:
            for name, value in values.items():
                store(self, name, value)
        else:
            for setter, value in zip(setters, values.values(), strict=True):
                setter(self, value)
        return True

    return stored


def _is_required(field: Field) -> bool:
    return field.default is _MISSING and field.default_factory is _MISSING


def _compile_init(cls: Any, *, frozen: bool) -> Any:
    """Return the ``__init__`` of a class."""
    names: dict[str, Any] = {"_missing": _MISSING, "_store": object.__setattr__}
    head, body = ["self"], []
    for name, each in cls._record_fields.items():
        value = name
        if each.default_factory is not _MISSING:
            names[f"_make_{name}"] = each.default_factory
            value = f"_make_{name}() if {name} is _missing else {name}" if each.init else f"_make_{name}()"
            head += [f"{name}=_missing"] if each.init else []
        elif each.default is not _MISSING:
            names[f"_default_{name}"] = each.default
            head += [f"{name}=_default_{name}"] if each.init else []
            value = name if each.init else f"_default_{name}"
        elif each.init:
            head.append(name)
        else:
            continue
        slot = getattr(cls, name, None)
        if not frozen:
            body.append(f" self.{name} = {value}")
        elif hasattr(slot, "__set__"):
            names[f"_store_{name}"] = slot.__set__  # type: ignore[union-attr] # which it has
            body.append(f" _store_{name}(self, {value})")
        else:
            body.append(f" _store(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        body.append(" self.__post_init__()")
    exec(f"def __init__({', '.join(head)}):\n" + "\n".join(body or [" pass"]), names)  # noqa: S102 - our own text
    made = names["__init__"]
    made.__qualname__ = f"{cls.__qualname__}.__init__"
    return made


def _repr_of(names: list[str]) -> Callable[[Any], str]:
    def text(self: Any) -> str:
        values = [f"{name}={getattr(self, name)!r}" for name in names]
        return f"{type(self).__qualname__}({', '.join(values)})"

    return text


def _key_of(names: list[str]) -> Callable[[Any], Any]:
    """Return a function from an instance to what it is compared by."""
    return attrgetter(*names) if names else lambda _self: ()


def _eq_by(key: Callable[[Any], Any]) -> Callable[[Any, object], Any]:
    def equal(self: Any, other: object) -> Any:
        if type(other) is not type(self):
            return NotImplemented
        mine, others = key(self), key(other)
        return mine is others or mine == others  # as in tuples: NaN may be the same object

    return equal


def _frozen(_self: Any, name: str, *_value: Any) -> None:
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot {'assign to' if _value else 'delete'} field {name!r}")


class _View(dict[Any, Any]):
    """The target of a read-only view: unlike the view, it can be pickled and copied."""


def _state(self: Any) -> dict[str, Any]:
    found = vars(self) if hasattr(self, "__dict__") else {}
    found = found | {name: getattr(self, name) for name in self._record_fields if hasattr(self, name)}
    return {
        name: _View(value) if isinstance(value, MappingProxyType) else value for name, value in found.items()
    }


def _restore(self: Any, state: dict[str, Any]) -> None:
    for name, value in state.items():
        object.__setattr__(self, name, MappingProxyType(value) if type(value) is _View else value)
