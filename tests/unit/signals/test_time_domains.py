"""Time domains and back ends are objects: no other code compares their names or asks for the class of a trace."""

import ast
from collections.abc import Container, Iterator
from pathlib import Path

import pytest

import rtamt
from rtamt.engine import BACKENDS
from rtamt.signals.time_domains import DOMAINS

SRC = Path(rtamt.__file__).parent
#: Where time domains and their traces are defined.
HOME = {SRC / "signals" / f"{name}.py" for name in ("time_domain_interface", "time_domains", *DOMAINS)}
MODULES = sorted(set(SRC.rglob("*.py")) - HOME)
CLASSES = {"TimeDomain", "DomainTrace", "Discrete", "Dense", "DiscreteTrace", "DenseTrace"}


def name_of(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def has_name(node: ast.expr, names: Container[object] = DOMAINS) -> bool:
    """Return whether an operand is the name of a time domain, or a display or constant that holds one."""
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    return any(isinstance(part, ast.Constant) and part.value in names for part in parts)


def defaults(node: ast.FunctionDef) -> Iterator[ast.expr]:
    yield from node.args.defaults
    yield from (default for default in node.args.kw_defaults if default is not None)


def problems(tree: ast.Module) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            if any(map(has_name, (node.left, *node.comparators))):
                yield node.lineno, "compares the name of a time domain"
            if any(has_name(side, BACKENDS) for side in (node.left, *node.comparators)):
                yield node.lineno, "compares the name of a back end"
            for side in (node.left, *node.comparators):
                if isinstance(side, ast.Call) and name_of(side.func) == "type":
                    others = {name_of(other) for other in (node.left, *node.comparators)}
                    if others & CLASSES:
                        yield node.lineno, "compares the class of a time domain or trace"
        elif isinstance(node, ast.MatchValue) and has_name(node.value):
            yield node.value.lineno, "matches the name of a time domain"
        elif isinstance(node, ast.MatchClass) and name_of(node.cls) in CLASSES:
            yield node.lineno, "matches the class of a time domain or trace"
        elif isinstance(node, ast.Call) and name_of(node.func) in ("isinstance", "issubclass"):
            if {name_of(each) for each in ast.walk(node.args[1]) if isinstance(each, ast.expr)} & CLASSES:
                yield node.lineno, "asks for the class of a time domain or trace"
        elif isinstance(node, ast.FunctionDef) and any(map(has_name, defaults(node))):
            yield node.lineno, "repeats the name of the default time domain"


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(SRC)))
def test_a_module_leaves_the_choice_of_a_time_domain_to_its_object(path: Path) -> None:
    assert list(problems(ast.parse(path.read_text(encoding="utf-8")))) == []


@pytest.mark.parametrize(
    "code",
    [
        "time == 'dense'",
        "'discrete' != time",
        "time in ('dense', 'other')",
        "isinstance(trace, DenseTrace)",
        "isinstance(trace, signals.DiscreteTrace | DenseTrace)",
        "type(domain) is Dense",
        "backend == 'cpp'",
        "self._backend in ('python', 'other')",
        "match time:\n    case 'dense': pass",
        "match trace:\n    case DenseTrace(): pass",
        "def f(time='discrete'): pass",
        "def f(*, time='discrete'): pass",
    ],
)
def test_a_choice_by_name_or_class_is_found(code: str) -> None:
    assert len(list(problems(ast.parse(code)))) == 1
