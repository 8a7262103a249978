"""``rtamt monitor --live`` on a terminal of its own."""

import io
import os
import pty
import re
import subprocess
import sys
from math import inf

import numpy as np
import pytest

import rtamt
from rtamt import Interval
from rtamt.cli.early_feeds import IntervalFeed
from rtamt.cli.live_view import Live, format_time

LINES = "".join(f'{{"time": {t}, "x": {x}}}\n' for t, x in enumerate([5, 4, 1, 6]))


class Terminal(io.StringIO):
    """A terminal that remembers what is written."""

    def isatty(self):
        return True


def picture(live, stream):
    """Return the lines of the last picture, without colours and codes."""
    with live:
        stream.seek(0)
        stream.truncate()
    plain = re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", stream.getvalue().rpartition("\x1b[2K")[2])
    return [line.rstrip() for line in plain.splitlines()]


def monitor(stdout, lines=LINES, *options, formula="always[0:1](x >= 3)"):
    """Run the monitor with a terminal for stderr; return the code, what is on the terminal, and stdout."""
    main, terminal = pty.openpty()
    command = [sys.executable, "-m", "rtamt", "monitor", formula, "--live", *options]
    environment = {**os.environ, "TERM": "xterm", "NO_COLOR": ""}
    out = terminal if stdout == "terminal" else subprocess.PIPE
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=out, stderr=terminal, env=environment
    ) as process:
        os.close(terminal)
        piped, _ = process.communicate(lines.encode())
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
    last = [line.strip() for line in seen.rpartition("\x1b[2K")[2].splitlines()]
    assert "always[0:1](x >= 3)" in last[0]
    assert "✓ 3 at 3 s  (lowest -2 at 1 s)" in last[1]
    assert [re.sub(r"\x1b\[[\d?]*[a-z]", "", line) for line in last[2:4]] == ["▅▁▁█", "4 samples  x = 6"]
    assert "\x1b[31m▁" in last[2]


def test_units_are_those_of_the_header_or_of_the_declaration():
    lines = "time,x [m/s]\n0,5\n1,6\n"
    assert "2 samples  x = 6 m/s" in monitor("pipe", lines)[1]


def test_a_bad_line_is_reported_above_the_picture():
    code, seen, _ = monitor("pipe", LINES + "{\n", "--keep-going")
    assert code == 2
    assert seen.count("rtamt: stdin, line 5: ") == 1
    assert seen.rindex("4 samples  x = 6") > seen.index("rtamt: stdin, line 5: ")


def test_a_title_draws_nothing_but_its_text(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    live = Live("[red]\x1b[2J[/red] :smile:", stream)
    assert "[red]\\x1b[2J[/red] :smile:" in picture(live, stream)[0]


def test_times_are_rounded_and_dates_keep_milliseconds():
    assert format_time(0.30000000000000004) == "0.3 s"
    assert format_time(np.timedelta64(1_700_000_000_100_000_001, "ns")) == "1700000000.1 s"
    assert format_time(np.datetime64("2026-05-01T12:00:00.123456789")) == "2026-05-01T12:00:00.123"


def test_without_rich_it_names_the_extra(run, monkeypatch):
    monkeypatch.setattr("sys.stderr", Terminal())
    monkeypatch.setitem(sys.modules, "rich.console", None)
    assert run("monitor", "x >= 3", "--live", stdin=LINES)[0] == 2
    assert "pip install 'rtamt[cli]'" in sys.stderr.getvalue()


def test_on_a_terminal_alone_the_view_replaces_the_json():
    code, seen, _ = monitor("terminal")
    assert code == 0
    assert "4 samples  x = 6" in seen
    assert "robustness" not in seen


def test_without_a_terminal_it_is_refused(run):
    answer = run("monitor", "x >= 3", "--live", stdin=LINES)
    assert answer == (2, "", "rtamt: --live draws on a terminal, and stderr is none: leave it out\n")


def test_a_line_is_never_wider_than_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "30")
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    live = Live("always(" + "x" * 90 + " >= 3)", stream)
    for time in range(50):
        live.point(time, float("inf"))
    live.sample({f"signal_{i}": i for i in range(20)})
    lines = picture(live, stream)
    assert len(lines) == 4
    assert max(map(len, lines)) == 30


def test_members_and_booleans_are_shown_by_name():
    code, seen, _ = monitor(
        "pipe",
        '{"mode": "AUTO", "p": true}\n{"mode": 0, "p": false}\n',
        formula="enum Mode { MANUAL, AUTO = 4 } input Mode mode input bool p always[0:1](mode == AUTO or p)",
    )
    assert code == 0
    assert "mode = MANUAL  p = false" in seen


def test_members_of_groups_that_are_absent_are_not_drawn():
    stdin = '{"car_1.x": 5, "car_2.x": 4}\n{"car_2.x": 7}\n{"car_2.x": null, "car_3.x": 9}\n'
    formula = 'group cars = "car_*"; forall v in cars: v.x >= 3'
    code, seen, _ = monitor("pipe", stdin, formula=formula)
    assert code == 0
    assert "3 samples  car_3.x = 9\r" in seen


def test_bounds_at_the_start_narrow_to_the_robustness():
    stream = Terminal()
    live = Live("always(x >= 3)", stream)
    for known, status, satisfied in (
        (Interval(-inf, 4.0), "open", None),
        (Interval(-inf, 1.0), "open", None),
        (Interval(-inf, -2.0), "violated since 2.0 s", False),
        (Interval(-2.0, -2.0), "violated since 2.0 s", False),
    ):
        live.sample({"x": 5})
        live.bounds(known, status, satisfied)
    assert picture(live, stream) == [
        "always(x >= 3)",
        "✗ violated since 2.0 s  (robustness from -2 to -2)",
        "upper █▅▁▁",
        "lower ↓↓↓▁",
        "4 samples  x = 5",
    ]


def test_unbounded_future_is_drawn_live():
    code, seen, piped = monitor("pipe", LINES, formula="always(x >= 3)")
    assert code == 0
    assert "violated since 2.0 s" in seen
    assert piped.decode().splitlines()[-1].endswith('"status": "violated since 2.0 s", "final": true}')


@pytest.mark.parametrize("more", [(), ("--time", "dense")])
def test_bounds_of_a_bounded_formula_are_drawn_at_the_latest_samples(more):
    code, seen, piped = monitor("pipe", LINES, "--verdict", "interval", *more, formula="always[0:1s](x >= 3)")
    assert code == 0
    assert piped.decode().count('"upper": -2.0') >= 1
    lines = seen.rpartition("\x1b[2K")[2].splitlines()
    last = [re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", line).strip() for line in lines]
    assert last[1:4] == ["✓ at 3 s  (robustness from 3 to 3)", "upper ▅▁▁█", "lower ▅▁▁█"]


def test_the_newest_instant_is_open_until_its_horizon():
    monitor = rtamt.parse("always[0:1](x >= 3)").monitor(verdict="interval")
    stream = Terminal()
    live = Live("always[0:1](x >= 3)", stream)
    feed = IntervalFeed(monitor, live)
    for time, x in enumerate([5, 4]):
        feed.take(float(time), {"x": x}, 1)
    lines = picture(live, stream)
    assert lines[1:4] == ["… at 1 s  (robustness from -inf to 1)", "upper ▁▁", "lower ▁↓"]
