"""Parse the declaration of a group of signals: its pattern, and the fields of its members."""

from __future__ import annotations

from rtamt.errors import choices
from rtamt.language.formula import Span
from rtamt.language.parsing.declarations import ROLES, TYPES, DeclarationParser
from rtamt.language.parsing.lexer import quoted
from rtamt.language.parsing.statements import begins_group
from rtamt.language.quantifiers import Field, Group, unquoted_pattern


class GroupParser(DeclarationParser):
    """The grammar productions of groups, in addition to those of other declarations."""

    def _group(self) -> bool:
        """Take the declaration of a group of signals, if there is one here."""
        if "group" in self._imports:
            return False
        if not begins_group(self):
            unquoted = unquoted_pattern(self)
            if unquoted is not None:
                written = quoted(self.text[unquoted.start : unquoted.end])
                raise self.error(f"the pattern of a group is written in double quotes: {written}", unquoted)
            return False
        role = ROLES.get(self.token.text)
        if role:
            self.next()
        self.next()
        name = self.next()
        if "." in name.text:
            raise self.error(f"the name of a group is one word, and '{name.text}' has a dot", name.span)
        if self._is_taken(name.text):
            raise self.error(f"'{name.text}' is declared twice{self._from(name.text)}", name.span)
        self.next()
        pattern = self.next()
        if pattern.name.count("*") != 1 or not pattern.name.isprintable():
            raise self.error(
                f"the pattern of a group has one star, which stands for the name of a member, such as "
                f'"{name.text}_*"; got {pattern}',
                pattern.span,
            )
        fields = self._fields(name.text) if self.token.text == "{" else ()
        self.accept(";")
        span = Span(name.start, pattern.end)
        self._groups[name.text] = Group(name.text, pattern.name, fields, role, span)
        return True

    def _fields(self, group: str) -> tuple[Field, ...]:
        """``"{" , { type , name , [ "[" , unit , "]" ] , [ "=" , recorded name ] , [ ";" ] } , "}"``."""
        opening = self.next()
        found: dict[str, Field] = {}
        while not self.accept("}"):
            type_name = self.next()
            if type_name.kind == "end":
                raise self.error("this '{' is never closed", opening.span)
            if type_name.text not in TYPES and type_name.text not in self._enumerations:
                types = (*TYPES, *self._enumerations)
                raise self.error(
                    f"expected the type of a field of '{group}', got {type_name}"
                    f"{choices(type_name.text, types, 'types')}",
                    type_name.span,
                )
            token = self._take_name(f"the name of a field of '{group}'", quotes=True)
            if token.name in found:
                raise self.error(f"'{group}' has two fields called '{token.name}'", token.span)
            unit = self._unit(token)
            recorded = self._recorded(group, token.name) if self.accept("=") else token.name
            if recorded in [each.name for each in found.values()]:
                raise self.error(f"two fields of '{group}' are recorded as '{recorded}'", token.span)
            called = "" if recorded == token.name else token.name
            found[token.name] = Field(recorded, type_name.text, self._type(type_name.text), unit, called)
            self.accept(";")
        if not found:
            raise self.error(
                f"the braces of '{group}' are empty; declare its fields, such as {{ float x [m] }}, or leave "
                f"them out: its fields are then those that formulas read",
                opening.span,
            )
        return tuple(found.values())

    def _recorded(self, group: str, field: str) -> str:
        """Take the recorded name of a field."""
        token = self.next()
        if token.kind != "quoted" or not token.name.strip() or not token.name.isprintable():
            raise self.error(
                f"expected the recorded name of '{field}', what follows the member of '{group}', in double quotes, "
                f'such as "pose.x"; got {token}',
                token.span,
            )
        return token.name
