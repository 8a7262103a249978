"""The input and output of rules: a text, a rule, a finding."""

from __future__ import annotations

from collections import Counter, defaultdict
from functools import cached_property
from typing import TYPE_CHECKING

from rtamt.errors import caret
from rtamt.language.formula import Apply, postorder
from rtamt.language.parsing.lexer import tokenize, unquoted
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from fractions import Fraction

    from rtamt.language.document import Document, Severity
    from rtamt.language.formula import Formula, Span
    from rtamt.language.operators import Language, Operator
    from rtamt.language.parsing.lexer import Tokens
    from rtamt.language.units.check import UnitFinding
    from rtamt.lint.comparisons import Chain
    from rtamt.lint.ranges import Decided


class Edit(NamedTuple):
    """A change of a text: the characters of ``span`` are replaced by ``new``."""

    span: Span
    new: str = ""


@dataclass(frozen=True, slots=True)
class Fix:
    """The fix of a finding: the edits, the part of the formula that they change, and its replacement.

    The two formulas have the same robustness on every recording; :mod:`rtamt.lint.fix` compares what the new text
    means with this.
    """

    edits: tuple[Edit, ...]
    old: Apply
    new: Formula


class Found(NamedTuple):
    """A finding of a rule: its place, its message, and its fix, if there is one."""

    span: Span | None
    message: str
    fix: Fix | None = None


@dataclass(frozen=True, slots=True)
class Rule:
    """One kind of warning: its code, its summary, and the function that finds it in a text.

    ``why``: what is wrong with it, for its page. ``bad`` and ``good``: two specifications, of which the first has this
    finding and no other one, and the second has none.

    ``severity``: "error" for what is certainly a mistake, though the text is legal; "note" for what is not checked.
    """

    code: str
    about: str
    why: str
    bad: str
    good: str
    find: Callable[[Text], Iterable[Found]]
    severity: Severity = "warning"


@dataclass(frozen=True, slots=True)
class LintWarning:
    """A valid but probably unintended part of a specification; ``str()`` shows the line and a caret.

    ``severity``: "warning"; "error" for what is certainly a mistake, "note" for what is not checked. ``fix``: how
    ``rtamt lint --fix`` mends it, if it can.
    """

    code: str
    message: str
    text: str
    span: Span | None
    severity: Severity = "warning"
    fix: Fix | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        where = "" if self.span is None else f"\n{caret(self.text, self.span)}"
        return f"{self.code}: {self.message}{where}"


class Text:
    """A text as rules read it: its document, and every operator in its formulas once.

    ``period``: the sampling period, if it is known.
    """

    def __init__(self, document: Document, language: Language, period: Fraction | None) -> None:
        self.document = document
        self.language = language
        sampling = document.sampling
        self.period = sampling.period if period is None and sampling is not None else period
        #: Every part of the formulas, operands first, and the operators among them.
        self.parts = postorder(*(assertion.formula for assertion in document.assertions))
        self.nodes = [node for node in self.parts if isinstance(node, Apply)]

    @cached_property
    def by_operator(self) -> Mapping[Operator, list[Apply]]:
        """The operators of the text, by their records."""
        found: dict[Operator, list[Apply]] = defaultdict(list)
        for node in self.nodes:
            found[node.op].append(node)
        return found

    def of(self, operators: Iterable[Operator]) -> Iterator[Apply]:
        """Yield the uses of these operators."""
        for op in operators:
            yield from self.by_operator.get(op, ())

    @cached_property
    def unit_findings(self) -> tuple[UnitFinding, ...]:
        """The findings about units."""
        from rtamt.language.units.check import unit_findings

        return tuple(unit_findings(self.document))

    @cached_property
    def decided(self) -> Decided:
        """The findings that follow from declared ranges."""
        from rtamt.lint.ranges import Decided

        return Decided(self)

    @cached_property
    def chains(self) -> list[Chain]:
        """The chains of ``and`` and ``or`` that compare one number several times."""
        from rtamt.lint.comparisons import chains_of

        return chains_of(self)

    @cached_property
    def tokens(self) -> Tokens:
        """The tokens of the text."""
        return tokenize(self.document.text, self.language)

    @cached_property
    def names(self) -> Counter[str]:
        """The number of occurrences of each word of the text, outside comments."""
        return Counter(
            [unquoted(text) if text.startswith('"') and len(text) > 1 else text for text in self.tokens.texts]
        )

    def written(self, span: Span | None) -> str:
        """Return the characters of a span for a message, with single spaces."""
        return "this" if span is None else f"'{' '.join(self.document.text[span.start : span.end].split())}'"
