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
    assert [line.split()[-2:] for line in out.splitlines() if ".csv" in line] == [
        ["3", "satisfied"],
        ["1", "satisfied"],
        ["-2", "violated"],
        ["-1", "violated"],
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
        assert process.wait(timeout=60) == 141
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
