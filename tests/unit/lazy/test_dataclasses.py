"""Classes of :mod:`rtamt.lazy.dataclasses` behave as those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import subprocess
import sys
from itertools import product
from operator import attrgetter
from types import MappingProxyType
from typing import ClassVar

import pytest

from rtamt.lazy import dataclasses as lazy_dataclasses

OPTIONS = [
    {"frozen": frozen, "slots": slots, "eq": eq, "repr": repr_}
    for frozen, slots, eq, repr_ in product((True, False), repeat=4)
]


def made(module, **options):
    """Define a class and a subclass with the functions of a module."""
    field = module.field

    class Base:
        kind: ClassVar[str] = "base"

        a: int
        b: tuple = (1, 2)
        c: list = field(default_factory=list, compare=False)
        d: str = field(default="d", repr=False)
        e: float = field(init=False, compare=False, repr=False)

        def __post_init__(self):
            object.__setattr__(self, "e", self.a / 2)

    base = module.dataclass(**options)(Base)

    class Derived(base):
        b: str = "other"
        f: int = 7

    return base, module.dataclass(**options)(Derived)


def outcome(action):
    """Return what an action returns, or the type and text of its error."""
    try:
        return action()
    except (AttributeError, TypeError) as error:
        return type(error), str(error)


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize("derived", [False, True])
def test_a_class_behaves_as_one_of_the_standard_library(options, derived):
    seen = []
    for module in (dataclasses, lazy_dataclasses):
        cls = made(module, **options)[derived]
        one, same, other = cls(1), cls(a=1, c=[3]), cls(2, (3, 4))
        observed = [
            *([repr(one), repr(other)] if options["repr"] else []),
            (one == same, one == other, one == 1, one != same),
            outcome(lambda one=one, same=same: hash(one) == hash(same)),
            (one.a, one.b, one.c, one.d, one.e, cls.kind),
            cls.__match_args__,
            [each.name for each in module.fields(cls)],
            [each.name for each in dataclasses.fields(one)],
            vars(one) if hasattr(one, "__dict__") else cls.__slots__,
            outcome(lambda one=one: setattr(one, "a", 5)),
            outcome(lambda one=one: delattr(one, "b")),
            module.replace(other, a=9).e,
            outcome(lambda module=module, other=other: module.replace(other, x=9)),
            outcome(cls),
            outcome(lambda cls=cls: cls(1, g=2)),
            dataclasses.asdict(other),
            copy.copy(other).e,
        ]
        seen.append([_comparable(each) for each in observed])
    assert seen[0] == seen[1]


@pytest.mark.parametrize("derived", [False, True])
@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_the_first_instances_are_made_as_later_ones(options, derived):
    calls = [((1,), {}), ((), {"a": 2, "c": [1]}), ((1, 2, 3), {"d": "x"}), ((), {"b": 3})]
    calls += [((1,), {"a": 2}), ((1,), {"e": 2}), ((1,), {"g": 2}), ((1, 2, 3, 4, 5, 6), {})]

    def values(cls, args, given):
        return str(outcome(lambda: attrgetter("a", "b", "c", "d", "e")(cls(*args, **given))))

    standard = made(dataclasses, **options)[derived]
    expected = [values(standard, *call) for call in calls]
    assert [each.count("TypeError") for each in expected] == [0] * 3 + [1] * 5
    assert [values(made(lazy_dataclasses, **options)[derived], *call) for call in calls] == expected
    ours = made(lazy_dataclasses, **options)[derived]
    for _ in range(3):
        assert [values(ours, *call) for call in calls] == expected


def test_valid_calls_are_interpreted_before_the_method_is_compiled():
    cls = made(lazy_dataclasses)[0]
    first = cls.__init__
    lists = [cls(i).c for i in range(lazy_dataclasses.INTERPRETED)]
    assert cls.__init__ is first
    assert cls(8, (3,)).b == (3,)
    assert cls.__init__ is not first
    assert len({id(each) for each in lists}) == lazy_dataclasses.INTERPRETED


def _comparable(value):
    """Without where the class was defined, and with types of errors by name."""
    return str(value).replace("made.<locals>.", "")


@lazy_dataclasses.dataclass(frozen=True, slots=True)
class Pair:
    """At the top of a module, as pickling needs it."""

    x: float
    y: float = 0.0


def test_instances_are_pickled_and_matched():
    assert pickle.loads(pickle.dumps(Pair(1, 2))) == Pair(1, 2)
    match Pair(1, 2):
        case Pair(x, y):
            assert (x, y) == (1, 2)


@lazy_dataclasses.dataclass(frozen=True)
class Named:
    """With a read-only view, which the standard library can neither pickle nor copy."""

    values: MappingProxyType


@pytest.mark.parametrize("again", [lambda it: pickle.loads(pickle.dumps(it)), copy.copy, copy.deepcopy])
def test_read_only_views_are_pickled_and_copied_and_stay_read_only(again):
    copied = again(Named(MappingProxyType({"x": 1})))
    assert copied == Named(MappingProxyType({"x": 1}))
    assert type(copied.values) is MappingProxyType


def test_subclasses_that_are_instantiated_first_do_not_compile_for_their_base():
    base, derived = made(lazy_dataclasses)
    assert (derived(1).f, derived(1).b) == (7, "other")
    assert (base(1).b, base(2).a) == ((1, 2), 2)


def test_commands_without_data_import_neither_numpy_nor_dataclasses(tmp_path):
    spec = tmp_path / "x.stl"
    spec.write_text("always(x >= 3)")
    code = (
        f"import sys; sys.argv = ['rtamt', 'lint', {str(spec)!r}]; from rtamt.cli import main; main()\n"
        "sys.exit(', '.join({'numpy.linalg', 'dataclasses', 'inspect', 'ast'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""


def test_fields_for_the_standard_library_are_made_once():
    @lazy_dataclasses.dataclass(frozen=True)
    class Point:
        x: int = 0

    class Named(Point):
        pass

    assert dataclasses.replace(Point(), x=3) == Point(3)
    assert dataclasses.fields(Point)[0] is dataclasses.fields(Point)[0]
    assert [each.name for each in dataclasses.fields(Named)] == ["x"]
