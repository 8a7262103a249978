"""The note of commands on integers that no double holds."""

import pytest

ODD, EVEN = 2**53 + 1, 2**53
NOTE = "rounded to doubles: 2 integers of x beyond 2^53, the first at 1 s"


@pytest.mark.parametrize("command", [["check"], ["check", "--early"], ["explain"]], ids=" ".join)
def test_commands_show_the_note_with_the_verdict(run, tmp_path, command) -> None:
    recording = tmp_path / "a.csv"
    recording.write_text(f"time,x,y\n0,1,1\n1,{ODD},{EVEN}\n2,{ODD},{EVEN}\n")
    answer = run(*command, "always(x - y >= 0)", str(recording))
    assert (answer.code, answer.out.count(NOTE)) == (0, 1)


@pytest.mark.parametrize(
    "lines",
    [
        f"time,x,y\n0,1,1\n1,{ODD},{EVEN}\n2,{ODD},{EVEN}\n",
        f'{{"time": 0, "x": 1, "y": 1}}\n\n{{"time": 1, "x": {ODD}, "y": {EVEN}}}\n{{"time": 2, "x": {ODD}, "y": 1}}\n',
    ],
    ids=["csv", "json"],
)
def test_a_stream_has_the_note_once(run, lines: str) -> None:
    answer = run("monitor", "x - y >= 0", stdin=lines)
    note = "rtamt: note: stdin: rounded to doubles: integers of x beyond 2^53, the first in line 3\n"
    assert (answer.code, answer.err) == (0, note)
