"""Lines of a stream: when they arrive, and which empty ones are samples."""

import json
import tracemalloc
from itertools import chain, repeat

import pytest

from rtamt.cli.stdin_reader import lines_of

MISSING = (
    "rtamt: stdin, line 3: 'x' is missing at sample 1, but discrete time needs a value at every sample: fill the gap, "
    "or use dense time (--time dense); --verdict eager and --verdict interval take missing samples\n"
)


def lower_bounds(run, text):
    """Return the times and the lower bounds of ``x >= 0`` that the monitor prints for a stream."""
    code, out, err = run("monitor", "x >= 0", "--verdict", "interval", "--period", "1", stdin=text)
    assert (code, err) == (0, "")
    return [(each["time"], each["lower"]) for each in map(json.loads, out.splitlines())]


def test_a_line_arrives_before_the_next_one_is_read():
    read = []

    def stream():
        for line in (b"x\n", b"1\n", b"\n", b"# note\n", b"2\r3\r\n", b" \n"):
            read.append(line)
            yield line

    arrived = [(number, line, len(read)) for number, line in lines_of(stream())]
    assert arrived == [
        (1, b"x", 1),
        (2, b"1", 2),
        (4, b"# note", 4),
        (3, b"", 5),
        (5, b"2", 5),
        (6, b"3", 5),
    ]


def test_a_stream_that_is_idle_needs_no_memory():
    lines = lines_of(chain([b"x\n"], repeat(b"\n", 20_000), [b"1\n"]))
    tracemalloc.start()
    try:
        assert [next(lines), *(next(lines) for _ in range(2))] == [(1, b"x"), (2, b""), (3, b"")]
        assert tracemalloc.get_traced_memory()[1] < 20_000
    finally:
        tracemalloc.stop()
    assert sum(1 for _ in lines) == 19_999


@pytest.mark.parametrize("gap", ["", "  ", "\xa0", '""', "\n# note", "# note\n"])
@pytest.mark.parametrize("end", ["", "\n", "\n \n\xa0\n", "\n# note\n", "# note\n\n"])
def test_an_empty_line_between_samples_of_one_column_is_a_missing_sample(run, gap, end):
    text = f"x\n1\n{gap}\n3\n{end}"
    assert lower_bounds(run, text) == [(0, 1), (1, "-inf"), (2, 3)]


def test_every_empty_line_from_the_header_to_the_last_sample_is_a_missing_sample(run):
    assert lower_bounds(run, "\n\nx\n\n1\n\n\n3\n") == [
        (0, "-inf"), (1, 1), (2, "-inf"), (3, "-inf"), (4, 3),
    ]  # fmt: skip


@pytest.mark.parametrize("text", ["x,y\n1,0\n\n3,0\n\n", '{"x": 1}\n\n{"x": 3}\n\n'])
def test_an_empty_line_of_several_columns_or_of_json_is_no_sample(run, text):
    assert lower_bounds(run, text) == [(0, 1), (1, 3)]


def test_modes_that_take_no_missing_samples_reject_the_empty_line(run):
    command = ("monitor", "x >= 2", "--period", "1")
    first = '{"time": 0.0, "robustness": -1.0}\n'
    assert run(*command, stdin="x\n1\n\n3\n\n") == (2, first, MISSING)
    code, out, err = run(*command, "--keep-going", stdin="x\n1\n\n3\n\n")
    assert (code, out, err) == (2, first + '{"time": 1.0, "robustness": 1.0}\n', MISSING)
    assert run("monitor", "x >= 2", "--verdict", "causation", "--period", "1", stdin="x\n1\n\n3\n")[::2] == (
        2,
        MISSING,
    )
    assert run(*command, stdin="x\n1\n\n# note\n\n") == (0, first, "")


def test_an_empty_line_under_a_column_of_timestamps_has_no_time(run):
    code, _, err = run("monitor", "time >= 0", "--time", "dense", stdin="time\n0\n\n1\n")
    assert (code, err) == (2, "rtamt: stdin, line 3: the time column 'time' is empty at sample 1\n")


@pytest.mark.parametrize("character", ["\u2028", "\u3000", "\x85", "\x1c"])
def test_a_name_in_the_header_keeps_what_is_no_space_tab_or_line_end_as_in_a_file(run, write, character):
    header = f"y,x{character}"
    log = write("log.csv", f"{header}\n1,1\n")
    printed = character.encode("unicode_escape").decode() if character != "\u3000" else character
    for code, _, err in (
        run("monitor", "x + y >= 0", stdin=f"{header}\n1,1\n"),
        run("check", "x + y >= 0", log),
    ):
        assert code == 2
        assert f" has no column 'x'; did you mean 'x{printed}'? (columns: x{printed}, y)" in err
