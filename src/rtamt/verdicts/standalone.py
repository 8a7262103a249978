"""Compile a requirement to a standalone program with robustness, verdict, parameters and metadata."""

from __future__ import annotations

import struct
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.compiler.early import compile_starts
from rtamt.compiler.metadata import Metadata
from rtamt.compiler.plan import compile_program
from rtamt.compiler.program import Instruction, Program, records_of
from rtamt.engine import engine_of
from rtamt.engine.backend import compiled_backend
from rtamt.errors import UsageError
from rtamt.language.contents import types_of, variables
from rtamt.language.formula import Apply, Const, Formula, Parameter, fold
from rtamt.language.parameters import bounds_of
from rtamt.language.printing.printer import to_text
from rtamt.language.printing.writing import EXCERPT, PAGE
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.dataclasses import replace
from rtamt.rewrite.check import check_online
from rtamt.rewrite.desugar import as_written, desugar, written
from rtamt.verdicts.robustness_and_truth import Outputs, outputs_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from rtamt.engine.backend import Place
    from rtamt.signals.time_domain_interface import TimeDomain

#: The outputs of a standalone program, in this order: ρ, and +inf or -inf as the formula holds or not. Of several
#: requirements, both of all together, then of each: ``robustness.R1``, ``verdict.R1``.
OUTPUTS = ("robustness", "verdict")


def carried_program(
    formula: Formula,
    domain: TimeDomain,
    *,
    applied: Formula | None = None,
    parts: Mapping[str, Outputs] | None = None,
    text: str | None = None,
    name: str | None = None,
) -> Program:
    """Compile a requirement for carriers: outputs :data:`OUTPUTS`, its parameters and named constants as parameters.

    ``domain``: with a known step. ``applied``: the formula whose robustness is
    reported, where a semantics replaces predicates; the verdict is that of ``formula``. ``parts``: by name the
    outputs of each of several requirements. ``text``: what errors point at. A
    constant that is also the bound of an interval decides how long windows are, and is no parameter.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.signals.discrete import Discrete
    >>> formula = parse_formula("always[0:2](x >= limit)", constants={"limit": 3})
    >>> program = carried_program(formula, Discrete(period=1))
    >>> dict(program.metadata.parameters), program.instructions[1].x
    ({'limit': (1,)}, 3.0)
    """
    assert domain.step is not None, "a program has a fixed step"
    domain.check(formula, text)
    check_online(formula, text)
    inputs = variables(formula)
    domain.check_inputs(inputs)
    structural = bounds_of(formula)
    pairs = {"": outputs_of(formula, applied)} | {f".{name}": pair for name, pair in (parts or {}).items()}
    grounded = domain.ground(*(output for pair in pairs.values() for output in pair))
    cores = [_with_parameters(desugar(each), structural) for each in grounded]
    program = compile_program(cores, domain.step, inputs, domain=type(domain))
    # A delayed parameter is derived from the parameter, too.
    constants = [
        origin if instruction.opcode == "const" else None
        for instruction, origin in zip(program.instructions, program.origins, strict=True)
    ]
    metadata = Metadata(
        name or "",
        to_text(formula, limit=PAGE),
        tuple(f"{output}{suffix}" for suffix in pairs for output in OUTPUTS),
        _places(constants, 0),
        MappingProxyType(_meanings(program, [_with_parameters(each, structural) for each in grounded])),
        booleans=_booleans(formula, constants),
        enumerations=_enumerations(constants),
    )
    return replace(program, metadata=metadata)


#: The outputs of a standalone program of bounds, in this order: bounds of the robustness at the start of the trace,
#: +inf or -inf once its verdict is decided, and the seconds from the first sample to the one that decided it.
BOUNDS = ("lower", "upper", "verdict", "decided_since")

_NODE, _STEP, _ITEM = struct.Struct("<IIIqqqI"), struct.Struct("<IIId"), struct.Struct("<IIIIIq")
_RANGE = struct.Struct("<dd")


def bounds_program(
    formula: Formula,
    domain: TimeDomain,
    *,
    applied: Formula | None = None,
    text: str | None = None,
    name: str | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Program:
    """Compile a requirement for carriers that report outputs :data:`BOUNDS`, in discrete time.

    Arguments as for :func:`carried_program`; ``ranges``: of variables, which bound future samples. The
    future may be unbounded.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.signals.discrete import Discrete
    >>> program = bounds_program(parse_formula("always(x >= 3)"), Discrete(period=1))
    >>> program.metadata.outputs, len(program.metadata.early)
    (('lower', 'upper', 'verdict', 'decided_since'), 268)
    """
    if not domain.sampled:
        raise UsageError(
            "bounds at the start of the trace are compiled for discrete time: use it, or verdict='delayed'"
        )
    period = domain.step
    assert period is not None, "a program has a fixed step"
    domain.check(formula, text)
    inputs = variables(formula)
    domain.check_inputs(inputs)
    outputs = domain.ground(*outputs_of(formula, applied))
    structural = bounds_of(formula)
    cores = [_with_parameters(desugar(each), structural) for each in outputs]
    graph, (first, _) = compile_starts(cores, period, inputs)
    parts = [struct.pack("<III", len(graph.nodes), len(graph.items), first)]
    for node in graph.nodes:
        parts.append(
            _NODE.pack(node.kind, node.a, node.b, node.low, node.high, node.horizon, len(node.steps))
        )
        parts += [_STEP.pack(*step) for step in node.steps]
    parts += [_ITEM.pack(*item) for item in graph.items]
    limits = ranges or {}
    if not limits.keys().isdisjoint(inputs):
        parts += [_RANGE.pack(*limits.get(name, (-inf, inf))) for name in inputs]
    # Step k of the graph means what instruction k after the inputs does.
    steps = [step for node in graph.nodes for step in node.steps]
    instructions = [Instruction("input", n=i) for i in range(len(inputs))]
    instructions += [Instruction("const", x=step.x) for step in steps]
    given = [_with_parameters(each, structural) for each in outputs]
    metadata = Metadata(
        name or "",
        to_text(formula, limit=PAGE),
        BOUNDS,
        _places(graph.origins, len(inputs)),
        MappingProxyType(
            {
                len(inputs) + i: _label(written(origin, given))
                for i, origin in enumerate(graph.origins)
                if isinstance(origin, Apply)
            }
        ),
        early=b"".join(parts),
        booleans=_booleans(formula, graph.origins),
        enumerations=_enumerations(graph.origins),
    )
    last = (len(instructions) - 1,) * len(BOUNDS)
    return Program(records_of(instructions), inputs, last, period, metadata=metadata)


def check_code(program: Program, code: bytes) -> None:
    """Raise :class:`UsageError` for bytes that no core runs: an impossible width, an operand that does not exist."""
    try:
        compiled_backend(program.domain).check(code, program.inputs)
    except ValueError as error:
        raise UsageError(str(error).rstrip(".").replace("This", "this", 1)) from None


def state_bytes(program: Program, domain: TimeDomain, backend: str) -> int | None:
    """Return the size of a monitor's state; None where it depends on the samples, or without the compiled core."""
    return engine_of(domain).backends[backend].memory(program)


def layout(program: Program) -> Sequence[Place]:
    """Return where the core computes and keeps each instruction of a program; empty where it merges none."""
    return compiled_backend(program.domain).layout(program)


def _with_parameters(formula: Formula, structural: frozenset[str]) -> Formula:
    """Return the formula with named constants as parameters, and those that bound an interval as constants."""

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Apply):
            return replace(node, args=args)
        if not isinstance(node, Const) or node.name is None:
            return node
        if isinstance(node.type, Enumeration) and not isinstance(node, Parameter):
            return node  # a member is no constant, although it has a name
        kind = Const if node.name in structural else Parameter
        return kind(node.value, node.span, node.name, node.type)

    return fold(formula, step)


def _booleans(formula: Formula, origins: Sequence[Formula | None]) -> frozenset[str]:
    """Return the variables of a formula, and the parameters among ``origins``, that are declared as bool."""
    inputs = [name for name, type_ in types_of(formula).items() if type_ is BOOLEAN]
    given = [each.name for each in origins if isinstance(each, Parameter) and each.type is BOOLEAN]
    return frozenset([*inputs, *given])


def _enumerations(origins: Sequence[Formula | None]) -> Mapping[str, Enumeration]:
    """Return the types of the parameters among ``origins`` that have members as values."""
    return MappingProxyType(
        {
            each.name: each.type
            for each in origins
            if isinstance(each, Parameter) and isinstance(each.type, Enumeration)
        }
    )


def _places(origins: Sequence[Formula | None], first: int) -> Mapping[str, tuple[int, ...]]:
    """Return the instructions of each parameter; ``first``: that of the first of ``origins``."""
    places: dict[str, tuple[int, ...]] = {}
    for place, origin in enumerate(origins, first):
        if isinstance(origin, Parameter):
            places[origin.name] = (*places.get(origin.name, ()), place)
    return MappingProxyType(places)


def _label(formula: Formula) -> str:
    """Return the text of a formula for a message, with the names of parameters: their values may change."""
    return to_text(formula, limit=EXCERPT, parameters=True)


def _meanings(program: Program, formulas: Iterable[Formula]) -> dict[int, str]:
    """Return the formula that each instruction computes, as written in ``formulas`` and abbreviated for messages."""
    written = as_written(formulas)
    return {
        i: _label(written.get(formula, formula))
        for i, formula in enumerate(program.origins)
        if isinstance(formula, Apply)
    }
