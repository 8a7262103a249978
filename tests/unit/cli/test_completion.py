"""``rtamt completion``: asked in a real shell where there is one."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from rtamt.cli import COMMANDS
from rtamt.cli.completion import SHELLS


@pytest.mark.parametrize("shell", SHELLS)
def test_a_script_has_every_command_and_its_options(run, shell):
    answer = run("completion", shell)
    assert (answer.code, answer.err) == (0, "")
    for command in COMMANDS:
        assert command in answer.out
    assert "semantics" in answer.out
    assert "junit" in answer.out


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_reads_its_script(run, tmp_path, shell):
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell} here")
    script = tmp_path / "script"
    script.write_text(run("completion", shell).out, encoding="utf-8")
    done = subprocess.run([shell, "-n", str(script)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


TYPED = pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("rtamt che", {"check"}),
        ("rtamt monitor --sem", {"--semantics"}),
        ("rtamt info --l", {"--language", "--latex"}),
        ("rtamt check spe", {"spec.stl"}),
    ],
)


@TYPED
def test_bash_completes(run, write, tmp_path, typed, expected):
    script = tmp_path / "script"
    script.write_text(run("completion", "bash").out, encoding="utf-8")
    write("spec.stl", "x >= 3")
    ask = f"""
        shopt -s extglob; source {script}
        COMP_WORDS=({typed}); COMP_CWORD=$(( ${{#COMP_WORDS[@]}} - 1 ))
        COMP_LINE='{typed}'; COMP_POINT=${{#COMP_LINE}}
        function=$(complete -p rtamt | sed 's/.*-F \\([^ ]*\\) .*/\\1/')
        $function rtamt "${{COMP_WORDS[COMP_CWORD]}}" "${{COMP_WORDS[COMP_CWORD-1]}}"
        printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    done = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) == expected, done.stderr


@pytest.mark.skipif(shutil.which("fish") is None, reason="there is no fish here")
@TYPED
def test_fish_completes(run, write, tmp_path, typed, expected):
    script = tmp_path / "script"
    script.write_text(run("completion", "fish").out, encoding="utf-8")
    write("spec.stl", "x >= 3")
    ask = f"source {script}; complete --do-complete '{typed}'"
    done = subprocess.run(
        ["fish", "--no-config", "-c", ask], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert {line.partition("\t")[0] for line in done.stdout.splitlines()} == expected, done.stderr


def test_another_shell_is_refused(run):
    assert run("completion", "tcsh") == (
        2,
        "",
        "rtamt: there is no completion for 'tcsh'; shells: bash, zsh, fish\n",
    )
