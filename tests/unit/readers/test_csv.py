"""The CSV reader: what it takes, what it refuses, and in which words."""

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import TraceError
from rtamt.readers import csv as csv_module
from rtamt.readers import csv_arrow
from tests.unit.cli import invoke
from tests.unit.readers.csv_files import as_lists, read


def test_columns_come_as_float64_arrays_with_time_first(write):
    data = read(write("time,req,gnt\n0,1,2\n1,3,4\n"), ["gnt", "req"])
    assert as_lists(data) == {"time": [0.0, 1.0], "gnt": [2.0, 4.0], "req": [1.0, 3.0]}
    assert list(data) == ["time", "gnt", "req"]
    assert all(column.dtype == np.float64 for column in data.values())


def test_without_names_every_column_is_read(write):
    assert as_lists(read(write("t,a,b\n0,1,2\n"))) == {"time": [0.0], "a": [1.0], "b": [2.0]}


@pytest.mark.parametrize(
    "content",
    [
        "time,req\n0,1.5\n1,-2\n",
        "time;req\n0;1.5\n1;-2\n",
        "time\treq\n0\t1.5\n1\t-2\n",
        "sep=,\ntime,req\n0,1.5\n1,-2\n",
        '\ufeffsep=;\r\ntime;req;a,b,c,d\r\n0;1.5;"x"\r\n1;-2;\r\n',
        "SEP=\t\ntime\treq\n0\t1.5\n1\t-2\n",
        "\ufefftime,req\n0,1.5\n1,-2\n",
        " time , req \n 0 , 1.5 \n 1 , -2\n",
        'time,"req"\n"0","1.5"\n1,-2\n',
        "time,req\r\n0,1.5\r\n1,-2\r\n",
        "time,req\n0,1.5\n1,-2",
        "\n\ntime,req\n\n0,1.5\n   \n1,-2\n\n",
        "# a comment\ntime,req\n# another, with a comma\n0,1.5\n1,-2\n",
        "# time,req\n0,1.5\n1,-2\n",
        "Time [s],req\n0,1.5\n1,-2\n",
        "TIME,req [V]\n0,1.5\n1,-2\n",
        "Timestamp (ms),req\n0,1.5\n1000,-2\n",
        "stamp [ns],req\n0,1.5\n1000000000,-2\n",
        'time,note,req\n0,"a, b",1.5\n1,"two\nlines",-2\n',
        "time,note,req\n0,started # 1,1.5\n1,,-2\n",
        "req,t\n1.5,0\n-2,1\n",
        "note,req,time\nx,1.5,0\ny,-2,1\n",
        "time,req\n0,15e-1\n1,-2.000\n",
    ],
)
def test_every_way_to_write_the_same_file_gives_the_same_numbers(write, content):
    assert as_lists(read(write(content), ["req"])) == {"time": [0.0, 1.0], "req": [1.5, -2.0]}


def test_fields_and_topics_are_names_of_columns(write):
    data = read(write("time,req.value,/gnt/x\n0,1,2\n"), ["req.value", "/gnt/x"])
    assert as_lists(data) == {"time": [0.0], "req.value": [1.0], "/gnt/x": [2.0]}


def test_without_a_time_column_there_is_no_time(write):
    assert as_lists(read(write("req\n1\n2\n"), ["req"])) == {"req": [1.0, 2.0]}


def test_time_column_can_be_named_or_refused(write):
    file = write("time,clock,req\n0,5,1\n")
    assert as_lists(read(file, ["req"], time_column="clock")) == {"time": [5.0], "req": [1.0]}
    assert as_lists(read(file, ["req"], time_column="")) == {"req": [1.0]}


def test_a_formula_may_read_the_time_column(write):
    assert as_lists(read(write("t,x\n0,1\n"), ["t", "x"])) == {"time": [0.0], "t": [0.0], "x": [1.0]}


def test_milliseconds_become_seconds_with_one_rounding(write):
    data = read(write("t [ms],x\n0,1\n100,1\n300,1\n700,1\n"), ["x"])
    assert data["time"].tolist() == [0.0, 0.1, 0.3, 0.7]


def test_infinities_are_numbers(write):
    assert read(write("x\ninf\n-inf\nInfinity\n"), ["x"])["x"].tolist() == [np.inf, -np.inf, np.inf]


def test_what_nobody_reads_may_hold_anything(write):
    assert as_lists(read(write("x,note,x2,x2\n1,nan,,\n2,abc,,7\n"), ["x"])) == {"x": [1.0, 2.0]}


def test_suffixes_that_are_csv_too(write):
    assert as_lists(read(write("x\ty\n1\t2\n", "log.TSV"), ["y"])) == {"y": [2.0]}


@given(
    st.lists(st.tuples(*[st.floats(allow_nan=False)] * 2), min_size=1, max_size=12),
    st.integers(1, 5),
    st.sampled_from(["", "\n", "# comment\n", '"1","2"\n']),
    st.integers(0, 12),
)
def test_numbers_survive_whatever_block_an_unusual_line_falls_into(tmp_path_factory, rows, block, odd, at):
    lines = [f"{a!r},{b!r}\n" for a, b in rows]
    extra = [(1.0, 2.0)] if odd.startswith('"') else []
    at = min(at, len(rows))
    path = tmp_path_factory.mktemp("csv") / "log.csv"
    path.write_text("".join(["a,b\n", *lines[:at], odd, *lines[at:]]))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_module, "BLOCK", block)
        data = read(path)
    expected = [*rows[:at], *extra, *rows[at:]]
    assert list(zip(data["a"], data["b"], strict=True)) == expected


LONG = "time,x\n" + "0,1\n" * 10 + "1,{}\n" + "0,1\n" * 10


@pytest.mark.parametrize(
    ("content", "names", "message"),
    [
        ("time,req\n0,1\n1,abc\n", ["req"], "log.csv, line 3: 'req' is 'abc', expected a number"),
        (
            "time,req\n0,1\n1,NaN\n",
            ["req"],
            "log.csv, line 3: 'req' is NaN: fill the gap, or leave such samples out with skip_nan=, "
            "on the command line --skip-nan",
        ),
        ("time,req\n0,1\n1,1_000\n", ["req"], "log.csv, line 3: 'req' is '1_000', expected a number"),
        ("time,req\n0,1\n1,١\n", ["req"], "log.csv, line 3: 'req' is '١', expected a number"),
        ("time,req\n0,1\n1,0x10\n", ["req"], "log.csv, line 3: 'req' is '0x10', expected a number"),
        (
            "time;req\n0;1,5\n",
            ["req"],
            "log.csv, line 2: 'req' is '1,5', expected a number with a decimal point",
        ),
        ("Time [s],req\nnow,1\n", ["req"], "log.csv, line 2: 'Time [s]' is 'now', expected a number"),
        (
            "time,req\n0,1\n1\n",
            ["req"],
            "log.csv, line 3: 1 value, but 2 columns (time, req)",
        ),
        (
            "time,req\n0,1\n1,2,3\n",
            ["req"],
            "log.csv, line 3: 3 values, but 2 columns (time, req)",
        ),
        (
            'time,note,req\n0,"two\nlines",1\n\n1,x,bad\n',
            ["req"],
            "log.csv, line 5: 'req' is 'bad', expected a number",
        ),
        (LONG.format("abc"), ["x"], "log.csv, line 12: 'x' is 'abc', expected a number"),
        (
            LONG.format("nan"),
            ["x"],
            "log.csv, line 12: 'x' is NaN: fill the gap, or leave such samples out with skip_nan=, "
            "on the command line --skip-nan",
        ),
        (LONG.format("1,2"), ["x"], "log.csv, line 12: 3 values, but 2 columns (time, x)"),
        (
            "time,req,gmt\n0,1,2\n",
            ["req", "gnt"],
            "log.csv has no column 'gnt'; did you mean 'gmt'? (columns: gmt, time, req)",
        ),
        (
            ",".join(f"c{i}" for i in range(20)) + "\n",
            ["volts"],
            "log.csv has no column 'volts'; columns: c0, c1, "
            "c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12, c13, c14, c15 and 4 more",
        ),
        (
            "time,req,req\n0,1,2\n",
            ["req"],
            "log.csv has 2 columns called 'req'; rename all but one of them",
        ),
        (
            "time,time,req\n0,1,2\n",
            ["req"],
            "log.csv has several columns that may hold the timestamps: 'time', 'time'; "
            "choose one with time=, or on the command line --time-column ('' for none)",
        ),
        (
            "t [day],req\n0,1\n",
            ["req"],
            "the unit of the time column 't [day]' of log.csv is 'day', which is none of h, min, s, ms, us, ns",
        ),
        (
            "0,1\n1,2\n",
            ["req"],
            "log.csv, line 1: expected a row of column names, such as time,x; got '0,1': put the names above it",
        ),
        ("", ["req"], "'log.csv' is empty: it needs a row of column names, then a row for each sample"),
        (
            "\n# x\n",
            ["req"],
            "'log.csv' is empty: it needs a row of column names, then a row for each sample",
        ),
        (
            b"time,req\n0,\xff\n",
            ["req"],
            "'log.csv' is not UTF-8 text; save it as CSV in UTF-8 (spreadsheets offer this under 'save as')",
        ),
    ],
)
@pytest.mark.parametrize("block", [3, 65_536])
def test_messages(write, monkeypatch, content, names, message, block):
    monkeypatch.setattr(csv_module, "BLOCK", block)
    with pytest.raises(TraceError) as error:
        read(write(content), names)
    assert str(error.value) == message


def test_message_for_a_field_too_long_for_a_csv_file(write):
    with pytest.raises(TraceError) as error:
        read(write('time,x\n0,"' + "1" * 200_000 + '"\n'), ["x"])
    assert str(error.value) == (
        "log.csv, line 2: a cell has more than 131,072 characters: close the quote that it begins with, or leave its "
        "column out"
    )


@pytest.mark.parametrize("character", ["\u2028", "\u2029", "\x85", "\x1c", "\x1f", "\u3000"])
@pytest.mark.parametrize("header", ["time, x{}\xa0\n", "time,\tx{} [V]\n", "# time,x{} \n"])
def test_names_lose_spaces_tabs_and_line_ends_around_them_and_nothing_else(write, character, header):
    trace = rtamt.read(write(f"{header.format(character)}0,1\n"))
    assert trace.names == (f"x{character}",)


def test_message_names_the_variable(write):
    with pytest.raises(TraceError) as error:
        read(write("time,req\n0,abc\n"), ["req"])
    assert error.value.variable == "req"


def test_message_for_a_time_column_that_is_not_there(write):
    with pytest.raises(TraceError) as error:
        read(write("time,req\n0,1\n"), ["req"], time_column="tine")
    assert str(error.value) == "log.csv has no column 'tine'; did you mean 'time'? (columns: time, req)"


def test_message_for_a_missing_file():
    with pytest.raises(TraceError) as error:
        read("nowhere/log.csv", ["x"])
    assert str(error.value) == "there is no file 'nowhere/log.csv'"


def test_message_for_a_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").mkdir()
    with pytest.raises(TraceError) as error:
        read("log.csv", ["x"])
    assert str(error.value) == "'log.csv' is a directory, expected a file"


def test_message_for_a_device(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").symlink_to("/dev/zero")
    with pytest.raises(TraceError) as error:
        read("log.csv", ["x"])
    assert str(error.value) == "'log.csv' is a device, expected a file"


def test_message_for_an_unreadable_file():
    with pytest.raises(TraceError) as error:
        read("x" * 300 + ".csv", ["x"])
    assert str(error.value) == f"cannot read '{'x' * 300}.csv': File name too long"


def test_message_for_an_unknown_suffix():
    with pytest.raises(TraceError) as error:
        read("log.cvs", ["x"])
    assert str(error.value) == (
        "cannot tell how to read 'log.cvs': its name ends in none of .csv, .tsv, .txt, .parquet, .pq, .arrow, "
        ".feather, .ipc, .xlsx, .xlsm, .ulg, .mf4, .mdf, .bag, .db3, .mcap; did you mean '.csv'?"
    )


def test_a_file_of_20_000_columns_takes_time_in_proportion_to_its_size(tmp_path):
    names = [f"x{i}" for i in range(20_000)]
    path = tmp_path / "wide.csv"
    path.write_text(f"time,{','.join(names)}\n" + "".join(f"{k},{'1.5,' * 19_999}\n" for k in range(2)))
    began = time.process_time()  # what other processes do does not matter
    trace = rtamt.read(
        path, columns=names, names={f"x{i}": f"x{i + 1}" for i in range(19_998)}, skip_nan=names
    )
    assert time.process_time() - began < 12
    assert trace.names == tuple(names)
    assert len(trace["x19997"]) == 2


MISSING = "'x' is missing at sample 1{}, but discrete time needs a value at every sample: fill the gap, {}"


def test_an_empty_cell_in_discrete_time_is_rejected_wherever_a_number_is_needed(
    tmp_path, capsys, monkeypatch
):
    text = "time,x,y\n0,1,2\n1,,3\n2,4,5\n"
    (tmp_path / "log.csv").write_text(text)
    (tmp_path / "x.stl").write_text("historically(x >= 0)")
    monkeypatch.chdir(tmp_path)
    expected = MISSING.format(
        " of log.csv",
        "hold the value before it (--hold-for DURATION), use dense time (--time dense), or put all on one time base "
        "(--resample PERIOD)",
    )
    for command in (("check",), ("explain",), ("report", "-o", "r.html"), ("plot", "-o", "p.png")):
        answer = invoke(capsys, monkeypatch, [command[0], "x.stl", "log.csv", *command[1:]])
        assert answer.code == 2
        assert expected in answer.err
    spec = rtamt.parse("historically(x >= 0)")
    expected = MISSING.format(
        " of log.csv",
        "hold the value before it (trace.hold(), or hold_for= of rtamt.read), use dense time (time='dense'), put all "
        "on one time base (trace.resample(period=...)), or read the bounds of the robustness "
        "(spec.evaluate(trace).interval)",
    )
    entries = (
        lambda: spec.monitor().update_many(rtamt.read("log.csv")),
        lambda: rtamt.check_stream(spec, rtamt.scan("log.csv")),
    )
    for entry in entries:
        with pytest.raises(rtamt.TraceError) as error:
            entry()
        assert str(error.value).removeprefix("trace 0: ") == expected
    (bounded,) = rtamt.evaluate_all([spec], rtamt.read("log.csv"))
    assert bounded.interval == spec.evaluate(rtamt.read("log.csv")).interval
    lines = ['{"time": 0, "x": 1}', '{"time": 1, "x": null}']
    for stdin, line in ((text, 3), ("\n".join(lines), 2)):
        answer = invoke(capsys, monkeypatch, ["monitor", "x.stl"], stdin)
        told = MISSING.format(
            "",
            "or use dense time (--time dense); --verdict eager and --verdict interval take missing samples",
        )
        assert (answer.code, answer.err) == (2, f"rtamt: stdin, line {line}: {told}\n")
    # Nothing is missing of what is read, nor in dense time, nor on a clock that was chosen.
    assert rtamt.parse("y >= 0").evaluate(rtamt.read("log.csv")).robustness == 2
    assert spec.evaluate(rtamt.read("log.csv"), time="dense").satisfied
    assert spec.evaluate(rtamt.read("log.csv").resample(1)).satisfied
    assert spec.evaluate(rtamt.read("log.csv").hold()).satisfied


# ---- the same table as a file and on stdin -----------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "last"),
    [
        ("time,x\n0,true\n1,FALSE\n", 0.0),
        ("time,x\r0,1\r1,2\r", 2.0),
        ("time,x\r\n0,1\r\n1,2\r\n", 2.0),
        ("time,x,y\n0,true,1\n1,True,-3\n", 1.0),
    ],
)
def test_monitor_refused_booleans_and_lines_that_end_with_cr_which_files_may_have(
    tmp_path, capsys, monkeypatch, text, last
):
    path = tmp_path / "log.csv"
    path.write_bytes(text.encode())
    assert rtamt.parse("x").evaluate(rtamt.read(path)).signal.values[-1] == last
    answer = invoke(capsys, monkeypatch, ["monitor", "x"], text)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[-1] == f'{{"time": 1.0, "robustness": {last}}}'


def test_a_number_among_booleans_is_rejected_by_one_sentence_in_files_and_on_stdin(
    tmp_path, capsys, monkeypatch
):
    text = "time,x\n0,true\n1,3\n"
    (tmp_path / "log.csv").write_text(text)
    monkeypatch.chdir(tmp_path)
    for args, name in ((["check", "x > 0", "log.csv"], "log.csv"), (["monitor", "x > 0"], "stdin")):
        answer = invoke(capsys, monkeypatch, args, text)
        assert (answer.code, answer.err) == (
            2,
            f"rtamt: {name}, line 3: 'x' is '3', expected true or false\n",
        )


def test_a_header_in_utf_16_is_not_reported_as_a_missing_column(tmp_path, capsys, monkeypatch):
    path = tmp_path / "log.csv"
    path.write_bytes("time,x\n0,1\n".encode("utf-16"))
    answer = invoke(capsys, monkeypatch, ["check", "x > 0", str(path)])
    assert (answer.code, "is not UTF-8 text" in answer.err) == (2, True)
    path.write_text("time,x\ufffd\n0,1\n", encoding="utf-8")
    assert rtamt.parse("x > 0").evaluate(rtamt.read(path, names={"x": "x\ufffd"})).robustness == 1


@pytest.mark.parametrize(
    ("before", "line"), [("", 1), ("time,x\n0,1\n", 3), ("time,x\n" + "0,1\n" * 20_000, 20_002)]
)
def test_a_line_without_an_end_was_read_into_memory(write, monkeypatch, before, line):
    monkeypatch.setattr(csv_module, "LONGEST_LINE", 2**20)
    monkeypatch.setattr(csv_arrow, "LONGEST_LINE", 2**20)
    path = write(before)
    with open(path, "ab") as file:
        file.truncate(file.tell() + 2**22)  # zeros, as after a crash
    with pytest.raises(TraceError) as error:
        read(path, ["x"])
    assert str(error.value) == (
        f"log.csv, line {line}: the line has 1,048,576 characters or more; the file is damaged, or no CSV: export it "
        f"again"
    )
