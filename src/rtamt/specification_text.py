"""The contents of a specification: its text, names and formulas, and their rewriting."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from types import MappingProxyType

from rtamt.engine import Watched
from rtamt.errors import UsageError
from rtamt.language.contents import types_of, variables
from rtamt.language.formula import Formula, outermost
from rtamt.language.operators import STL, Language
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.type_rules import as_formula
from rtamt.language.quantifiers import quantifiers
from rtamt.language.units.durations import NANOSECOND, positive_period
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import SEMANTICS, apply_semantics, semantics_of, standard
from rtamt.signals.discrete import DISCRETE, Discrete
from rtamt.signals.time_domains import Defaults, time_domain

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Self

    from rtamt.language.document import Document
    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.language.printing.sentences import Sentence
    from rtamt.language.units.durations import Duration
    from rtamt.language.value_types import ValueType
    from rtamt.lint.found import LintWarning
    from rtamt.rewrite.quantifiers import Members
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.settings import Semantics
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.specification_groups import QuantifiedText
    from rtamt.verdicts.robustness_and_truth import Outputs


@dataclass(frozen=True, eq=False, repr=False)
class SpecificationText:
    """The text of one requirement or several, with the settings under which it is read."""

    document: Document
    domain: TimeDomain = DISCRETE
    #: The settings of evaluations and monitors in another time domain than ``domain``.
    period: Fraction | None = None
    resolution: Fraction = NANOSECOND
    unit: str = "s"
    backend: str = "cpp"
    language: Language = STL
    semantics: str | PredicateSemantics = "standard"
    #: From a variable to ``"input"`` or ``"output"``: what the text declares, and what was given.
    roles: Mapping[str, str] = field(default_factory=dict)
    #: The recorded names of variables that replace those the text declares.
    columns: Mapping[str, str] = field(default_factory=dict)
    #: How recordings are sampled in discrete time: the sampling rule of the text, unless others replace it.
    sampling: Sampling | None = None
    #: The specification whose quantifiers were replaced, and by which members; see ``specification_groups.py``.
    resolved: tuple[QuantifiedText, Members] | None = None

    def __repr__(self) -> str:
        return f"<specification {f'{self.name}: ' if self.name else ''}{self.formula}>"

    def _repr_html_(self) -> str:
        from html import escape

        from rtamt.language.printing.printer import excerpt

        name = f"<b>{escape(self.name)}</b>" if self.name else ""
        rows = [
            f"<tr><td>{escape(known.name)}</td><td><code>{escape(excerpt(known.formula))}</code></td>"
            f"<td>{escape(known.description)}</td></tr>"
            for known in self.document.requirements
        ]
        return (
            f"{name}<table><tr><th>requirement</th><th>formula</th><th>text</th></tr>{''.join(rows)}</table>"
        )

    @property
    def time(self) -> str:
        """The name of the time domain: ``"discrete"`` or ``"dense"``."""
        return self.domain.name

    @property
    def formula(self) -> Formula:
        """The formula of the requirement; of several their conjunction, whose robustness is the minimum."""
        return self.document.formula

    @property
    def requirements(self) -> Mapping[str, Self]:
        """Every requirement by name, in the order of the text, each as a separate specification.

        The requirements are the formulas after ``require``; in a text without any, the formulas (not
        numbers) that no other one uses. One that has no name is ``requirement_2``, if it is the second.

        >>> import rtamt
        >>> spec = rtamt.parse('''
        ...     near = distance <= 30
        ...     require REQ-7 "brakes in time" severity warning: always(near -> eventually[0:1](brake >= 1))
        ...     require REQ-8: always(distance >= 2)''')
        >>> spec.requirements["REQ-8"]
        <specification REQ-8: always(distance >= 2)>
        >>> [(requirement.name, requirement.severity) for requirement in spec.document.requirements]
        [('REQ-7', 'warning'), ('REQ-8', 'error')]
        """
        known = self.document.requirements
        # Kept, the only one would be a cycle, which waits for the garbage collector.
        return MappingProxyType({known[0].name: self}) if len(known) == 1 else self._several

    @cached_property
    def _several(self) -> Mapping[str, Self]:
        """The requirements of a text with several."""
        names = [requirement.name for requirement in self.document.requirements]
        return MappingProxyType({name: self.select(name) for name in names})

    @cached_property
    def warnings(self) -> tuple[LintWarning, ...]:
        """Warnings about valid but probably unintended text, each with a code, a message and a position.

        >>> import rtamt
        >>> print(*rtamt.parse("prev(x) - x <= 3").warnings)
        RT105: 'prev' applies to all of '(x) - x <= 3'; write prev((x) - x <= 3) if that is meant
          line 1, column 1:
            prev(x) - x <= 3
            ^^^^^^^^^^^^^^^^
        """
        from rtamt.lint.report import findings

        return findings(self.document, self.language, self.period)

    def describe(self) -> Mapping[str, Sentence]:
        """Return each requirement as an English sentence, by name.

        A named sub-specification is written by its name; ``names`` of a sentence has what that means.

        >>> import rtamt
        >>> spec = rtamt.parse("near = gap < 30; require REQ-7: always(near -> eventually[0:1](brake > 0.5))")
        >>> print(spec.describe()["REQ-7"].text)
        At every instant from now on, if near, then at some instant within the next 1 s, brake is more than 0.5.
        >>> dict(spec.describe()["REQ-7"].names)
        {'near': 'gap is less than 30.'}
        """
        from rtamt.language.printing.sentences import sentences_of

        return sentences_of(self.document)

    def select(self, name: str) -> Self:
        """Return the specification of one requirement or named sub-specification alone.

        Raises :class:`UsageError` if there is none of this name.
        """
        return replace(self, document=self.document.select(name))

    def with_parameters(self, /, **values: Any) -> Self:
        """Return the specification with these values of its parameters; the others keep theirs.

        The text is not parsed and the formula is not compiled again, unless a value bounds an interval. Pass names that
        are not words in a mapping: ``with_parameters(**{"battery.low": 3.5})``. Bounds have the exact value of a
        ``Fraction`` or a ``Decimal``. A Boolean is set to True or False, a
        parameter of an enumeration to a member: its name, its code, or a member of a Python ``enum`` of that name.
        Raises :class:`UsageError` for names that are not parameters and values that do not have the type,
        :class:`BoundError` for an impossible bound.

        >>> import rtamt
        >>> spec = rtamt.parse("input float x  parameter float limit = 4  always(x <= limit)")
        >>> spec.evaluate({"x": [1, 2]}).robustness, spec.with_parameters(limit=3).evaluate({"x": [1, 2]}).robustness
        (2.0, 1.0)
        >>> dict(spec.with_parameters(limit=3).parameters)
        {'limit': 3.0}
        """
        from rtamt.specification_parameters import with_values

        return with_values(self, values)

    def _check_bounds(self) -> None:
        """Raise :class:`BoundError` for a bound that is no multiple of the period or tick."""
        checked = dict.fromkeys((self.domain, Discrete(self.period)))
        for formula in outermost([assertion.formula for assertion in self.document.assertions]):
            for each in checked:
                each.check(formula, self.text)

    @property
    def parameters(self) -> Mapping[str, float]:
        """The values in use of the declared parameters; see :meth:`with_parameters`.

        >>> import rtamt
        >>> dict(rtamt.parse("parameter float limit = 4 [m]  always(x <= limit)").parameters)
        {'limit': 4.0}
        """
        return self.document.parameters

    def with_formula(self, formula: Formula) -> Self:
        """Return the specification of another formula over the same names, such as a pastified one.

        >>> import rtamt
        >>> spec = rtamt.parse("asked = req >= 3; always[0:1](asked -> gnt >= 3)")
        >>> monitor = spec.with_formula(spec.pastified()).monitor()
        >>> monitor.update(0.0, req=5, gnt=2)
        -1.0

        Raises :class:`UsageError` for anything but a formula.
        """
        if not isinstance(formula, Formula):
            raise UsageError(
                f"with_formula takes a formula, such as spec.pastified(), got {type(formula).__name__}; "
                f"rtamt.parse reads text"
            )
        return replace(self, document=self.document.with_formula(formula))

    @property
    def text(self) -> str:
        """The text from which the specification was parsed."""
        return self.document.text

    @property
    def name(self) -> str | None:
        """The name of a requirement of several; else the one after ``specification``, if there is one."""
        return self.document.selected or self.document.name

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """The variables that the formula (or any of several requirements) reads, in order of appearance.

        In dense time, a requirement that reads none reads those of its text: they determine its trace.
        """
        names = variables(self.formula)
        if self.resolved is None:
            return names or self._names_beside
        # Over few members, no pair of them may be left to read what starts and ends the trace.
        names = tuple(dict.fromkeys((*names, *self.resolved[0].input_names)))
        return names or tuple(each.name for each in self.document.declarations if each.kind == "var")

    @property
    def _names_beside(self) -> tuple[str, ...]:
        """The variables that the other requirements read in dense time; those that recordings may lack if need be."""
        origin = self.document.origin
        if origin is None or not self.domain.own_time_bases or quantifiers(self.formula):
            return ()
        names = variables(origin.formula)
        optional = {each.name for each in self.document.declarations if each.optional}
        return tuple(name for name in names if name.partition(".")[0] not in optional) or names

    @cached_property
    def types(self) -> Mapping[str, ValueType]:
        """The types of those variables of the formula that are Booleans or enumerations."""
        found = types_of(self.formula)
        if self.resolved is not None or not variables(self.formula):
            declared = self.document.types
            found |= {name: declared[name] for name in self.input_names if name in declared}
        return MappingProxyType(found)

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known online; inf if never. The paper's Definition 3."""
        return self._horizon_in(self.domain, self.period)

    def _horizon_in(self, domain: TimeDomain, period: Fraction | None) -> float:
        """Return the horizon in a time domain, such as that of a recording, by default with a period of 1 s."""
        depth = horizon(self._grounded(domain), period or Fraction(1))
        return float("inf") if depth is None else float(depth)

    def pastified(self, period: Duration | None = None) -> Formula:
        """Return Π(φ): past operators only, the same value one horizon later (Definition 4).

        That holds under every semantics, since predicates stay what they are.

        >>> import rtamt
        >>> print(rtamt.parse("x >= 3 -> eventually[0:5](y >= 3)").pastified())
        once[5:5](x >= 3) -> once[0:5](y >= 3)
        """
        from rtamt.rewrite.pastify import pastify

        step = self.period if period is None else positive_period(period)
        formula = self._grounded(self._domain_for(period=period))
        return pastify(formula, step or Fraction(1), self.text, self.unit)

    def _grounded(self, domain: TimeDomain) -> Formula:
        """Return the monitored formula, whose bounds are closed; without a domain, bounds need not fit."""
        (formula,) = domain.online.ground(self.formula)
        return formula if formula is self.formula else domain.online.check(self.formula, self.text)

    def _apply_semantics(
        self, formula: Formula, semantics: str | PredicateSemantics | None = None
    ) -> Formula:
        """Return the formula whose robustness is the value of ``formula`` under a semantics.

        ``semantics``: by default that of the specification; see :func:`rtamt.rewrite.semantics.lower`.
        """
        chosen = self._semantics(semantics)
        if not isinstance(chosen, str) or SEMANTICS[chosen] is standard:
            return apply_semantics(formula, chosen, self.roles)
        applied = self._lowered.get((formula, chosen))
        if applied is None:
            applied = self._lowered[formula, chosen] = apply_semantics(formula, chosen, self.roles)
        return applied

    def _outputs(
        self, semantics: str | PredicateSemantics | None = None, formula: Formula | None = None
    ) -> Outputs:
        """Return the formulas that decide the requirement: robustness under a semantics, and truth.

        ``formula``: one that replaces that of the specification, such as its pastified form.
        """
        from rtamt.verdicts.robustness_and_truth import Outputs

        chosen = self.formula if formula is None else formula
        return Outputs(self._apply_semantics(chosen, semantics), self._apply_semantics(chosen, "boolean"))

    def _named(self, name: str) -> Formula:
        """Return a named sub-specification or requirement, or the formula of any other text, read in its place."""
        known = self._known(name)
        if known is not None:
            return known
        from rtamt.language.parameters import with_values

        formula = parse_formula(
            name,
            language=self.language,
            constants=self.document.constants,
            definitions=self.document.definitions,
            variables=self.document.variables or None,
            types=self.document.types,
            enumerations=self.document.enumerations,
            tables=self.document.tables,
            unit=self.unit,
            parameters=self.parameters,
            templates=self.document.templates,
            groups=self.document.groups,
            units=self.document.units,
        )
        if self.resolved is not None:
            from rtamt.rewrite.quantifiers import resolve

            formula = resolve(formula, self.resolved[1])
        return with_values([formula], self.parameters)[0]

    def _watched(self, given: str | Formula, semantics: Semantics | None) -> Watched:
        if isinstance(given, str):
            formula = self._named(given)
        else:
            from rtamt.language.parameters import with_values

            formula = with_values([given], self.parameters)[0]
        if not is_number(formula):
            formula = self._apply_semantics(formula, self._semantics(semantics))
        if not isinstance(given, str):  # its positions may be those of another text
            return Watched(given, formula, None)
        return Watched(given, formula, given if self._known(given) is None else self.text)

    def _known(self, name: str) -> Formula | None:
        """Return a named sub-specification or requirement, if there is one."""
        definition = self.document.definitions.get(name)
        if definition is not None:
            return as_formula(definition)
        return next((known.formula for known in self.document.requirements if known.name == name), None)

    @cached_property
    def _lowered(self) -> dict[tuple[Formula, str], Formula]:
        return {}

    def _domain_for(
        self,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
    ) -> TimeDomain:
        """Return the requested time domain; omitted settings are those of the specification."""
        if time is period is tolerance is resolution is None:
            return self.domain
        defaults = Defaults(self.period, self.domain.tolerance, self.resolution)
        named = self.domain.name if time is None else time
        return time_domain(named, period, tolerance, resolution, defaults)

    def _semantics(self, semantics: Semantics | None) -> str | PredicateSemantics:
        return self.semantics if semantics is None else semantics_of(semantics)

    def __str__(self) -> str:
        from rtamt.language.printing.printer import to_text

        return to_text(self.formula, self.language)
