"""``rtamt monitor --live`` on a terminal of its own."""

import os
import pty
import re
import subprocess
import sys

from rtamt.cli.live_view import Live

LINES = "".join(f'{{"time": {t}, "x": {x}}}\n' for t, x in enumerate([5, 4, 1, 6]))


def monitor(stdout):
    """Run the monitor with a terminal for stderr; return the code, what is on the terminal, and stdout."""
    main, terminal = pty.openpty()
    command = [sys.executable, "-m", "rtamt", "monitor", "always[0:1](x >= 3)", "--live"]
    environment = {**os.environ, "TERM": "xterm", "NO_COLOR": ""}
    out = terminal if stdout == "terminal" else subprocess.PIPE
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=out, stderr=terminal, env=environment
    ) as process:
        os.close(terminal)
        piped, _ = process.communicate(LINES.encode())
    seen = b""
    try:
        while chunk := os.read(main, 65536):
            seen += chunk
    except OSError:  # Linux says so at the end of a terminal
        pass
    os.close(main)
    return process.returncode, seen.decode(), piped


def test_the_view_is_on_the_terminal_and_json_goes_through_the_pipe():
    code, seen, piped = monitor("pipe")
    assert code == 0
    assert piped.decode().splitlines() == [
        '{"time": 0.0, "robustness": 1.0}',
        '{"time": 1.0, "robustness": -2.0}',
        '{"time": 2.0, "robustness": -2.0}',
        '{"time": 3.0, "robustness": 3.0}',
    ]
    last = seen.rpartition("\x1b[J")[2].splitlines()
    assert "always[0:1](x >= 3)" in last[0]
    assert "✓ 3 at 3.0  (lowest -2 at 1.0)" in last[1]
    assert [re.sub(r"\x1b\[\d*m", "", line) for line in last[2:]] == ["▅▁▁█", "4 samples  x=6"]
    assert "\x1b[31m▁▁\x1b[0m" in last[2]


def test_on_a_terminal_alone_the_view_replaces_the_json():
    code, seen, _ = monitor("terminal")
    assert code == 0
    assert "4 samples  x=6" in seen
    assert "robustness" not in seen


def test_without_a_terminal_it_is_refused(run):
    answer = run("monitor", "x >= 3", "--live", stdin=LINES)
    assert answer == (2, "", "rtamt: --live draws on a terminal, and stderr is none: leave it out\n")


def test_a_line_is_never_wider_than_the_terminal(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "30")
    live = Live("always(" + "x" * 90 + " >= 3)", sys.stderr)
    live.point(0.0, float("inf"))
    live.sample({f"signal_{i}": i for i in range(20)})
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 4
    assert max(map(len, lines)) == 29
    live.clear()
    assert capsys.readouterr().err == "\x1b[4F\x1b[J"
