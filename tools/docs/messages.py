"""Collect the error messages in the source, including those completed by helper functions.

A function that makes an error out of a text it is given, such as ``header.error(line, "...")``, is a *maker*.
Its calls are found, and their texts put into its own.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

#: The classes of errors whose first argument is the message.
ERRORS = (
    "BoundError",
    "CommandError",
    "EvaluationError",
    "MisfitError",
    "NameInFormulaError",
    "ParseError",
    "RTAMTException",
    "STLParseException",
    "SpecificationError",
    "TraceError",
    "UsageError",
)
#: The parser's own method: it adds the place, and takes the class as its last argument.
PARSER = "error"

#: A place in a text for the argument of this name, and what marks a place whose text is a sentence's.
_HOLE = re.compile("\0(\\w+)\0")
#: Texts of one call at most: alternatives multiply.
_MOST = 16


@dataclass(frozen=True)
class Maker:
    """A function that returns or raises an error: its parameters without self, and the texts it makes."""

    kind: str
    parameters: tuple[str, ...]
    texts: tuple[str, ...]


#: The class (or the module, for a plain function) and the name of a maker.
Place = tuple[str, str]


@dataclass(frozen=True)
class Where:
    """Where an expression stands: its module, the names that are imported there, its class and function."""

    stem: str
    imports: Mapping[str, str]
    owner: str
    function: ast.FunctionDef
    constants: Mapping[str, str]

    @property
    def parameters(self) -> dict[str, str]:
        """The parameters of the function, each with its annotation."""
        return {a.arg: _called(a.annotation) if a.annotation else "" for a in self.function.args.args}


def by_kind(source: Path) -> dict[str, list[str]]:
    """Return the messages of each class of errors, sorted."""
    places = list(_places(source))
    makers: dict[Place, Maker] = {}
    for _ in range(3):  # makers that call makers
        makers = dict(made for where in places for made in _makers(where, makers))
    found: dict[str, set[str]] = defaultdict(set)
    filled: set[str] = set()
    bare: set[str] = set()
    for where in places:
        for node in ast.walk(where.function):
            for kind, texts, templates in _call(node, where, makers):
                found[kind].update(texts)
                filled.update(templates)
                maker = makers.get(_place(node, where, makers))
                bare.update(set(texts) & set(maker.texts) if maker else ())
    return {
        kind: sorted(
            {_shown(text) for text in texts - (filled - bare) if re.search("[a-z]{3}", text)}, key=str.lower
        )
        for kind, texts in sorted(found.items())
        if texts
    }


def _places(source: Path) -> Iterator[Where]:
    """Yield every function, alone or of a class."""
    trees = [
        (path.stem, ast.parse(path.read_text(encoding="utf-8"))) for path in sorted(source.rglob("*.py"))
    ]
    constants = {name: text for _, tree in trees for name, text in _constants(tree)}
    for stem, tree in trees:
        imports = {
            name.name: (node.module or "").rpartition(".")[2]
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom)
            for name in node.names
        }
        for node in tree.body:
            inside = node.body if isinstance(node, ast.ClassDef) else [node]
            owner = node.name if isinstance(node, ast.ClassDef) else stem
            yield from (
                Where(stem, imports, owner, f, constants) for f in inside if isinstance(f, ast.FunctionDef)
            )


# ---- makers --------------------------------------------------------------------------------------


def _makers(where: Where, known: Mapping[Place, Maker]) -> Iterator[tuple[Place, Maker]]:
    parameters = tuple(name for name in where.parameters if name not in ("self", "cls"))
    for node in ast.walk(where.function):
        value = (
            node.value if isinstance(node, ast.Return) else node.exc if isinstance(node, ast.Raise) else None
        )
        for kind, texts, _ in _call(value, where, known):
            open_ = tuple(text for text in texts if set(_HOLE.findall(text)) & set(parameters))
            if open_:
                yield (where.owner, where.function.name), Maker(kind, parameters, open_)


def _call(
    node: ast.AST | None, where: Where, makers: Mapping[Place, Maker]
) -> Iterator[tuple[str, list[str], list[str]]]:
    """Yield the class of the error that a call makes, its texts, and those of the maker that it fills."""
    if not isinstance(node, ast.Call):
        return
    name = _called(node.func)
    maker = makers.get(_place(node, where, makers))
    if maker is not None:
        given = dict(zip(maker.parameters, node.args, strict=False))
        given |= {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
        choices = {p: [t for t in _texts(v, where) if " " in t.strip()] for p, v in given.items()}
        known = {parameter: texts for parameter, texts in choices.items() if texts}
        texts = [
            _filled(t, dict(zip(known, c, strict=True)))
            for t in maker.texts
            for c in product(*known.values())
        ]
        yield maker.kind, texts[:_MOST], [t for t in maker.texts if set(_HOLE.findall(t)) & set(known)]
    elif node.args and (name in ERRORS or name == PARSER):
        last = _called(node.args[-1])
        kind = last if last in ERRORS else name if name in ERRORS else "ParseError"
        yield kind, _texts(node.args[0], where), []


def _place(node: ast.AST, where: Where, makers: Mapping[Place, Maker]) -> Place:
    """Return what is called: of this class, of this or another module, or of a class called as a variable is."""
    func = node.func if isinstance(node, ast.Call) else None
    if isinstance(func, ast.Name):
        return where.imports.get(func.id, where.stem), func.id
    if not isinstance(func, ast.Attribute):
        return "", ""
    receiver = _called(func.value)
    if receiver == "self":
        return where.owner, func.attr
    if where.parameters.get(receiver):
        return where.parameters[receiver], func.attr
    alike = receiver.strip("_").lower()
    owners = (
        owner for owner, name in makers if name == func.attr and owner.lower().strip("_").endswith(alike)
    )
    return next(owners, ""), func.attr


# ---- texts ---------------------------------------------------------------------------------------


def _texts(node: ast.expr, where: Where) -> list[str]:
    """Return the texts that an expression may be; none where it is no text that is written there."""
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) else []
    if isinstance(node, ast.JoinedStr):
        parts = [_part(part, where) for part in node.values]
        return ["".join(choice) for choice in product(*parts)][:_MOST]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        sides = [_texts(side, where) or ["\0…\0"] for side in (node.left, node.right)]
        return ["".join(choice) for choice in product(*sides)]
    if isinstance(node, ast.IfExp):
        return [*_texts(node.body, where), *_texts(node.orelse, where)]
    if isinstance(node, ast.Name):
        if node.id in where.parameters:
            return [f"\0{node.id}\0"]
        if node.id in where.constants:
            return [where.constants[node.id]]
        return [text for value in _assigned(node.id, where.function) for text in _texts(value, where)]
    return []


def _part(node: ast.expr, where: Where) -> Sequence[str]:
    if isinstance(node, ast.Constant):
        return [str(node.value)]
    assert isinstance(node, ast.FormattedValue)
    value = node.value
    name = _called(value) if isinstance(value, (ast.Name, ast.Attribute)) else "…"
    alternatives = isinstance(value, ast.IfExp) or (
        isinstance(value, ast.Name) and value.id not in where.parameters
    )
    known = _texts(value, where) if alternatives else []
    phrases = [text for text in known if text.count(" ") > 2]
    return known if phrases and len(known) <= 3 else [f"\0{name}\0"]


def _assigned(name: str, function: ast.FunctionDef) -> Iterator[ast.expr]:
    for node in ast.walk(function):
        assigned = isinstance(node, ast.Assign) and name in map(_called, node.targets)
        if assigned and name not in map(_called, ast.walk(node.value)):
            yield node.value


def _constants(tree: ast.Module) -> Iterator[tuple[str, str]]:
    for node in tree.body:
        if (
            isinstance(node, ast.Assign)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            for target in node.targets:
                if isinstance(target, ast.Name) and target.id.isupper():
                    yield target.id, node.value.value


def _called(func: ast.AST) -> str:
    if isinstance(func, ast.Attribute):
        return func.attr
    return func.id if isinstance(func, ast.Name) else ""


def _filled(text: str, given: Mapping[str, str]) -> str:
    return _HOLE.sub(lambda hole: given.get(hole[1], hole[0]), text)


def _shown(text: str) -> str:
    """Return a text for a page, with what differs from case to case in brackets."""
    for character in "\\`*_[]<>|#":
        text = text.replace(character, f"\\{character}")
    return re.sub("\0([^\0]+)\0", lambda hole: f"⟨{hole[1]}⟩".replace("\\_", "_"), text.replace("\n", " "))
