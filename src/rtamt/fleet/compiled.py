"""The program of a fleet, for the C API: ``rtamt_fleet_create`` runs it.

With records it is a program like that of ``Specification.compile``, with the outputs of the fleet. A fleet with a
monitor for each key has a program of its own kind (docs/reference/program.md).
"""

from __future__ import annotations

import json
import struct
import zlib
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.compiler.metadata import Metadata, encoded
from rtamt.engine.backend import CompiledSession
from rtamt.engine.early import EarlyProgram
from rtamt.errors import UsageError
from rtamt.fleet.collectors import collector_of
from rtamt.fleet.monitor_state import MonitorStates
from rtamt.language.contents import types_of
from rtamt.language.formula import Apply
from rtamt.language.printing.printer import to_text
from rtamt.language.printing.writing import EXCERPT, PAGE
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import replace
from rtamt.rewrite.desugar import written
from rtamt.signals.counting import DOUBLES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.causation import Causes
    from rtamt.engine.early import Group
    from rtamt.language.formula import Formula

_MAGIC, _VERSION = b"RTAMTMON", 1
_HEAD = struct.Struct("<8sHBBIqqdq")
_COUNT, _RANGE = struct.Struct("<I"), struct.Struct("<dd")
_NODE, _STEP, _ITEM = struct.Struct("<IIIqqqI"), struct.Struct("<IIId"), struct.Struct("<IIIIIq")
_CAUSE, _START = struct.Struct("<IIIIqqqI"), struct.Struct("<IIII")


# ---- records ---------------------------------------------------------------------------------------


def records_program(
    session: CompiledSession, formulas: Sequence[Formula], requirements: Sequence[str]
) -> bytes:
    """Return the program of records; ``requirements``: the names of its outputs, none of one specification."""
    program = session.program
    outputs = tuple(f"robustness.{name}" for name in requirements) or ("robustness",)
    text = to_text(formulas[0], limit=PAGE)
    booleans = frozenset([name for name, type_ in types_of(*formulas).items() if type_ is BOOLEAN])
    metadata = Metadata(
        formula=text, outputs=outputs, meanings=_meanings(program.origins, formulas), booleans=booleans
    )
    return replace(program, metadata=metadata).to_bytes()


def _meanings(origins: Iterable[Any], formulas: Sequence[Formula]) -> Mapping[int, str]:
    """Return what each instruction computes, as it is written in the formulas and as far as a message shows it."""
    return MappingProxyType(
        {
            place: to_text(written(origin, formulas), limit=EXCERPT, parameters=True)
            for place, origin in enumerate(origins)
            if isinstance(origin, Apply)
        }
    )


# ---- a monitor for each key ------------------------------------------------------------------------


def monitors_program(monitor: Any, identities: Mapping[str, str]) -> bytes:
    """Return the program of monitors like this one; raise :class:`UsageError` for settings that are for Python alone.

    ``identities``: what stands for the names of variables in a state.
    """
    _require_plain(monitor)
    states = MonitorStates(monitor, identities)
    session, early = monitor._session, isinstance(monitor._session, EarlyProgram)
    step: Fraction = monitor._step if early else monitor._tick
    dense = monitor._continuous if early else True
    if dense and (step.numerator != 1 or step.denominator >= DOUBLES):
        raise UsageError(
            f"the C API counts dense time in ticks of which a whole number are one second, and resolution is {step} s; "
            f"choose another one, such as resolution='1ms'"
        )
    late = getattr(monitor, "_late", None)
    mode = collector_of(monitor).mode
    tolerance = 0.0 if dense else monitor._tolerance
    parts = [
        _HEAD.pack(
            _MAGIC,
            _VERSION,
            mode,
            dense,
            states.version,
            step.numerator,
            step.denominator,
            tolerance,
            -1 if late is None else late,
        )
    ]
    inputs = monitor._inputs if early else monitor.input_names
    ranges = monitor._known_ranges() if early else [(float("-inf"), float("inf"))] * len(inputs)
    parts.append(_COUNT.pack(len(inputs)))
    for name, bounds in zip(inputs, ranges, strict=True):
        parts += [_text(name), _COUNT.pack(monitor._types.get(name) is BOOLEAN), _RANGE.pack(*bounds)]
    formulas = monitor._formulas
    parts += [_text(to_text(formulas[0], limit=PAGE)), _text(json.dumps(states.made_of))]
    origins = (
        [origin for group in session._groups for origin in group.graph.origins]
        if early
        else session.program.origins
    )
    meanings = _meanings(origins, formulas)
    parts.append(_COUNT.pack(len(meanings)))
    for place, text in meanings.items():
        parts += [_COUNT.pack(place), _text(text)]
    parts.append(_data(b"" if early else session.program.code()))
    groups: Sequence[Group] = session._groups if early else ()
    places: Sequence[Any] = session._places if early else ()
    parts.append(_COUNT.pack(len(groups)))
    for group in groups:
        parts += _group(group, inputs)
    parts.append(_COUNT.pack(len(places)))
    for each in places:
        parts += [_COUNT.pack(len(each)), *(struct.pack("<II", *place) for place in each)]
    body = b"".join(parts)
    return body + _COUNT.pack(zlib.crc32(body))


def _require_plain(monitor: Any) -> None:
    """Raise :class:`UsageError` for a monitor that does what the C API does not."""
    session = monitor._session
    given = {
        "time_unit=": monitor._unit is not None,
        "watch=": len(monitor._formulas) > 1,
        "episodes=": monitor._episodes is not None,
        "explain=": getattr(monitor, "_explained", False),
        "on_correction='replay'": getattr(monitor, "_replays", False),
    }
    for setting, present in given.items():
        if present:
            raise UsageError(f"fleets of the C API have no {setting}; leave it out")
    if getattr(monitor, "_channels", None):
        raise UsageError(
            "fleets of the C API have no operators that ask whether a sample is there; monitor them in Python"
        )
    if session.calls or not isinstance(session, CompiledSession | EarlyProgram):
        raise UsageError(
            "fleets of the C API have backend='cpp', no custom operators, and in dense time with delayed verdicts "
            "requirements over the same variables; make a fleet of each requirement"
        )


def _group(group: Group, inputs: Sequence[str]) -> list[bytes]:
    """Return the bytes of formulas over one trace."""
    graph = group.graph
    parts = [_numbers([inputs.index(name) for name in graph.inputs]), _COUNT.pack(len(graph.nodes))]
    for node in graph.nodes:
        own = node.kind, node.a, node.b, node.low, node.high, node.horizon, len(node.steps)
        parts += [_NODE.pack(*own), *(_STEP.pack(*step) for step in node.steps)]
    parts += [_numbers(group.outputs), _COUNT.pack(len(graph.items))]
    parts += [_ITEM.pack(*item) for item in graph.items]
    parts.append(_COUNT.pack(group.causes is not None))
    return parts if group.causes is None else [*parts, *_causes(group.causes)]


def _causes(causes: Causes) -> list[bytes]:
    return [
        _COUNT.pack(len(causes.parts)),
        *(_CAUSE.pack(*part) for part in causes.parts),
        _numbers(causes.outputs),
        _COUNT.pack(len(causes.starts)),
        *(_START.pack(*start) for start in causes.starts),
    ]


def _numbers(numbers: Sequence[int]) -> bytes:
    return struct.pack(f"<{len(numbers) + 1}I", len(numbers), *numbers)


def _data(content: bytes) -> bytes:
    return _COUNT.pack(len(content)) + content


def _text(text: str) -> bytes:
    return _data(encoded(text))
