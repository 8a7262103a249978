"""Parse the part of a specification file before its formulas: header, declarations, annotations."""

from __future__ import annotations

from itertools import pairwise
from math import inf
from types import MappingProxyType

from rtamt.errors import NameInFormulaError, did_you_mean
from rtamt.language.document import Declaration
from rtamt.language.formula import Span
from rtamt.language.lazy_modules import enumerations, ranges, tables
from rtamt.language.operators import Fixity
from rtamt.language.parsing.grammar import INFINITY
from rtamt.language.parsing.import_parser import ImportParser
from rtamt.language.parsing.lexer import Token, is_name, quoted
from rtamt.language.parsing.scope import Scope
from rtamt.language.parsing.statements import begins_enumeration, begins_table
from rtamt.language.quantifiers import begins_quantifier
from rtamt.language.value_types import BOOLEAN, WHOLE, Enumeration
from rtamt.lazy.typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.language.value_types import ValueType

#: The types that need no import.
TYPES = ("float", "int", "long", "complex", "bool")

#: The types of parameters, besides enumerations.
_SET_LATER = ("float", *WHOLE, "bool")

_Kind = Literal["var", "const", "parameter"]

#: The words of declarations that give a value, and what errors call the kinds of declarations.
_KINDS: Mapping[str, _Kind] = MappingProxyType({"const": "const", "parameter": "parameter"})
_CALLED = MappingProxyType({"var": "variable", "const": "constant", "parameter": "parameter"})

#: The first characters of tokens that no unit has: what closes it, and what follows one that is not closed.
_BEHIND_UNIT = ("]", "", '"', "[", ";", "=")

ROLES: Mapping[str, Literal["input", "output"]] = MappingProxyType({"input": "input", "output": "output"})


class DeclarationParser(ImportParser):
    """The grammar productions of declarations, in addition to those of imports."""

    def _header(self) -> str | None:
        """``header = "specification" , word``."""
        if not (self._word("specification") and self._plain_name(1)):
            return None
        self.next()
        name = self.next().text
        self.accept(";")
        return name

    def _enumeration(self) -> bool:
        """Take the declaration of an enumeration, if there is one here."""
        if not begins_enumeration(self):
            return False
        known = enumerations.parse_enumeration(self, (*TYPES, *self._imports, *self._enumerations))
        self._enumerations[known.name] = known
        return True

    def _table(self) -> bool:
        """Take the declaration of a table, if there is one here."""
        if not begins_table(self):
            return False
        token = self._at(1)
        table = tables.parse_table(self)
        if self._is_taken(table.name):
            raise self.error(f"'{table.name}' is declared twice{self._from(table.name)}", token.span)
        self._tables[table.name] = table
        return True

    def _is_taken(self, name: str) -> bool:
        """Return whether a text declares or defines a name."""
        declared = name in self._declarations or name in self._given
        return declared or name in self._constants or self._is_defined(name)

    def _is_defined(self, name: str) -> bool:
        """Return whether a text defines a name: that of a formula, a template, a table or a group."""
        return any(
            name in known for known in (self._tables, self._definitions, self._templates, self._groups)
        )

    def _scope(self, variables: Collection[str] | None, pending: Mapping[str, str] | None = None) -> Scope:
        """Return the meanings of names so far."""
        return Scope(
            self._constants,
            self._definitions,
            variables,
            pending or {},
            self._templates,
            self._unknown,
            parameters=self._parameters,
            types=self._types,
            enumerations=self._enumerations,
            tables=self._tables,
            groups=self._groups,
            units=self._units,
        )

    def _declaration(self) -> bool:
        """``declaration = ( [ "optional" ] , [ role ] , type , name | kind , type , name , "=" , value ) , ...``."""
        if not self._declares():
            return False
        optional = self._is_optional()
        if optional:
            self.next()
            if self.token.text in _KINDS:
                raise self.error(
                    f"only variables are optional: a {_CALLED[_KINDS[self.token.text]]} is not recorded",
                    self.tokens[self.index - 1].span,
                )
        kind: _Kind = "var"
        role = None
        if self._plain_type(1) and self.token.text not in self._imports:
            kind = _KINDS.get(self.token.text, "var")
            role = ROLES.get(self.token.text)
        if kind != "var" or role:
            self.next()
        type_name = self.next()
        if not self._is_type(type_name):
            later = {name for word, name in pairwise(self.texts[self.index :]) if word == "enum"}
            if type_name.text in later:
                raise self.error(
                    f"'{type_name.text}' is declared further on; declare an enumeration before its variables",
                    type_name.span,
                )
            types = (*TYPES, *self._enumerations, *self._imports)
            hint = did_you_mean(type_name.text, (*types, *later))
            raise self.error(
                f"'{type_name.text}' is not a type{hint or '; types are ' + ', '.join(types[:20])}"
                f"{'' if hint else ', and classes that are imported'}",
                type_name.span,
            )
        if kind == "parameter" and type_name.text not in (*_SET_LATER, *self._enumerations):
            raise self.error(
                f"a parameter is a number, a Boolean or a member of an enumeration, not '{type_name.text}'; "
                f"choose from {', '.join((*_SET_LATER, *self._enumerations))}",
                type_name.span,
            )
        name = self._take_name(f"the name of a {_CALLED[kind]}", quotes=True)
        name = self._with_slashes(name)
        self._declare(name, type_name.text, role, kind, optional)
        self.accept(";")
        return True

    def _declare(
        self,
        token: Token,
        type_name: str,
        role: Literal["input", "output"] | None,
        kind: _Kind,
        optional: bool,
    ) -> None:
        name, constant = token.name, kind != "var"
        self._check_nameable(token)
        head = name.split(".", 1)[0]
        type_ = self._type(type_name)
        message = head in self._declarations and self._declarations[head].type in self._imports
        if head != name and head in self._declarations and not (message and type_ is not None):
            raise self.error(f"'{name}' is a field of '{head}', which is declared", token.span)
        taken = any(name in e for e in (self._declarations, self._constants, self._tables, self._groups))
        if taken or (constant and name in self._given):
            raise self.error(f"'{name}' is declared twice{self._from(name)}", token.span)
        value: float | None = None
        columns: tuple[str, ...] = ()
        unit = "" if constant else self._unit(token)
        numeric = type_ is None and type_name in TYPES
        range_ = None if constant else ranges.parse_range(self, name, number=numeric)
        rate = None if constant else ranges.parse_rate(self, name, number=numeric)
        if not constant and self.accept("="):
            columns = self._columns(name, type_name)
        elif self.accept("="):
            start = self.token.start
            value = self._value(type_)
            if kind == "parameter" and type_name in WHOLE and not value.is_integer():
                span = Span(start, self.tokens[self.index - 1].end)
                written = self.text[span.start : span.end]
                raise self.error(
                    f"'{name}' is {written}, and declared as a whole number; declare it as float", span
                )
            self._constants[name] = value
            if kind == "parameter":
                self._constants[name] = self._values.get(name, value)
                self._parameters.add(name)
        elif constant:
            raise self.error(
                f"the {_CALLED[kind]} '{name}' has no value; write {kind} {type_name} {name} = ...",
                token.span,
            )
        if type_ is not None:
            self._types[name] = type_
        unit = unit or self._unit(token)
        self._add_declarations(
            Declaration(name, type_name, kind, role, value, unit, columns, optional, range_, rate, token.span)
        )

    def _columns(self, name: str, type_name: str) -> tuple[str, ...]:
        """``column , { "or" , column }``: the recorded names of a variable, of a message its topic."""
        found = [self._column(name)]
        while self.token.text == "or" and self._at(1).kind == "quoted":
            token = self.next()
            if type_name in self._imports:
                raise self.error(f"'{name}' is a message, which has one topic", token.span)
            span = self.token.span
            column = self._column(name)
            if column in found:
                raise self.error(f"the recorded name '{column}' is given twice", span)
            found.append(column)
        if type_name not in self._imports:
            return tuple(found)
        (self._topics[name],) = found
        return ()

    def _column(self, name: str) -> str:
        """``'"' , characters , '"'``: a recorded name."""
        token = self.token
        if token.kind != "quoted":
            raise self.error(
                f"a variable has no value of its own; define it after the declarations: {name} = ..., "
                f'or give its recorded name in quotes: {name} = "..."',
                self.tokens[self.index - 1].span,
            )
        self.next()
        if not token.name.strip() or not token.name.isprintable():
            raise self.error("a recorded name is one line of visible characters", token.span)
        if self.token.text == "[":
            raise self.error(
                f"the unit stands before the recorded name: {name} [...] = {token.text}", self.token.span
            )
        return token.name

    def _unit(self, name: Token) -> str:
        """``[ "[" , unit , "]" ]``: the unit of what is called ``name``, "" where none is written."""
        opening = self.token
        if opening.text != "[":
            return ""
        start = self.next().end
        while self.token.text[:1] not in _BEHIND_UNIT and not self._begins_a_line(self.index):
            self.next()
        unit = self.text[start : self.token.start].strip()
        if unit.isdigit() and opening.start == name.end:
            whole = f"{name.name}[{unit}]"
            raise self.error(
                f"'{unit}' is not a unit; a name with brackets is written in quotes: {quoted(whole)}",
                Span(name.start, self.token.end),
            )
        if not unit or not self.accept("]"):
            raise self.error(f"expected a unit and ']' after '{name.name} [', such as [m/s]", opening.span)
        return unit

    def _type(self, name: str) -> ValueType | None:
        """Return the type that is called so; None for numbers."""
        if name == BOOLEAN.name and self._truths:
            return BOOLEAN
        return self._enumerations.get(name)

    def _value(self, type_: ValueType | None) -> float:
        """``value = [ "-" ] , number | "-inf" | "inf" | member | "true" | "false"``."""
        token = self.token
        if isinstance(type_, Enumeration):
            code = type_.code(token.name.removeprefix(f"{type_.name}."))
            if code is None:
                raise self.error(type_.lacks(token.name), token.span, NameInFormulaError)
            self.next()
            return float(code)
        if type_ is not None and token.text in ("true", "false"):
            return float(self.next().text == "true")
        number = self.signed_number()
        if type_ is not None and number not in (0.0, 1.0):
            raise self.error(f"a bool is true or false (1 or 0), got {token}", token.span)
        return number

    def signed_number(self) -> float:
        """``[ "-" ] , ( number | "inf" )``."""
        minus = self.accept("-")
        if self.token.kind == "number":
            value = self.number().value
        elif self.accept(INFINITY):
            value = inf
        else:
            raise self._expected_error("a number")
        return -value if minus else value

    def _annotation(self) -> bool:
        """``annotation = "@" , "topic" , "(" , name , "," , topic , ")" , [ ";" ]``."""
        if not self.accept("@"):
            return False
        kind = self.next()
        if kind.text != "topic":
            raise self.error(f"expected 'topic' after '@', got {kind}", kind.span)
        if not self.accept("("):
            raise self._expected_error("'(' after '@ topic'")
        token = self._take_name("the name of a variable", quotes=True)
        name = token.name
        declared = self._declarations.get(name)
        if name not in self._given and (declared is None or declared.kind != "var"):
            known = [*self._given, *(d.name for d in self._declarations.values() if d.kind == "var")]
            hint = did_you_mean(name, known) or "; declare it before its topic"
            raise self.error(f"'{name}' is not a declared variable{hint}", token.span, NameInFormulaError)
        if name in self._topics:
            raise self.error(f"'{name}' has two topics", token.span)
        if not self.accept(","):
            raise self._expected_error(f"',' after '{name}'")
        self._topics[name] = self._topic()
        if not self.accept(")"):
            raise self._expected_error("')' after the topic")
        self.accept(";")
        return True

    def _topic(self) -> str:
        """``topic``: characters without spaces, up to the parenthesis."""
        first = self.token
        end = first.start
        while self.token.text not in (")", "") and self.token.start == end:
            end = self.next().end
        if end == first.start:
            raise self._expected_error("the name of a topic")
        return self.text[first.start : end]

    # ---- lookahead -------------------------------------------------------------------------------

    def _is_type(self, token: Token) -> bool:
        return token.text in TYPES or token.text in self._imports or token.text in self._enumerations

    def _plain_type(self, ahead: int) -> bool:
        """Return whether a type and a name follow at this offset; the name may be ``S``, the type may not."""
        typed = self._is_type(self._at(ahead)) or self._plain_name(ahead)
        return typed and self._at(ahead).kind == "name" and self._at(ahead + 1).kind in ("name", "quoted")

    def _declares(self) -> bool:
        """Return whether a declaration begins here, of a known or unknown type."""
        if not is_name(self.texts[self.index]):
            return False
        first = self.token
        if self._requires() or self._imports_file() or begins_quantifier(self):
            return False
        if self._is_optional() or ((first.text in ROLES or first.text in _KINDS) and self._plain_type(1)):
            return True
        if self._is_type(first):
            return self._at(1).kind in ("name", "quoted")
        # Two names in a row are a declaration of unknown type if no formula could continue after them.
        if self._opening(first.text) is not None or not (self._plain_name(1) and self._plain_name(0)):
            return False
        third = self._at(2)
        types = (*TYPES, *self._enumerations, *self._imports)
        if third.text in (";", "[", "") and did_you_mean(first.text, types):
            return True
        return third.text in ("@", "=") or (third.kind == "name" and self.language.infix(third.text) is None)

    def _is_optional(self) -> bool:
        """Return whether the declaration of a variable that recordings may lack begins here."""
        if not self._word("optional") or "optional" in self._imports or "optional" in self._enumerations:
            return False
        role = self._at(1).text in (*ROLES, *_KINDS) and self._plain_type(2)
        return role or (self._is_type(self._at(1)) and self._plain_type(1))

    def _with_slashes(self, token: Token) -> Token:
        """Consume a slash and a name that directly follow a name: ``robot/speed`` is one name."""
        while token.kind == "name" and self.token.text == "/" and self._at(1).kind == "name":
            slash, tail = self.token, self._at(1)
            if slash.start != token.end or tail.start != slash.end:
                break
            self.next()
            self.next()
            token = Token("name", f"{token.text}/{tail.text}", token.start, tail.end)
        return token

    # ---- names -----------------------------------------------------------------------------------

    def _check_nameable(self, token: Token) -> None:
        op = self.language.opening(token.text)
        if op is not None and op.fixity is Fixity.ATOM:
            raise self.error(f"'{token.text}' is a word of the language and cannot be a name", token.span)
