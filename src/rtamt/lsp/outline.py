"""The names of a text: what declares them, where they are used. It reads tokens, so that wrong texts have it, too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.declarations import ROLES, TYPES
from rtamt.language.parsing.lexer import is_name, is_numeral, is_quoted, unquoted
from rtamt.language.parsing.requirements import ID
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units.durations import UNITS
from rtamt.lsp.symbols import Symbol
from rtamt.lsp.tokens import CLOSING, OPENING
from rtamt.lsp.uses import UseReader

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.document import Document
    from rtamt.lsp.symbols import Outline

_READERS = frozenset("specification from import enum table group input output def require sample".split())


def outline(text: str, document: Document | None = None) -> Outline:
    """Return the names of a text; of one that has been parsed, the exact ends of its templates.

    >>> found = outline("float v  const float most = 3;  fast = v > most;  always(not fast)")
    >>> [(each.kind, each.name, len(found.uses_of(each))) for each in found.symbols]
    [('variable', 'v', 2), ('constant', 'most', 2), ('formula', 'fast', 2)]
    """
    return _Reader(text, document).read()


class _Reader(UseReader):
    """A position in the tokens of a text."""

    def __init__(self, text: str, document: Document | None) -> None:
        super().__init__(text, document)
        self.types = set(TYPES)
        self.classes: set[str] = set()  # imported ones
        templates = {} if document is None else document.templates
        self.template_ends: Mapping[str, int] = {
            name: each.tokens.ends[-1] for name, each in templates.items() if each.text == text
        }

    def read(self) -> Outline:
        """Return the names."""
        at = depth = 0
        calls: list[str] = []
        while at < self.count:
            text = self.texts[at]
            if text in OPENING:
                calls.append(self.texts[at - 1] if at else "")
                depth += 1
            elif text in CLOSING:
                depth -= depth > 0
                if calls:
                    calls.pop()
            if at not in self.taken and is_name(text):
                after = self._declaration(at) if depth == 0 else self._inside(at, calls)
                at = max(after, at + 1)
            elif text == "@":
                at = self._topic(at)
            elif is_quoted(text) and depth == 0 and self.defines(at):
                at = self._formula(at, at)
            else:
                at += 1
        self.resolve()
        return self.found

    # ---- declarations: each returns the index behind what it has read ------------------------------

    def _declaration(self, at: int) -> int:
        text, after = self.texts[at], self.text_at(at + 1)
        reader = getattr(self, f"_{text}", None) if text in _READERS else None
        end: int = reader(at) if reader is not None else 0
        if end:
            return end
        if text in QUANTIFIERS and is_name(after) and self.text_at(at + 2) == "in":
            return self._quantifier(at)
        begin = at
        if text == "optional" and (after in ROLES or after in self.types):
            at += 1
        if self.texts[at] in (*ROLES, "const", "parameter") and self.text_at(at + 1) in self.types:
            at += 1
        if self.texts[at] in self.types and self._is_declared(at + 1):
            return self._read_typed(begin, at)
        last = self.path(at)
        if self.text_at(last + 1) == "=" and self.defines(begin):
            return self._formula(begin, last)
        return 0

    def _is_declared(self, at: int) -> bool:
        text = self.text_at(at)
        return is_quoted(text) or (is_name(text) and STL.infix(text) is None)

    def _read_typed(self, begin: int, at: int) -> int:
        """Read a variable, a constant or a parameter, whose type is at ``at``."""
        kinds = {"const": "constant", "parameter": "parameter"}
        kind = kinds.get(self.texts[at - 1] if at > begin else "", "variable")
        for word in range(begin, at):
            self.mark(word, "keyword")
        self.mark_type(at)
        first, last = at + 1, self.path(at + 1)
        end, recorded = self._rest(last + 1, kind)
        symbol = self.declare(first, last, kind, begin, end - 1)
        if kind == "variable" and not recorded and self.texts[at] not in self.classes:
            self.found.ends[symbol] = self.ends[end - 1]
        return end

    def _rest(self, at: int, kind: str) -> tuple[int, bool]:
        """Read the unit, the range, the rate, and the recorded names or the value of a declaration."""
        at = self._unit(at)
        while kind == "variable" and self.text_at(at) in ("in", "rate") and self.text_at(at + 1) == "[":
            self.mark(at, "keyword")
            at = self.closing(at + 1) + 1
        recorded = False
        if self.text_at(at) == "=" and kind != "variable":
            at += 2 + (self.text_at(at + 1) == "-")
            at = self._unit(at)
        elif self.text_at(at) == "=" and is_quoted(self.text_at(at + 1)):
            while self.text_at(at) in ("=", "or") and is_quoted(self.text_at(at + 1)):
                self.quote(at + 1, "column")
                at, recorded = at + 2, True
        return min(at, self.count), recorded

    def _unit(self, at: int) -> int:
        if self.text_at(at) != "[":
            return at
        end = self.closing(at)
        for inside in range(at + 1, end):
            self.mark(inside, "unit")
        return end + 1

    def _formula(self, begin: int, last: int) -> int:
        self.declare(begin, last, "formula", begin, last + 1)
        return last + 2

    def _specification(self, at: int) -> int:
        if at or not is_name(self.text_at(1)):
            return 0
        self.mark(0, "keyword")
        self.taken.add(1)
        return 2

    def _from(self, at: int) -> int:
        if self.text_at(at + 2) != "import" or not is_name(self.text_at(at + 3)):
            return 0
        for word in (at, at + 2):
            self.mark(word, "keyword")
        self.mark(at + 1, "class")
        self.declare(at + 3, at + 3, "class", at, at + 3)
        self.types.add(self.texts[at + 3])
        self.classes.add(self.texts[at + 3])
        return at + 4

    def _import(self, at: int) -> int:
        if not is_quoted(self.text_at(at + 1)):
            return 0
        self.mark(at, "keyword")
        self.quote(at + 1, "import")
        return at + 2

    def _enum(self, at: int) -> int:
        if self.text_at(at + 2) != "{":
            return 0
        self.mark(at, "keyword")
        end = self.closing(at + 2)
        name = self.texts[at + 1]
        self.declare(at + 1, at + 1, "enumeration", at, end)
        self.types.add(name)
        for inside in range(at + 3, end):
            if self.texts[inside - 1] in ("{", ",") and (
                is_name(self.texts[inside]) or is_quoted(self.texts[inside])
            ):
                self.declare(inside, inside, "value", at, end, of=name)
        return end + 1

    def _table(self, at: int) -> int:
        if self.text_at(at + 2) != "=" or self.text_at(at + 3) != "{":
            return 0
        self.mark(at, "keyword")
        end = self.closing(at + 3)
        self.declare(at + 1, at + 1, "table", at, end)
        return end + 1

    def _group(self, at: int) -> int:
        name = self.text_at(at + 1)
        if not is_name(name) or self.text_at(at + 2) != "=" or not is_quoted(self.text_at(at + 3)):
            return 0
        self.mark(at, "keyword")
        self.quote(at + 3, "pattern")
        end = self.closing(at + 4) if self.text_at(at + 4) == "{" else at + 3
        self.declare(at + 1, at + 1, "group", at, end)
        inside = at + 5
        while inside < end:
            if self.texts[inside] in self.types and self._is_declared(inside + 1):
                self.mark_type(inside)
                symbol = self.declare(inside + 1, inside + 1, "field", inside, inside + 1, of=name)
                inside = self._unit(inside + 2)
                if self.text_at(inside) == "=" and is_quoted(self.text_at(inside + 1)):
                    self.quote(inside + 1, "column")
                else:
                    self.found.ends[symbol] = self.ends[inside - 1]
            else:
                inside += 1
        return end + 1

    def _input(self, at: int) -> int:
        if self.text_at(at + 1) != "group":
            return 0
        end = self._group(at + 1)
        if end:
            self.mark(at, "keyword")
        return end

    _output = _input

    def _def(self, at: int) -> int:
        if self.text_at(at + 2) != "(" or not is_name(self.text_at(at + 1)):
            return 0
        self.mark(at, "keyword")
        name = self.texts[at + 1]
        closing = self.closing(at + 2)
        body = closing + 2
        end = self.template_ends.get(name) or self._statement_end(body)
        self.declare(at + 1, at + 1, "template", at, max(closing, self.token_before(end)))
        scope = Span(self.starts[at + 2], end)
        for inside in range(at + 3, closing):
            if self.texts[inside - 1] in ("(", ",") and is_name(self.texts[inside]):
                self.declare(inside, inside, "argument", inside, inside, scope=scope, of=name)
        return body

    def _require(self, at: int) -> int:
        after = self.text_at(at + 1)
        if not (is_quoted(after) or after[:1].isalnum() or after[:1] == "_") or self.text_at(at + 2) == "=":
            return 0
        begin, behind = self.starts[at + 1], at + 2
        end = self.ends[at + 1]
        if not is_quoted(after):
            match = ID.match(self.text, begin)
            end = match.end() if match else end
            while behind < self.count and self.starts[behind] < end:
                behind += 1
        ahead = behind + is_quoted(self.text_at(behind))
        ahead += 2 * (self.text_at(ahead) == "severity")
        if self.text_at(ahead) != ":":
            return 0
        self.mark(at, "keyword")
        self.taken.update(range(at + 1, behind))
        if is_quoted(self.text_at(behind)):
            self.quote(behind, "description")
        for word in range(behind, ahead):
            if word not in self.taken:
                self.mark(word, "keyword")
        name = unquoted(after) if is_quoted(after) else self.text[begin:end]
        self.add(Symbol(name, "requirement", Span(begin, end), Span(self.starts[at], end), self.everywhere))
        return ahead + 1

    def _sample(self, at: int) -> int:
        if not is_numeral(self.text_at(at + 1)):
            return 0
        self.mark(at, "keyword")
        at += 2
        while (
            self.text_at(at) in ("/", "hold", "for", "skip", "nan", *UNITS) or self.text_at(at)[:1].isdigit()
        ):
            if is_name(self.texts[at]):
                self.mark(at, "unit" if self.texts[at] in UNITS else "keyword")
            at += 1
        return at

    def _topic(self, at: int) -> int:
        if self.text_at(at + 1) != "topic" or self.text_at(at + 2) != "(":
            return at + 1
        self.mark(at + 1, "keyword")
        end = self.closing(at + 2)
        for inside in range(self.path(at + 3) + 2, end):
            self.mark(inside, "topic")
        return at + 3

    # ---- inside formulas ---------------------------------------------------------------------------

    def _inside(self, at: int, calls: list[str]) -> int:
        if self.texts[at] in QUANTIFIERS and is_name(self.text_at(at + 1)) and self.text_at(at + 2) == "in":
            return self._quantifier(at)
        if self.text_at(at + 1) == "=" and self.texts[at - 1] in ("(", ",") and calls:
            self.taken.add(at)
            self.named_arguments.append((at, calls[-1]))
        return 0

    def _quantifier(self, at: int) -> int:
        for word in (at, at + 2):
            self.mark(word, "keyword")
        end, depth = at + 3, 0
        while end < self.count:
            depth += (self.texts[end] in OPENING) - (self.texts[end] in CLOSING)
            if depth < 0 or (depth == 0 and self._begins_statement(end)):
                break
            end += 1
        scope = Span(self.starts[at + 1], self.ends[end - 1])
        self.declare(at + 1, at + 1, "member", at, at + 3, scope=scope, of=self.text_at(at + 3))
        if self.text_at(at + 4) == "where":
            self.mark(at + 4, "keyword")
        return at + 3

    def _statement_end(self, at: int) -> int:
        while at < self.count and not self._begins_statement(at):
            at += 1
        return self.ends[min(at, self.count) - 1]

    def _begins_statement(self, at: int) -> bool:
        """Return whether a statement ends before this token: at a semicolon, a name and "=", or a word at a line."""
        text = self.texts[at]
        if text == ";":
            return True
        if not self.begins_line(at) or not (is_name(text) or is_quoted(text)):
            return False
        return text in ("def", "require") or self.text_at(self.path(at) + 1) == "="
