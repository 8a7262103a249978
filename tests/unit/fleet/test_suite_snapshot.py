"""Bytes of a suite that somebody has forged: their checksum is right, and their listing or programs are not."""

from __future__ import annotations

import copy
import json
import random
import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rtamt

if TYPE_CHECKING:
    from collections.abc import Iterator

CODE = rtamt.Suite(
    [
        rtamt.parse("always(x >= 3 -> eventually[0:2](y >= 1))", period=1),
        rtamt.parse("x / y >= 1", period=1),
        rtamt.parse("always(x >= 3) until (y >= 1)", time="dense"),
        rtamt.parse(
            'enum M { A, B = 4 }\ninput M m\ninput float z [m/s] = "q" or "z"\nalways(m == A or z > 1)',
            period=1,
        ),
        rtamt.parse("sample 1 s hold for 3 s; input float x; input float y; always(x + y >= 3)"),
    ]
).to_bytes()
END = 16 + struct.unpack_from("<I", CODE, 12)[0]
LISTING = json.loads(CODE[16:END])

DATA: dict[str, Any] = {
    "time": [0.0, 1.0, 2.0],
    "x": [4, 5, 1],
    "y": [2, 0.5, 1],
    "q": [1, 2, 3],
    "m": ["A", "B", "A"],
}
#: Of some of these, not all requirements can be evaluated together.
RECORDINGS = (
    DATA,
    {name: column for name, column in DATA.items() if name != "y"},
    {**DATA, "x": [1, np.nan, 2]},
    {**DATA, "x": [5, 0, 2], "y": [1, 0, 2]},
    {**DATA, "m": ["A", "C", "B"]},
    {**DATA, "time": [0.0, 0.4, 2.0]},
    {},
)


def sealed(listing: Any) -> bytes:
    """Return the bytes of a suite with another listing, and the right checksum."""
    text = json.dumps(listing, ensure_ascii=False, separators=(",", ":")).encode()
    body = CODE[:12] + struct.pack("<I", len(text)) + text + CODE[END:-4]
    return body + struct.pack("<I", zlib.crc32(body))


def spots(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of each value inside another one."""
    if path:
        yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield from spots(inner, (*path, key))


def at(value: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        value = value[key]
    return value


def forged(chance: random.Random) -> Any:
    """Return a listing in which some values are others, are missing, or have changed places."""
    listing = copy.deepcopy(LISTING)
    for _ in range(chance.choice([1, 1, 1, 2, 3])):
        path = chance.choice(list(spots(listing)))
        parent, key = at(listing, path[:-1]), path[-1]
        old = parent[key]
        kind = chance.choice(["other", "other", "gone", "again", "foreign", "moved"])
        if kind == "other":
            parent[key] = chance.choice(others(old))
        elif kind == "gone":
            del parent[key]
        elif kind == "again" and isinstance(parent, list):
            parent.insert(key, copy.deepcopy(old))
        elif kind == "foreign":
            parent[key] = copy.deepcopy(at(LISTING, chance.choice(list(spots(LISTING)))))
        else:
            twin = chance.choice(list(range(len(parent))) if isinstance(parent, list) else list(parent))
            parent[key], parent[twin] = parent[twin], parent[key]
    return listing


def others(old: Any) -> list[Any]:
    """Return values that may stand where another one stood."""
    if old is None or isinstance(old, bool):
        return [None, True, False, 0, "x", []]
    if isinstance(old, int):
        return [old + 1, old - 1, 0, 1, 2, 10**6, 2**40, None]
    if isinstance(old, float):
        return [0.0, -1.0, 1e300, float("nan"), float("inf"), "0.1", None]
    if isinstance(old, str):
        return ["", "x", "y", "z", "1", "1/3", "0", "dense", "discrete", f"{old}a", "s", "km/h", 5]
    if isinstance(old, list):
        return [[], old[::-1], old[:1], old[1:], old + old]
    return [{}]


def test_a_forged_listing_is_rejected_or_evaluated() -> None:
    rejected = 0
    for seed in range(400):
        code = sealed(forged(random.Random(seed)))
        try:
            suite = rtamt.Suite.from_bytes(code)
        except rtamt.UsageError:
            rejected += 1
            continue
        for data in RECORDINGS:
            assert len(suite.evaluate(data)) == len(suite)
        assert len(rtamt.Suite.from_bytes(suite.to_bytes())) == len(suite)
    assert 200 < rejected < 400


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        (("groups", 0, "inputs", 1, 1), ["x"], "a program reads what its requirement does not"),
        (("groups", 1, "inputs", 0, 1), ["x"], "a program reads what its requirement does not"),
        (("groups", 1, "inputs", 0, 1), ["x", "y", "x"], "it has ['x', 'y', 'x'], a name twice"),
        (
            ("groups", 0, "parts", 0, "joined", 1, 1),
            [],
            "a requirement joins windows that it does not list",
        ),
        (
            ("groups", 0, "parts", 0, "joined", 1, 2),
            [[0, None]],
            "a requirement has a part that it does not list",
        ),
    ],
)
def test_what_only_a_part_of_the_requirements_would_miss_is_rejected(
    path: tuple[Any, ...], value: Any, reason: str
) -> None:
    """The suite was accepted, and its evaluation raised a KeyError for recordings that lack a signal."""
    listing = copy.deepcopy(LISTING)
    at(listing, path[:-1])[path[-1]] = value
    with pytest.raises(rtamt.UsageError) as caught:
        rtamt.Suite.from_bytes(sealed(listing))
    assert str(caught.value) == f"this is not a suite that can be read: {reason}"


def test_a_forged_requirement_that_is_violated_nowhere_has_no_first_violation() -> None:
    """The evaluation raised a ValueError: the least of no instants."""
    listing = copy.deepcopy(LISTING)
    listing["groups"][0]["parts"][0]["windows"][0][2] = "max"
    table = rtamt.Suite.from_bytes(sealed(listing)).evaluate({**DATA, "x": [4, 5, 5], "y": [0, 0, 0]})
    assert (table.rows[0].satisfied, table.rows[0].first_violation) == (False, None)
