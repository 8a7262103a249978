"""The names of a text without its parser: those that the parser finds, in every file of the package."""

from pathlib import Path

import pytest

from rtamt.errors import SpecificationError
from rtamt.language.parsing.imports import PACKAGED, Library
from rtamt.language.parsing.specfile import parse_document
from rtamt.lsp.outline import outline

ROOT = Path(__file__).parents[3]
FILES = sorted([*Path(PACKAGED).rglob("*.stl"), *(ROOT / "examples").rglob("*.stl")])


def parsed(path):
    text = path.read_text(encoding="utf-8")
    library = Library(str(path.parent))
    try:
        return text, parse_document(text, library=library)
    except SpecificationError:
        return text, parse_document(f"{text}\ntrue", library=library)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_declared_names_are_those_of_the_parser(path):
    text, document = parsed(path)
    for known in (document, None):
        found = outline(text, known)

        def named(*kinds, found=found):
            return {each.name for each in found.symbols if each.kind in kinds}

        required = {each.name for each in document.requirements if each.explicit}
        assert named("variable", "constant", "parameter") == {each.name for each in document.declarations}
        assert named("requirement") == required
        assert named("formula") == {each.name for each in document.assertions if each.name} - required
        assert named("template") == {
            name for name, each in document.templates.items() if each.text.startswith(text)
        }
        assert set(found.free) <= {*document.definitions, *document.templates} or not document.variables


def test_a_wrong_text_has_its_names():
    found = outline("float x\nconst float c = 3\nlow = x <= c; always(low")
    assert [(each.name, len(found.uses_of(each))) for each in found.symbols] == [
        ("x", 2),
        ("c", 2),
        ("low", 2),
    ]


def test_a_parameter_of_a_template_hides_nothing_outside():
    text = "float x; float y\ndef near(x, z = 1) = abs(x - y) <= z\nnear(x, z = 2)"
    found = outline(text, parse_document(text))
    assert [(each.name, each.kind, len(found.uses_of(each))) for each in found.symbols] == [
        ("x", "variable", 2),
        ("y", "variable", 2),
        ("near", "template", 2),
        ("x", "argument", 2),
        ("z", "argument", 3),
    ]
