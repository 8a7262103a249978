"""``rtamt --help``, ``rtamt operators``: the parts that teach."""

import subprocess
import sys
from pathlib import Path

import pytest

import rtamt
from rtamt.cli import COMMANDS, main, overview, parser_of
from rtamt.language.operators import STL

ROOT = Path(__file__).parents[3]


def help_of(capsys, *args):
    with pytest.raises(SystemExit) as stop:
        main([*args, "--help"])
    assert stop.value.code == 0
    return capsys.readouterr().out


def test_help_names_every_command_and_the_exit_codes(capsys):
    text = help_of(capsys)
    for command in COMMANDS.values():
        assert f"  {command.name} " in text
        assert command.summary in text
    assert "0 satisfied (or done), 1 violated, 2 error" in text


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_every_command_has_examples_and_fits_a_terminal(capsys, monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "80")
    text = help_of(capsys, command)
    assert text.startswith(f"usage: rtamt {command} ")
    assert "\nexamples:\n" in text
    prose = text.partition("\nexamples:\n")[0]
    assert max(map(len, prose.splitlines())) <= 80


def test_help_offers_formulas_only_where_they_are_read(run, capsys):
    assert "a formula in quotes" in help_of(capsys, "describe")
    assert "a formula in quotes" not in help_of(capsys, "lint")
    assert run("lint", "always(x >= 3)")[0] == 2
    assert "with --from: a file of that format;" in " ".join(help_of(capsys, "convert").split())


def test_help_says_how_infinities_look_in_json(capsys):
    for command in ("check", "monitor"):
        assert 'Infinities are the strings "inf" and "-inf", because JSON has none' in " ".join(
            help_of(capsys, command).split()
        )


#: Files that the examples name and nobody has here.
ELSEWHERE = (".csv", ".ulg", "limits.stl")


def examples():
    for command in ("", *COMMANDS):
        parser = COMMANDS[command] if command else None
        text = overview().format_help() if parser is None else parser_of(parser).format_help()
        for line in text.partition("examples:\n")[2].partition("\n\n")[0].splitlines():
            if "examples/" in line or not any(f"{suffix} " in f"{line} " for suffix in ELSEWHERE):
                yield line.strip()


@pytest.mark.parametrize(
    "line",
    [
        line
        for line in examples()
        if "log.jsonl" not in line and not line.startswith(("rtamt ros2", "rtamt lsp"))
    ],
)
def test_examples_in_the_help_can_be_pasted(line):
    command = line.split("     ")[0].replace("rtamt ", f'"{sys.executable}" -m rtamt ')
    done = subprocess.run(["sh", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.returncode in (0, 1)
    assert done.stdout


def test_without_a_command_the_help_is_shown(run, capsys):
    assert run() == (2, help_of(capsys), "")


def test_version(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--version"])
    assert (stop.value.code, capsys.readouterr().out) == (0, f"rtamt {rtamt.__version__}\n")


def test_operators_lists_the_whole_table(run):
    answer = run("operators")
    rows = [line for line in answer.out.splitlines()[1:] if line]
    names = [row.split()[0] for row in rows]
    for operator in STL:
        # A form that is no operator, such as count over a group, may have the name of one.
        of_name = [row for row, name in zip(rows, names, strict=True) if name == operator.name]
        texts = (operator.doc, operator.example, " ".join(operator.spellings))
        assert [row for row in of_name if all(text in row for text in texts)], operator.name
    assert names.index("mul") < names.index("ge") < names.index("until") < names.index("or")


def test_operators_by_name_or_spelling(run):
    assert run("operators", "U", "neg") == (
        0,
        "name   written         example                   meaning\n"
        f"until  until U [a:b]?  x >= 3 until[0:5] y >= 3  {STL['until'].doc}\n"
        f"neg    -               -x >= 2                   {STL['neg'].doc}\n",
        "",
    )
