"""The reference of the API: what is on the page, and how docstrings become sections of it."""

import ast
import doctest
import sys
from pathlib import Path

import pytest

import rtamt

ROOT = Path(__file__).parents[3]


@pytest.fixture
def tool(monkeypatch):
    """Import a module of tools/docs."""
    monkeypatch.syspath_prepend(str(ROOT / "tools/docs"))

    def imported(name):
        module = __import__(name)
        monkeypatch.delitem(sys.modules, name)
        return module

    return imported


def hidden_examples():
    """Yield the docstrings that only type checkers see: those of methods that a base in C++ has."""
    for path in sorted((ROOT / "src/rtamt").rglob("*.py")):
        for owner in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for guarded in owner.body if isinstance(owner, ast.ClassDef) else ():
                if isinstance(guarded, ast.If) and ast.unparse(guarded.test) == "TYPE_CHECKING":
                    for method in guarded.body:
                        text = isinstance(method, ast.FunctionDef) and ast.get_docstring(method)
                        if text and ">>>" in text:
                            yield f"{owner.name}.{method.name}", text


HIDDEN = dict(hidden_examples())


def test_examples_that_no_doctest_finds_are_known():
    assert {"Monitor.update", "Monitor.step"} <= set(HIDDEN)


@pytest.mark.parametrize("name", HIDDEN)
def test_an_example_of_a_method_in_cpp_runs(name):
    example = doctest.DocTestParser().get_doctest(HIDDEN[name], {}, name, None, None)
    told = []
    result = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(example, out=told.append)
    assert result.attempted > 0
    assert result.failed == 0, "".join(told)


def test_the_tasks_come_in_the_order_in_which_a_user_meets_them(tool):
    page = tool("reference").api()
    tasks = [line.removeprefix("## ") for line in page.splitlines() if line.startswith("## ")]
    assert tasks[:5] == ["Parse and load", "Evaluate", "Monitor", "Monitor many keys", "Verdicts"]
    shown = {line.removeprefix("::: ") for line in page.splitlines() if line.startswith(":::")}
    names = {f"rtamt.{getattr(rtamt, name).__name__}" for name in rtamt.__all__ if name != "STL"}
    assert names <= shown


def test_a_new_name_needs_a_task(tool, monkeypatch):
    monkeypatch.setattr(rtamt, "__all__", [*rtamt.__all__, "batch"])
    monkeypatch.setattr(rtamt.batch, "__module__", "rtamt", raising=False)
    with pytest.raises(ValueError, match="give each a task in TASKS: batch"):
        tool("reference").api()


def test_sentences_about_parameters_leave_the_prose(tool):
    parts, told = tool("prose").parts_of(
        "Do it.\n\n``a``: the first, see\n``b``. Default 1. ``b`` as in ``a``. Raises an error.\n\n``c``: none.",
        ["a", "b"],
    )
    assert told == {"a": "the first, see\n``b``. Default 1.", "b": "as in ``a``."}
    assert parts == ["Do it.", "Raises an error.", "``c``: none."]


def test_examples_and_tables_become_markdown(tool):
    parts, _ = tool("prose").parts_of(
        "Such as::\n\n    x = 1\n\n>>> x\n1\n\n=====  ====\na b    c\n=====  ====\nd|e    f\n=====  ====", []
    )
    assert parts == [
        "Such as:",
        "    x = 1",
        "```pycon\n>>> x\n1\n```",
        "| a b | c |\n| --- | --- |\n| d\\|e | f |",
    ]


def test_the_example_of_every_operator_has_a_value_on_the_signals_of_its_plot(tool):
    diagram = tool("diagram")
    for operator in rtamt.STL:
        spec = rtamt.parse(operator.example)
        read = {name: values for name, values in diagram.SIGNALS.items() if name in spec.input_names}
        assert len(spec.evaluate({"time": diagram.TIME, **read}).signal.values) == len(diagram.TIME)
