"""The properties of a requirement that ``rtamt info`` prints: its horizon, pastified form, program and memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.compiler.plan import compile_program
from rtamt.errors import BoundError, SpecificationError
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.rewrite.check import check_online
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.early import ends_differently, loose
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import apply_semantics, boolean
from rtamt.verdicts.standalone import state_bytes

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class RequirementInfo:
    """The properties of a requirement; None for those that it does not have."""

    spec: Specification
    step: Fraction  # seconds in which bounds are counted: the period, or in dense time the tick
    horizon: Fraction | None = None
    pastified: Formula | None = None
    program: Program | None = None
    memory: int | None = None  # bytes; also None in dense time, or where there is no compiled core to ask
    offline_only: str | None = None  # why there is no program


def info_of(spec: Specification) -> RequirementInfo:
    """Compute the properties; those that an online monitor cannot have stay None."""
    domain = spec.domain.online
    step = domain.step
    assert step is not None
    facts = RequirementInfo(spec, step)
    try:
        check_online(spec.formula, spec.text)
        pastified = None if spec.groups else _pastify(spec)
        facts = replace(facts, horizon=depth(spec, spec.formula), pastified=pastified)
        domain.check(spec.formula, spec.text)
    except BoundError as error:
        return replace(facts, offline_only=error.message)
    if spec.groups:  # a program for each quantifier, which runs for each member
        return facts
    applied = desugar(_ground(spec, _apply_semantics(spec)))
    program = compile_program((applied,), step, spec.input_names, domain=type(spec.domain))
    memory = state_bytes(program, domain, spec.backend)
    return replace(facts, program=program, memory=memory)


def _ground(spec: Specification, formula: Formula) -> Formula:
    """Return the formula as it is monitored, with closed bounds."""
    return spec.domain.online.ground(formula)[0]


def depth(spec: Specification, formula: Formula) -> Fraction | None:
    """Return the horizon of a formula."""
    step = spec.domain.online.step
    assert step is not None
    return horizon(_ground(spec, formula), step)


def _pastify(spec: Specification) -> Formula | None:
    """Return the pastified formula, None if there is none: of shared sub-formulas it may be too large."""
    try:
        return spec.pastified()
    except BoundError:
        raise
    except SpecificationError:
        return None


def _apply_semantics(spec: Specification) -> Formula:
    """Return the formula under its semantics."""
    return apply_semantics(spec.formula, spec.semantics, spec.roles)


def loose_variable(facts: RequirementInfo) -> str | None:
    """Return a variable that may make intervals wider than necessary."""
    return loose(_ground(facts.spec, _apply_semantics(facts.spec)), facts.spec.domain.online.period)


def cut_operator(facts: RequirementInfo) -> str | None:
    """Return an operator whose windows may lose at the end of a discrete trace what was decided before."""
    found = ends_differently(_ground(facts.spec, boolean(facts.spec.formula)), facts.spec.ranges)
    return None if found is None else found.op.name
