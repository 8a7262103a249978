"""Named tuples of :mod:`rtamt.lazy.tuples` behave as those of the standard library."""

import copy
import pickle
import typing

import pytest

from rtamt.lazy import tuples as lazy_tuples
from rtamt.lazy.dataclasses import INTERPRETED


def made(base):
    class Row(base):
        """A row."""

        a: int
        b: "str | None"
        c: float = 0.5

        @property
        def twice(self):
            return 2 * self.a

    class Derived(Row):
        extra = 1

    return Row, Derived


ROWS = {"ours": made(lazy_tuples.NamedTuple), "theirs": made(typing.NamedTuple)}


@pytest.mark.parametrize("of", [0, 1], ids=["class", "derived"])
def test_classes_are_those_of_the_standard_library(of):
    (ours, theirs) = (ROWS[which][of] for which in ("ours", "theirs"))
    for given in ({"a": 1, "b": "x"}, {"a": 1, "b": None, "c": 2.0}):
        one, other = ours(**given), theirs(**given)
        assert one == other == tuple(other) == ours(*other)
        assert hash(one) == hash(other)
        assert repr(one) == repr(other)
        assert (one.a, one.b, one.c, one.twice) == (other.a, other.b, other.c, other.twice)
        assert one._asdict() == other._asdict()
        assert one._replace(b="y") == other._replace(b="y")
        assert type(one._replace(b="y")) is type(copy.copy(one)) is ours
        assert ours._make(other) == one
    for name in (
        "_fields",
        "_field_defaults",
        "__match_args__",
        "__doc__",
        "__qualname__",
    ):
        assert getattr(ours, name) == getattr(theirs, name), name
    assert typing.get_type_hints(ours) == typing.get_type_hints(theirs)
    with pytest.raises(AttributeError):
        ours(1, "x").a = 2


@pytest.mark.parametrize("which", ROWS)
@pytest.mark.parametrize(
    ("call", "kind"),
    [
        (lambda row: row(1), TypeError),
        (lambda row: row(1, 2, 3, 4), TypeError),
        (lambda row: row(1, 2, d=3), TypeError),
        (lambda row: row._make([1, 2]), TypeError),
        (lambda row: row(1, 2)._replace(d=3), ValueError),
    ],
    ids=["too few", "too many", "unknown", "made of too few", "replaced unknown"],
)
def test_wrong_arguments_are_rejected_as_by_the_standard_library(which, call, kind):
    for row in (*ROWS[which], made({"ours": lazy_tuples, "theirs": typing}[which].NamedTuple)[0]):
        with pytest.raises(kind):
            call(row)


def test_wrong_arguments_have_the_same_message_in_the_first_call_and_in_later_ones():
    row, _ = made(lazy_tuples.NamedTuple)
    messages = []
    for _ in range(2):
        with pytest.raises(TypeError) as error:
            row(1, a=2)
        messages.append(str(error.value).rpartition(".")[2])
        with pytest.raises(TypeError) as error:
            row(1, d=2)
        messages.append(str(error.value).rpartition(".")[2])
    assert messages == 2 * [
        "__new__() got multiple values for argument 'a'",
        "__new__() got an unexpected keyword argument 'd'",
    ]


def test_the_constructor_is_compiled_once_for_a_class_and_those_derived_from_it():
    row, derived = made(lazy_tuples.NamedTuple)
    first = row.__new__
    rows = [kind(1, b="x") for _ in range(INTERPRETED) for kind in (derived, row)]
    assert {type(each) for each in rows} == {row, derived}
    assert {*rows} == {(1, "x", 0.5)}
    assert first is not row.__new__ is derived.__new__


class Pair(lazy_tuples.NamedTuple):
    """At the top of a module, as pickling needs it."""

    x: float
    y: float = 0.0


def test_instances_are_pickled_and_matched():
    restored = pickle.loads(pickle.dumps(Pair(1, 2)))
    assert (restored, type(restored)) == (Pair(1, 2), Pair)
    match Pair(1, 2):
        case Pair(x, y):
            assert (x, y) == (1, 2)


def test_defaults_stand_last():
    with pytest.raises(AssertionError, match="defaults stand last"):

        class Wrong(lazy_tuples.NamedTuple):
            a: int = 1
            b: int
