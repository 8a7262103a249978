"""The formulas of a parsed specification: their text, and the values of their parts."""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction
from numbers import Real
from typing import TYPE_CHECKING, Any

from rtamt.compat.declarations import Declarations
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.options import Semantics
from rtamt.errors import UsageError, did_you_mean
from rtamt.language.contents import variables
from rtamt.language.formula import Formula, Var, outermost, postorder
from rtamt.language.parsing.grammar import is_number
from rtamt.language.printing.printer import canonical
from rtamt.language.units.durations import UNITS
from rtamt.lazy.dataclasses import dataclass
from rtamt.rewrite.ground import grounds
from rtamt.rewrite.semantics import apply_semantics, boolean, semantics_of
from rtamt.rewrite.truth import is_part_of_a_condition

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import Self

    from rtamt.language.document import Document
    from rtamt.rewrite.semantics import PredicateSemantics


@dataclass(frozen=True, slots=True)
class Node:
    """A formula as RTAMT's syntax trees have it: ``name`` is its canonical text.

    ``unit``: seconds in one unit of its bounds. ``period``: the step of ``next`` in seconds.
    """

    name: str
    formula: Formula
    unit: Fraction
    period: Fraction


class Formulas(Declarations):
    """A parsed specification, shared by the classes of both time domains. Not instantiated by users."""

    #: The step of ``next`` in seconds; dense time has no ``next``.
    _period = Fraction(1)
    _semantics: Semantics | str | PredicateSemantics = Semantics.STANDARD

    def __init__(self) -> None:
        super().__init__()
        self._formulas: dict[str, Formula] = {}  # by name, the result last
        self._inputs: tuple[str, ...] = ()  # the variables they read, fields by full name
        self._value_of: Callable[[Formula], Any] | None = None  # of the latest evaluation or update

    def _accept(self, document: Document) -> None:
        formulas = self._assertions(document)
        for formula in outermost([*formulas.values()]):
            self._check(formula, document.text)
        self._formulas = dict(zip(formulas, grounds(tuple(formulas.values()), self._tick), strict=True))
        self._inputs = variables(*formulas.values())
        self._value_of = None

    @property
    def semantics(self) -> Semantics | str | PredicateSemantics:
        """The semantics of predicates: a :class:`Semantics`, or a value that :func:`rtamt.parse` accepts."""
        return self._semantics

    @semantics.setter
    @raises_rtamt
    def semantics(self, semantics: Semantics | str | PredicateSemantics) -> None:
        semantics_of(semantics)
        self._semantics = semantics
        self._apply_settings()

    @property
    def _tick(self) -> Fraction:
        """Seconds of the step in which bounds are counted."""
        return self._period

    @abstractmethod
    def _check(self, formula: Formula, text: str) -> None:
        """Raise :class:`SpecificationError` where a formula has no meaning in this time domain."""

    @raises_rtamt
    def spec_print(self) -> str:
        """Return the formula in RTAMT's canonical text; after ``pastify`` the pastified one.

        >>> import rtamt
        >>> spec = rtamt.StlDiscreteTimeSpecification()
        >>> spec.spec = "eventually[0,1] (a >= b)"
        >>> spec.parse()
        >>> spec.spec_print()
        'eventually[0,1]((a)>=(b))'
        """
        return canonical(self._result)

    @property
    def ast(self) -> Self:
        """The specification itself: in RTAMT, a separate object holds declarations and formulas."""
        return self

    @property
    def specs(self) -> list[Node]:
        """The formulas of all assertions, in the order of the text; after ``pastify`` the pastified ones."""
        unit = UNITS[self._unit]
        return [Node(canonical(f), f, unit, self._period) for f in self._formulas.values()]

    @property
    def _result(self) -> Formula:
        """The formula of the last assertion."""
        _ = self._parsed_document
        return list(self._formulas.values())[-1]

    # ---- semantics -------------------------------------------------------------------------------

    def _apply_semantics(self, formula: Formula) -> Formula:
        """Return the formula whose robustness is the value of ``formula`` under the semantics."""
        return apply_semantics(formula, semantics_of(self._semantics), self.var_io_dict)

    def _under_semantics(self, part: Formula) -> Formula:
        """Return the formula whose robustness is the value of a part of the specification.

        Numbers have their ordinary value under every semantics, and conditions are true or false.
        """
        if part is not self._result and is_number(part):
            return part
        if is_part_of_a_condition(part, tuple(self._formulas.values())):
            return boolean(part)
        applied = self._apply_semantics(part)
        read_so = postorder(*map(self._apply_semantics, self._formulas.values()))
        return applied if applied == part or applied in set(read_so) else part

    # ---- values ----------------------------------------------------------------------------------

    @raises_rtamt
    def get_value(self, var_name: str) -> Any:
        """Return the current value of a variable, an assertion or a sub-formula.

        ``var_name``: the name of a variable or assertion, or the text of a formula, such as its
        canonical text ``'(a)>=(2.0)'``. After ``evaluate`` the value is a list: one number per sample,
        in dense time ``[[time, value], ...]``. After ``update`` it is the latest number; in dense time it is
        again a list: the values that the update made known, or for a variable the samples that it gave. Before
        both it is the declared value. A variable of a message class returns its object.
        """
        if var_name in self._objects and (self._value_of is None or self._holds(var_name)):
            return self._objects[var_name]
        if self._value_of is None:
            hint = "" if var_name in self._formulas else did_you_mean(var_name, self._objects)
            raise UsageError(f"'{var_name}' has no value yet{hint}; call update() or evaluate() first")
        return self._value_of(self._find_formula(var_name))

    def _holds(self, name: str) -> bool:
        """Return whether the stored entry of a variable is its value: objects are kept, numbers need not be."""
        return not isinstance(self._objects[name], Real)

    def _find_formula(self, text: str) -> Formula:
        if text in self._formulas:
            return self._formulas[text]
        if text in self._inputs:
            return Var(text)
        if text in self._types:
            raise UsageError(f"the specification does not read '{text}', so that its values are not kept")
        (formula,) = grounds((self._read_formula(text),), self._tick)
        if formula not in set(postorder(*self._formulas.values())):
            raise UsageError(f"'{text}' is no part of the specification {self.spec_print()}")
        return formula
