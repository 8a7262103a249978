"""The command line as a program of its own: pipes, signals, terminals."""

import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
RTAMT = [sys.executable, "-m", "rtamt"]
SPEC = "examples/request_grant/spec.stl"
TRACES = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "examples/request_grant").glob("*.csv"))


def start(*args, **options):
    options = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.Popen([*RTAMT, *args], cwd=ROOT, text=True, **options)


def test_check_as_a_program():
    with start("check", SPEC, *TRACES) as process:
        out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (1, "")
    assert [line.split(maxsplit=4)[4].split() for line in out.splitlines() if ".csv  " in line] == [
        ["3", "-", "satisfied"],
        ["1", "-", "satisfied"],
        ["-2", "2", "s", "violated"],
        ["-1", "2", "s", "violated"],
    ]
    assert out.splitlines()[-1] == "2 satisfied, 2 violated"


def test_monitor_answers_each_line_before_the_next_one_comes():
    with start("monitor", "x >= 3") as process:
        for time, x in enumerate([5, 4, 1]):
            process.stdin.write(f'{{"time": {time}, "x": {x}}}\n')
            process.stdin.flush()
            assert process.stdout.readline() == f'{{"time": {float(time)}, "robustness": {float(x - 3)}}}\n'
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (0, "", "")


def test_monitor_ends_quietly_when_nobody_reads_on():
    with start("monitor", "x >= 3") as process:
        process.stdin.write('{"x": 5}\n')
        process.stdin.flush()
        process.stdout.readline()
        process.stdout.close()
        process.stdin.write('{"x": 5}\n')
        process.stdin.close()
        assert process.wait(timeout=60) == 2
        assert process.stderr.read() == ""


def test_monitor_ends_quietly_when_interrupted():
    with start("monitor", "x >= 3") as process:
        process.stdin.write('{"x": 5}\n')
        process.stdin.flush()
        assert process.stdout.readline() == '{"time": 0.0, "robustness": 2.0}\n'
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "")


@pytest.mark.parametrize(("no_color", "colored"), [("", True), ("1", False)])
def test_check_on_a_terminal_is_coloured(no_color, colored):
    leader, follower = pty.openpty()
    environment = os.environ | {"TERM": "xterm", "NO_COLOR": no_color}
    with start("check", SPEC, TRACES[0], stdout=follower, stdin=None, env=environment) as process:
        os.close(follower)
        assert process.wait(timeout=60) == 0
        shown = os.read(leader, 65_536).decode()
    os.close(leader)
    assert ("\x1b[32msatisfied\x1b[0m" in shown) == colored
    assert "satisfied" in shown


def shell(command, folder):
    """Run a line of shell in which ``rtamt`` is the command; return exit codes of the pipe's parts, stdout, stderr."""
    codes = folder / "codes"
    script = (
        f'rtamt() {{ "{sys.executable}" -m rtamt "$@"; }}; {command}; echo "${{PIPESTATUS[@]}}" > "{codes}"'
    )
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, timeout=60, check=False)
    return [int(code) for code in codes.read_text().split()], done.stdout, done.stderr


CLOSED = b"rtamt: stdout is closed, so that the output would be lost; use > /dev/null\n"


@pytest.mark.parametrize(
    ("command", "code", "err"),
    [
        (f"rtamt check {SPEC} {TRACES[0]} >&-", 2, CLOSED),
        ("rtamt --help >&-", 2, CLOSED),
        (f"rtamt check {SPEC} {TRACES[0]} <&-", 0, b""),
        ("rtamt monitor 'x >= 0' <&-", 2,
         b"rtamt: stdin is closed: give one JSON object per line, or CSV with a header row\n"),
        (f"rtamt check {SPEC} {TRACES[3]} 2>&-", 1, b""),
        (f"rtamt check {SPEC} {TRACES[0]} >&- 2>&- <&-", 2, b""),
        (f"rtamt check {SPEC} {TRACES[0]} > /dev/full", 2,
         b"rtamt: cannot write the output: No space left on device\n"),
        ("rtamt check --help > /dev/full", 2, b"rtamt: cannot write the output: No space left on device\n"),
    ],
)  # fmt: skip
def test_a_closed_stream_never_exits_with_1_which_means_violated(tmp_path, command, code, err):
    codes, out, told = shell(command, tmp_path)
    assert (codes, told) == ([code], err)
    assert b"Traceback" not in out


def test_a_reader_that_goes_away_ends_the_command_with_2_and_without_a_word(tmp_path):
    source = "for i in $(seq 20000); do echo '{\"x\": 1}'; done"
    codes, out, told = shell(f"{source} | rtamt monitor 'x >= 0' --keep-going | head -1", tmp_path)
    assert (codes[1:], out, told) == ([2, 0], b'{"time": 0.0, "robustness": 1.0}\n', b"")


UNUSED = (
    "rtamt.ros rtamt.fleet.groups rtamt.compiler.stored rtamt.engine.user_operators rtamt.reference "
    "rtamt.rewrite.quantifiers "
    "rtamt.readers.ahead rtamt.readers.arrow rtamt.readers.rows rtamt.signals.resampling rtamt.signals.sampling "
    "rtamt.verdicts.prepared numpy.ma"
).split()


def test_checking_a_csv_file_loads_no_module_for_other_formats_and_modes(tmp_path):
    (tmp_path / "log.csv").write_text("time,x\n0,5\n1,4\n")
    program = (
        "import sys\nfrom rtamt.cli import main\ncode = main(['check', 'always(x >= 3)', 'log.csv', '--quiet'])\n"
        f"assert code == 0\nassert sys.modules.keys().isdisjoint({UNUSED!r})"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
