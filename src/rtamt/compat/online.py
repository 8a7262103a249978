"""Pastification and output of the result, shared by the online classes of both time domains."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compat.failures import raises_rtamt
from rtamt.compat.formulas import Formulas
from rtamt.compat.objects import head_of
from rtamt.errors import RTAMTException, SpecificationError
from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.operators import Tense
from rtamt.rewrite.pastify import pastify
from rtamt.signals import arrays
from rtamt.usage_guard import UsageGuard

if TYPE_CHECKING:
    from rtamt.language.document import Document


class OnlineSpecification(Formulas):
    """A specification that is monitored while samples arrive. Not instantiated by users."""

    def __init__(self) -> None:
        super().__init__()
        self._pastified = False
        self._usage = UsageGuard()  # what takes more than one step is done alone
        # From a variable to the names that formulas read: the variable itself, or its fields by full name.
        self._reads: dict[str, list[str]] = {}

    @raises_rtamt
    def pastify(self) -> None:
        """Rewrite the formulas into past operators, with equal values one horizon later (the paper's Definition 4).

        Raises :class:`RTAMTException` at an operator with unbounded future.
        """
        text = self._parsed_document.text
        formulas = {
            name: pastify(formula, self._period, text, self._unit) for name, formula in self._formulas.items()
        }
        self._start_over(formulas)
        self._pastified = True

    def _accept(self, document: Document) -> None:
        super()._accept(document)
        self._reads = {}
        for name in self._inputs:
            self._reads.setdefault(head_of(name), []).append(name)
        self._start_over(self._formulas)
        self._pastified = False

    def _apply_settings(self) -> None:
        pastified = self._pastified
        super()._apply_settings()
        if pastified:
            self.pastify()

    def _start_over(self, formulas: dict[str, Formula]) -> None:
        """Monitor other formulas from now on, beginning with a new first sample."""
        self._formulas = formulas
        self._value_of = None

    def _publish(self, robustness: float) -> Any:
        """Write the result to the output variable of the specification, and return it."""
        head, field = self._out_name
        if not field:
            self._objects[head] = robustness
            return robustness
        *path, last = field.split(".")
        setattr(arrays.field(self._objects[head], path), last, robustness)
        return self._objects[head]


def require_past(formula: Formula, text: str) -> None:
    """Raise at the outermost operator that reads the future, which an online monitor cannot do."""
    future = [n for n in postorder(formula) if isinstance(n, Apply) and n.op.tense is Tense.FUTURE]
    if future:
        name = future[-1].op.name
        message = (
            f"{name[0].upper()}{name[1:]} operator is not implemented in the STL online monitor. "
            f"Call pastify() after parse(), or evaluate the finished trace offline"
        )
        raise RTAMTException(str(SpecificationError(message, text, future[-1].span)))
