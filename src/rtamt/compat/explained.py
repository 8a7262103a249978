"""Explanations and plots, shared by the offline classes of both time domains."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compat.backends import backend
from rtamt.compat.declarations import UNNAMED
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.formulas import Formulas
from rtamt.errors import UsageError
from rtamt.language.document import Requirement
from rtamt.language.formula import Var
from rtamt.language.printing.printer import canonical
from rtamt.lazy.dataclasses import replace
from rtamt.rewrite.semantics import apply_semantics, semantics_of
from rtamt.specification import Specification, result_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rtamt.explain.explanation import Explanation
    from rtamt.language.document import Document
    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.time_domain_interface import DomainTrace


class Explainer:
    """RTAMT's record of an explanation; the explanation of this library is returned by ``explain``."""

    def __init__(self) -> None:
        #: From the canonical text of the formula, of its predicates and of their variables to where they make it
        #: fail: ``[[first, last], ...]``, numbers of samples, in dense time times. Empty where it holds.
        self.explanations: dict[str, list[list[Any]]] = {}


class ExplainedSpecification(Formulas):
    """A specification whose evaluations can be explained. Not instantiated by users."""

    def __init__(self) -> None:
        super().__init__()
        self.explainer = Explainer()
        self._evaluated: tuple[Formula, DomainTrace, str | PredicateSemantics] | None = None

    def _accept(self, document: Document) -> None:
        super()._accept(document)
        self._evaluated = None
        self.explainer = Explainer()

    def _remember(self, formula: Formula, recording: DomainTrace | None) -> None:
        """Keep the evaluated recording, if there is one, and its semantics for a later explanation."""
        semantics = semantics_of(self._semantics)
        self._evaluated = None if recording is None else (formula, recording, semantics)

    @raises_rtamt
    def explain(self, at: Any = None) -> Explanation:
        """Explain why the latest ``evaluate`` found the specification satisfied or violated.

        ``at``: an instant; by default the first. The explanation prints as text and has data attributes:
        ``.critical``, ``.implicant``, ``.to_dict()``. Times are seconds in discrete time, and in
        :attr:`unit` in dense time. ``explainer.explanations`` is set as well, as by RTAMT. Raises
        :class:`RTAMTException` before the first ``evaluate``.

        >>> import rtamt
        >>> spec = rtamt.StlDiscreteTimeOfflineSpecification()
        >>> spec.declare_var("x", "float")
        >>> spec.spec = "always(x >= 3)"
        >>> spec.parse()
        >>> _ = spec.evaluate({"time": [0, 1, 2], "x": [5, 1, 4]})
        >>> print(spec.explain())
        violated, robustness -2: always(x >= 3)
        first violation at 1 s
        critical point at 1 s: 'x >= 3' is -2; the robustness follows it up to 1
        sufficient cause, independent of all other samples:
          'x >= 3' fails at 1 s (-2)
        """
        from rtamt.explain.explain import explain

        if self._evaluated is None:
            raise UsageError("there is nothing to explain yet; call evaluate() first")
        formula, recording, semantics = self._evaluated
        roles = self.var_io_dict
        found = explain(
            formula,
            recording,
            backend=backend(),
            at=at,
            text=self._parsed_document.text,
            semantics=lambda predicate: apply_semantics(predicate, semantics, roles),
        )
        self.explainer.explanations = _places(formula, recording, found)
        return found

    @raises_rtamt
    def plot(self, at: Any = None, *, figure: Figure | None = None) -> Figure:
        """Draw the signals of the latest ``evaluate``, the robustness over time and the explanation.

        ``at`` as for :meth:`explain`; ``figure``: the matplotlib figure to draw into, by default a new one of
        pyplot, which ``matplotlib.pyplot.show()`` displays. Needs ``pip install 'rtamt[plot]'``. Raises
        :class:`RTAMTException` before the first ``evaluate``.
        """
        if self._evaluated is None:
            raise UsageError("there is nothing to plot yet; call evaluate() first")
        formula, recording, semantics = self._evaluated
        document = replace(self._parsed_document, requirements=(Requirement(UNNAMED, formula),))
        spec = Specification(
            document, recording.domain, backend=backend(), semantics=semantics, roles=self.var_io_dict
        )
        return result_of(spec, recording).plot(at, figure=figure)


def _places(formula: Formula, recording: DomainTrace, explanation: Explanation) -> dict[str, list[list[Any]]]:
    """Return the places where predicates and variables of an implicant make a formula fail, by canonical text."""

    def place(time: Any) -> Any:
        return time if recording.domain.continuous else recording.position(time)

    if explanation.satisfied:
        return {}
    at = place(explanation.time)
    found: dict[str, list[list[Any]]] = {canonical(formula): [[at, at]]}
    for stretch in explanation.implicant:
        parts = dict.fromkeys([(stretch.formula, stretch.start, stretch.end)])
        parts.update(dict.fromkeys((Var(each.signal), each.start, each.end) for each in stretch.reads))
        for part, start, end in parts:
            where = [place(start), end if end is None else place(end)]
            found.setdefault(canonical(part), []).append(where)
    return found
