"""The bytes of a suite: the programs of its requirements, and how recordings are read.

::

    "RTAMTSTE"  version (u32)  length of the listing (u32)  listing (JSON)  programs, each after its length (u32)
    CRC-32 of all that precedes it (u32)

Integers are little-endian. The programs are those of docs/reference/program.md, with texts in place of formulas.
"""

from __future__ import annotations

import json
import re
import struct
import zlib
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.compiler.program import Program
from rtamt.compiler.stored import LATEST, StoredPlan
from rtamt.errors import UsageError, shown
from rtamt.fleet.groups import Group, Programs, Way
from rtamt.fleet.suite_requirements import SuiteRequirement
from rtamt.fleet.verdict_table import SELECTABLE
from rtamt.language.parsing.sampling_clause import Sampling
from rtamt.language.units.durations import check_unit
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.patterns import lazy_pattern
from rtamt.signals.binding import Binding
from rtamt.signals.discrete import DISCRETE
from rtamt.signals.time_domains import DOMAINS
from rtamt.specification_recorded import Optional
from rtamt.verdicts.prepared import Joined, Prepared, Window
from rtamt.verdicts.standalone import check_code

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rtamt.language.value_types import ValueType
    from rtamt.signals.time_domain_interface import TimeDomain

_MAGIC = b"RTAMTSTE"
_VERSION = 1
_HEAD = struct.Struct("<8sII")
_COUNT = struct.Struct("<I")
_FRACTION = lazy_pattern(r"\d{1,99}(/\d{1,99})?", re.ASCII)

# ---- to bytes ------------------------------------------------------------------------------------


def packed(select: Sequence[str], requirements: Sequence[SuiteRequirement], groups: Sequence[Group]) -> bytes:
    """Return a suite as bytes; the step of every group must be known."""
    codes: list[bytes] = []
    listing = {
        "select": list(select),
        "requirements": [
            {
                "name": each.name,
                "formula": each.formula,
                "description": each.description,
                "severity": each.severity,
                "optional": [[name, list(columns)] for name, columns in each.optional.columns],
                "rule": _rule(each.optional.rule),
            }
            for each in requirements
        ],
        "groups": [_group(group, codes) for group in groups],
    }
    text = json.dumps(listing, ensure_ascii=False, separators=(",", ":")).encode()
    parts = [_HEAD.pack(_MAGIC, _VERSION, len(text)), text]
    for code in codes:
        parts += [_COUNT.pack(len(code)), code]
    body = b"".join(parts)
    return body + _COUNT.pack(zlib.crc32(body))


def _group(group: Group, codes: list[bytes]) -> dict[str, Any]:
    way, domain = group.way, group.way.domain
    assert domain.step is not None
    return {
        "domain": domain.name,
        "step": str(domain.step),
        "tolerance": domain.tolerance,
        "unit": way.unit,
        "names": list(way.inputs),
        "columns": list(way.binding.columns),
        "units": list(way.binding.units),
        "others": list(way.binding.others),
        "types": {name: _type(type_) for name, type_ in way.types.items()},
        "rule": _rule(way.rule),
        "ending": list(way.ending),
        "inputs": [[number, list(names)] for number, names in group.inputs.items()],
        "parts": [
            {"numbers": list(numbers), **_prepared(prepared, codes)}
            for numbers, prepared in group.programs(domain.step).parts
        ],
    }


def _prepared(prepared: Prepared, codes: list[bytes]) -> dict[str, Any]:
    return {
        "inputs": list(prepared.inputs),
        "robustness": _plan(prepared.robustness, codes),
        # In discrete time one plan has both.
        "leaves": "robustness" if prepared.is_joint else _plan(prepared.leaves, codes),
        "joining": _plan(prepared.joining, codes),
        "windows": [[number, *window] for number, window in prepared.windows.items()],
        "outputs": list(prepared.outputs),
        "joined": list(prepared.joined),
    }


def _plan(plan: StoredPlan | None, codes: list[bytes]) -> dict[str, Any] | None:
    if plan is None:
        return None
    codes += [program.to_bytes() for program in plan.programs()]
    return plan.listing()


def _type(type_: ValueType) -> Any:
    return [type_.name, list(type_.members)] if isinstance(type_, Enumeration) else "bool"


def _rule(rule: Sampling | None) -> Any:
    if rule is None:
        return None
    return [str(rule.period), rule.hold, None if rule.limit is None else str(rule.limit), rule.skip_nan]


# ---- from bytes ----------------------------------------------------------------------------------


def damaged(reason: str) -> UsageError:
    """Return the error for bytes that are not a suite."""
    return UsageError(f"this is not a suite that can be read: {reason}")


def unpacked(code: Any) -> tuple[tuple[str, ...], tuple[SuiteRequirement, ...], list[Group]]:
    """Return what a suite consists of; raise :class:`UsageError` for bytes that are none."""
    if not isinstance(code, (bytes, bytearray, memoryview)):
        raise UsageError(f"expected the bytes of a suite, as to_bytes() returns them, got {shown(code)}")
    code = bytes(code)
    if len(code) < _HEAD.size + _COUNT.size or not code.startswith(_MAGIC):
        raise damaged(f"it does not begin with '{_MAGIC.decode()}'")
    _, version, length = _HEAD.unpack_from(code)
    if version != _VERSION:
        raise damaged(f"its format has version {version}, and this is for version {_VERSION}")
    body = code[: -_COUNT.size]
    if zlib.crc32(body) != _COUNT.unpack(code[-_COUNT.size :])[0]:
        raise damaged("its checksum does not match, so it was damaged on the way")
    if length > len(body) - _HEAD.size:
        raise damaged("it is shorter than it should be")
    # What a checksum does not show: the bytes may be made by anyone.
    try:
        listing = json.loads(body[_HEAD.size : _HEAD.size + length])
        programs = _programs(body[_HEAD.size + length :])
        found = _suite(listing, programs)
    except UsageError:
        raise
    except (
        AttributeError,
        IndexError,
        KeyError,
        OverflowError,
        RecursionError,
        TypeError,
        ValueError,
        ZeroDivisionError,
        struct.error,
    ) as error:
        raise damaged(f"its listing is wrong ({type(error).__name__}: {error})") from None
    if next(programs, None) is not None:
        raise damaged("it has a program that nothing uses")
    return found


def _programs(codes: bytes) -> Iterator[Program]:
    at = 0
    while at < len(codes):
        (length,) = _COUNT.unpack_from(codes, at)
        at += _COUNT.size
        if length > len(codes) - at:
            raise damaged("it is shorter than it should be")
        code = codes[at : at + length]
        at += length
        program = Program.from_bytes(code)
        check_code(program, code)
        yield program


def _suite(
    listing: Any, programs: Iterator[Program]
) -> tuple[tuple[str, ...], tuple[SuiteRequirement, ...], list[Group]]:
    select = tuple(listing["select"])
    if not select or select != tuple(name for name in SELECTABLE if name in select):
        raise damaged(f"it selects {shown(listing['select'])}")
    requirements = tuple(
        SuiteRequirement(
            _text(each["name"]),
            _text(each["formula"]),
            _text(each["description"]),
            _text(each["severity"]),
            Optional(_others(each["optional"]), _rule_of(each["rule"])),
        )
        for each in listing["requirements"]
    )
    groups = [_group_of(each, programs, select) for each in listing["groups"]]
    numbers = sorted(number for group in groups for number in group.inputs)
    if numbers != list(range(len(requirements))) or not requirements:
        raise damaged("its groups do not hold every requirement once")
    return select, requirements, groups


def _group_of(given: Any, programs: Iterator[Program], select: Sequence[str]) -> Group:
    kind, step = DOMAINS[given["domain"]], _fraction(given["step"])
    domain = kind.of(step, given["tolerance"], step)
    names = _distinct(given["names"])
    binding = Binding(names, _pairs(given["columns"]), _pairs(given["units"]), _others(given["others"]))
    unit = None if given["unit"] is None else check_unit(given["unit"])
    types = {_text(name): _type_of(type_) for name, type_ in given["types"].items()}
    way = Way(domain, unit, binding, types, _rule_of(given["rule"]), _names(given["ending"]))
    inputs = {_number(number): _distinct(read) for number, read in given["inputs"]}
    for read in (*inputs.values(), types):
        for name in read:
            if name not in names:
                raise damaged(f"a requirement reads '{name}', which its group does not")
    parts = []
    for part in given["parts"]:
        numbers = tuple(map(_number, part["numbers"]))
        prepared = _prepared_of(part, programs, domain, names)
        wanted = (len(numbers) * ("robustness" in select), len(numbers) * (select != ("robustness",)))
        if not numbers or (len(prepared.outputs), len(prepared.joined)) != wanted:
            raise damaged("a program has other outputs than its requirements")
        _require_readable(prepared, [inputs[number] for number in numbers])
        parts.append((numbers, prepared))
    if [number for numbers, _ in parts for number in numbers] != list(inputs):
        raise damaged("its programs do not hold every requirement once")
    return Group(way, inputs, None, Programs(tuple(parts)))


def _require_readable(prepared: Prepared, inputs: Sequence[tuple[str, ...]]) -> None:
    """Raise :class:`UsageError` unless each requirement can be evaluated without the others.

    ``inputs``: the variables of each. A recording that suits only some of the requirements is read for these alone.
    """
    first, second, third = (
        [] if plan is None else plan.reads()
        for plan in (prepared.robustness, prepared.leaves, prepared.joining)
    )
    for place, names in enumerate(inputs):
        read = set(prepared.inputs if prepared.domain.own_time_bases else ())
        if prepared.outputs:
            read |= first[prepared.outputs[place]]
        if prepared.joined:
            joined = prepared.joined[place]
            read.update(*(second[prepared.windows[window].output] for window in joined.windows))
            values = [joined.value, *(output for _, output in joined.parts if output is not None)]
            listed = {f"#{window}" for window in joined.windows}
            if not frozenset[str]().union(*(third[value] for value in values)) <= listed:
                raise damaged("a requirement joins windows that it does not list")
            if not {window for window, _ in joined.parts if window is not None} <= set(joined.windows):
                raise damaged("a requirement has a part that it does not list")
        if not read <= set(names):
            raise damaged("a program reads what its requirement does not")


def _prepared_of(
    given: Any, programs: Iterator[Program], domain: TimeDomain, names: tuple[str, ...]
) -> Prepared:
    inputs = _distinct(given["inputs"])
    if not set(inputs) <= set(names):
        raise damaged("a program reads what its group does not")

    def plan(listing: Any, domain: TimeDomain, inputs: Sequence[str]) -> StoredPlan | None:
        found = None if listing is None else StoredPlan.read(listing, programs, inputs)
        for program in () if found is None else found.programs():
            if program.domain is not type(domain) or program.period != domain.step:
                raise damaged("a program has another time domain than its group")
        return found

    first = plan(given["robustness"], domain, inputs)
    joint = given["leaves"] == "robustness"
    second = first if joint else plan(given["leaves"], domain, inputs)
    if (joint or (first is not None and second is not None)) and joint == domain.held_at_end:
        raise damaged("its programs are not those of its time domain")
    windows = {_number(number): _window(*rest) for number, *rest in given["windows"]}
    joining = plan(given["joining"], _JOINING, [f"#{number}" for number in windows])
    outputs = tuple(map(_number, given["outputs"]))
    joined = tuple(_join(*each) for each in given["joined"])
    values = [each.value for each in joined]
    values += [output for each in joined for _, output in each.parts if output is not None]
    read = [number for each in joined for number in each.windows]
    read += [window for each in joined for window, _ in each.parts if window is not None]
    for places, found in (
        (outputs, first),
        ([window.output for window in windows.values()], second),
        (values, joining),
    ):
        if any(place >= (0 if found is None else found.outputs) for place in places):
            raise damaged("it reads an output that no program has")
    if not set(read) <= windows.keys() or any(not each.parts for each in joined):
        raise damaged("it joins a window that it does not have")
    return Prepared(domain, inputs, first, second, joining, windows, outputs, joined)


_JOINING = type(DISCRETE)(1)


def _window(output: Any, reduce: Any, begin: Any, end: Any, settled: Any) -> Window:
    if reduce not in (None, "min", "max"):
        raise damaged(f"a window is reduced by {shown(reduce)}")
    last = None if end is None else _number(end)
    return Window(_number(output), reduce, _number(begin), last, _number(settled))


def _join(value: Any, windows: Any, parts: Any) -> Joined:
    return Joined(
        _number(value),
        tuple(map(_number, windows)),
        tuple(
            (None if window is None else _number(window), None if output is None else _number(output))
            for window, output in parts
        ),
    )


def _number(given: Any) -> int:
    if type(given) is not int or not 0 <= given < LATEST:
        raise damaged(f"it has {shown(given)} where a number belongs")
    return given


def _fraction(given: Any) -> Fraction:
    if not isinstance(given, str) or _FRACTION.fullmatch(given) is None:  # 1e999999999 would fill the memory
        raise damaged(f"it has {shown(given)} where a fraction belongs")
    return Fraction(given)


def _text(given: Any) -> str:
    if not isinstance(given, str):
        raise damaged(f"it has {shown(given)} where a text belongs")
    return given


def _names(given: Any) -> tuple[str, ...]:
    return tuple(map(_text, given))


def _distinct(given: Any) -> tuple[str, ...]:
    names = _names(given)
    if len(set(names)) != len(names):
        raise damaged(f"it has {shown(given)}, a name twice")
    return names


def _pairs(given: Any) -> tuple[tuple[str, str], ...]:
    return tuple((_text(name), _text(other)) for name, other in given)


def _others(given: Any) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((_text(name), _names(others)) for name, others in given)


def _type_of(given: Any) -> ValueType:
    if given == "bool":
        return BOOLEAN
    name, members = given
    codes: Mapping[str, int] = {_text(member): int(code) for member, code in members}
    return Enumeration(_text(name), tuple(codes.items()))


def _rule_of(given: Any) -> Sampling | None:
    if given is None:
        return None
    period, hold, limit, skip_nan = given
    return Sampling(
        _fraction(period), bool(hold), None if limit is None else _fraction(limit), bool(skip_nan)
    )
