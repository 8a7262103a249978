"""Semantics other than robustness, implemented as a replacement of predicates.

A semantics is one function: it receives a predicate and the roles of the variables, and returns the
formula whose robustness replaces that of the predicate. :data:`SEMANTICS` is the table of named
semantics; :func:`apply_semantics` applies any of them, or a custom one. The result is an ordinary formula,
so that every engine, online or offline, supports every semantics.

A predicate is a comparison, or a number used as a formula, which holds where it is positive. Everything inside
a predicate belongs to it: in ``(x >= 3) + y >= 2`` the formula ``x >= 3`` is read as a number, its robustness
under every semantics, and the predicate's variables are x and y. ``true`` and ``false`` are not
predicates.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from types import MappingProxyType

from rtamt.errors import EvaluationError, StlError, UsageError, choices, shown
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, located, postorder
from rtamt.language.operators import STL
from rtamt.language.unwritten import COLUMN, PRESENT
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TypeAlias
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.truth import replaced, truth

#: The role of each variable: ``"input"`` or ``"output"``.
Roles: TypeAlias = Mapping[str, str]

#: A function from a predicate and the roles of its variables to the formula that replaces it.
PredicateSemantics: TypeAlias = Callable[[Formula, Roles], Formula]

ROLES = ("input", "output")


def standard(predicate: Formula, _roles: Roles) -> Formula:
    """Standard robustness: a predicate has its ordinary value.

    By the letter of relative robustness, a predicate without variables (3 >= 2) would be infinite here,
    too, because the empty set is a subset of the fixed variables; standard robustness is the definition itself.
    """
    return predicate


@dataclass(frozen=True, slots=True)
class Relative:
    """U-robustness relative to V (the paper's section 2.3).

    ``measured`` (U) and ``fixed`` (V) are the roles of the variables whose change is measured, and of
    those that cannot change. A predicate that reads any other variable has robustness 0: the smallest change may
    overturn it. A predicate that reads only fixed variables (or none at all) evaluates to its truth, +inf or
    -inf. All others have their ordinary value.
    """

    measured: frozenset[str] = frozenset()
    fixed: frozenset[str] = frozenset()

    def __call__(self, predicate: Formula, roles: Roles) -> Formula:
        """Return the formula that replaces a predicate."""
        read = {roles[name] for name in _read_by(predicate)}
        if not read <= self.measured | self.fixed:
            return Const(0.0)
        return truth(predicate) if read <= self.fixed else predicate


_INPUTS, _OUTPUTS = (frozenset({role}) for role in ROLES)

#: The named semantics.
SEMANTICS: Mapping[str, PredicateSemantics] = MappingProxyType(
    {
        "standard": standard,
        "output_robustness": Relative(measured=_OUTPUTS, fixed=_INPUTS),
        "input_vacuity": Relative(measured=_INPUTS),
        "input_robustness": Relative(measured=_INPUTS, fixed=_OUTPUTS),
        "output_vacuity": Relative(measured=_OUTPUTS),
        "boolean": Relative(fixed=_INPUTS | _OUTPUTS),
    }
)


def semantics_of(semantics: object) -> str | PredicateSemantics:
    """Return the key of a semantics in :data:`SEMANTICS`, or a custom semantics as it is.

    Dashes are accepted for underscores, and members of an enumeration for their text.

    >>> semantics_of("output-robustness")
    'output_robustness'
    """
    if callable(semantics) and not isinstance(semantics, type):
        return semantics
    name = str(semantics).replace("-", "_")
    if not isinstance(semantics, str | Enum) or name not in SEMANTICS:
        raise UsageError(f"unknown semantics {shown(semantics)}{choices(name, SEMANTICS, 'semantics')}")
    return name


def apply_semantics(formula: Formula, semantics: str | PredicateSemantics, roles: Roles) -> Formula:
    """Return the formula whose robustness is the value of ``formula`` under a semantics.

    ``semantics``: a name in :data:`SEMANTICS`, or a function that is called as
    ``semantics(predicate, roles)`` for every predicate. ``roles``: the known roles; a variable without
    a role is an output, and a field has the role of its variable. The result reads the same variables in
    the same order, and computes the operands of every predicate, so that an undefined operation on numbers
    (0/0) is an error under every semantics.

    Raises :class:`UsageError` if the function returns anything but a formula over the
    predicate's variables.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("always(req >= 3 -> gnt >= 3)")
    >>> apply_semantics(formula, "output_robustness", {"req": "input"})
    <formula always(req >= 3 -> gnt >= 3)>
    """
    semantics = SEMANTICS[semantics] if isinstance(semantics, str) else semantics
    if semantics is standard:
        return formula
    formula = spelled_out(formula)  # the expansion of a custom operator may contain predicates
    all_roles = MappingProxyType({name: role_of(name, roles) for name in variables(formula)})

    def apply(predicate: Formula) -> Formula:
        if isinstance(predicate, Apply) and predicate.op is COLUMN:  # its members are under the semantics
            return truth(predicate) if semantics is SEMANTICS["boolean"] else predicate
        return _apply_to_predicate(predicate, semantics, all_roles)

    return replaced(formula, apply)


def boolean(formula: Formula) -> Formula:
    """Return the formula whose robustness is +inf where ``formula`` holds and -inf where it does not.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> str(boolean(parse_formula("always(x >= 3)")))
    'always(x >= 3)'
    """
    return apply_semantics(formula, "boolean", {})


def no_verdict(error: EvaluationError) -> EvaluationError:
    """Return the error for a formula with robustness but without truth: an operator may yield NaN for infinities."""
    return EvaluationError(f"there is no verdict, for which true counts as +inf and false as -inf: {error}")


def role_of(name: str, roles: Roles) -> str:
    """Return the role of a variable or of one of its fields; the default is output.

    >>> role_of("req.value", {"req": "input"}), role_of("gnt", {"req": "input"})
    ('input', 'output')
    """
    return roles.get(name) or roles.get(name.partition(".")[0], "output")


def _read_by(predicate: Formula) -> set[str]:
    """Return the variables of a predicate; the presence of members, which quantifiers add to it, is none of them."""
    present = [node for node in postorder(predicate) if isinstance(node, Apply) and node.op is PRESENT]
    return {*variables(predicate)}.difference(*map(variables, present))


def _apply_to_predicate(predicate: Formula, semantics: PredicateSemantics, roles: Roles) -> Formula:
    """Return the replacement of a predicate under a semantics; it reads the same variables."""
    from rtamt.language.printing.printer import excerpt

    try:
        applied = semantics(predicate, roles)
    except StlError:
        raise
    except Exception as error:
        raise EvaluationError(
            f"the semantics {_name(semantics)} failed for the predicate '{excerpt(predicate)}': "
            f"{type(error).__name__}: "
            f"{error}; it is called with a predicate and the roles, and returns a formula"
        ) from error
    if not isinstance(applied, Formula):
        raise UsageError(
            f"the semantics {_name(semantics)} returned {shown(applied)} for the predicate '{excerpt(predicate)}'; "
            f"return a formula"
        )
    if applied is predicate:
        return predicate
    holding = located(truth(predicate), predicate.span)
    if applied == holding:
        return holding
    known = set(variables(predicate))
    for name in variables(applied):
        if name not in known:
            raise UsageError(
                f"the semantics {_name(semantics)} returned '{excerpt(applied)}' for the predicate "
                f"'{excerpt(predicate)}', which does not read '{name}'; use the predicate's own variables"
            )
    # min(inf, v) is v; the truth, +inf or -inf, is added only so that its operands are computed.
    return STL["and"](STL["or"](holding, STL["true"]()), applied)


def _name(semantics: PredicateSemantics) -> str:
    return f"'{getattr(semantics, '__name__', repr(semantics))}'"
