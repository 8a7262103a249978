"""Excel, PX4 ULog and MDF files."""

import datetime as dt
import os
import re
import struct
import zipfile
from pathlib import Path

import asammdf
import numpy as np
import openpyxl
import pytest

import rtamt
from rtamt.readers import excel
from tests.unit.readers.bags import Bag

AGAIN = "; the file is damaged, incomplete or of another kind: copy or export it again"

# ---- Excel ---------------------------------------------------------------------------------------


def workbook(path, **sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        page = book.create_sheet(title)
        for row in rows:
            page.append(row)
    book.save(path)
    return path


def test_excel(tmp_path):
    rows = [[], ["Time [s]", "x [V]", "note"], [0, 5, "go"], [0.1, None, None], [], [0.2, 6.5, "stop"]]
    trace = rtamt.read(workbook(tmp_path / "a.xlsx", log=rows))
    assert (trace.names, trace.channel("x").unit) == (("x",), "V")
    assert (trace["x"].times.tolist(), trace["x"].values.tolist()) == ([0, 0.2], [5, 6.5])
    assert trace.notes == ("time is 'Time [s]', by its name", "left out, not numbers: note")


@pytest.mark.parametrize("character", ["\u2028", "\x85", "\u3000"])
def test_names_in_excel_lose_spaces_tabs_and_line_ends_around_them_and_nothing_else(tmp_path, character):
    rows = [["time\xa0\n", f" x{character}\t"], [0, 5], [1, 6]]
    assert rtamt.read(workbook(tmp_path / "a.xlsx", log=rows)).names == (f"x{character}",)


def test_excel_dates_and_sheets(tmp_path):
    dates = [dt.datetime(2024, 5, 1, 10, 0, second) for second in (0, 1)]
    path = workbook(tmp_path / "a.xlsx", readme=[], log=[["when", "x"], [dates[0], 1], [dates[1], 2]])
    trace = rtamt.read(path)
    assert trace["x"].times.tolist() == np.array(dates, dtype="M8[ns]").tolist()
    assert trace.notes == ("sheet 'log'", "time is 'when', the one column of dates")
    path = workbook(tmp_path / "b.xlsx", first=[["x"], [1]], second=[["x"], [2]])
    assert rtamt.read(path, sheet="second")["x"].values.tolist() == [2]


@pytest.mark.parametrize("columns", [["x"], ["x", "y"], ["Zeit", "x"]], ids=len)
def test_an_empty_row_of_a_sheet_without_timestamps_is_a_missing_sample(tmp_path, columns):
    row = [1] * len(columns)
    path = workbook(tmp_path / "a.xlsx", log=[columns, row, [], row, []])
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{columns[0]}' is missing at sample 1 of {path}: fill the gap, or name the column of timestamps, so that "
        f"each signal has its own time base"
    )
    path = workbook(tmp_path / "b.xlsx", log=[columns, row, row, [], [None] * len(columns)])
    assert rtamt.read(path, time="").channel("x").values.tolist() == [1, 1]


@pytest.mark.parametrize("rows", [0, 30_000])
def test_a_formula_that_nothing_has_computed_is_rejected(tmp_path, rows):
    log = [["time", "x"], *([i, 1] for i in range(rows)), [rows, 1], [rows + 1, "=1+1"], [rows + 2, 1]]
    path = workbook(tmp_path / "a.xlsx", log=log)
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"the cell B{rows + 3} in the sheet 'log' of {path} is a formula without its value: open the workbook in a "
        f"spreadsheet and save it"
    )


def test_a_formula_with_its_value_or_with_an_empty_text_is_read(tmp_path):
    path = workbook(tmp_path / "a.xlsx", log=[["time", "x"], [0, 1], [1, "=1+1"], [2, "=A1"], [3, 4]])
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    sheet = parts["xl/worksheets/sheet1.xml"]
    assert sheet.count(b"<f>") == 2
    sheet = sheet.replace(b"<f>1+1</f><v></v>", b"<f>1+1</f><v>2</v>")
    sheet = sheet.replace(b'<c r="B4"><f>', b'<c r="B4" t="str"><f>')
    with zipfile.ZipFile(path, "w") as archive:
        for name, part in parts.items():
            archive.writestr(name, sheet if name == "xl/worksheets/sheet1.xml" else part)
    trace = rtamt.read(path)
    assert (trace["x"].times.tolist(), trace["x"].values.tolist()) == ([0, 1, 3], [1, 2, 4])


@pytest.mark.parametrize("name", ["when", None])
def test_an_empty_row_of_a_sheet_with_dates_is_no_row(tmp_path, name):
    dates = [dt.datetime(2024, 5, 1, 10, 0, second) for second in (0, 1)]
    path = workbook(tmp_path / "a.xlsx", log=[[name, "x"], [dates[0], 1], [], [dates[1], 2]])
    assert rtamt.read(path)["x"].values.tolist() == [1, 2]


def test_a_lone_cell_at_the_far_end_of_a_sheet_takes_no_17_billion_steps(tmp_path):
    book = openpyxl.Workbook()
    for row in (["t", "x"], [0, 5], [1, 6]):
        book.active.append(row)
    book.active["XFD1048576"] = 1
    path = tmp_path / "a.xlsx"
    book.save(path)
    assert rtamt.read(path)["x"].values.tolist() == [5, 6]


def packed(path, old, new):
    """Write a workbook anew with other bytes in its sheet."""
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in parts.items():
            archive.writestr(name, data.replace(old, new) if "sheet1" in name else data)


def test_a_sheet_that_claims_rows_beyond_those_of_excel_is_refused(tmp_path):
    path = workbook(tmp_path / "a.xlsx", log=[["t", "x"], [0, 5], [1, 6]])
    packed(path, b'r="3"', b'r="99999999999"')
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"the sheet 'log' of {path} reaches beyond 1,048,576 rows or 268,435,456 cells, empty ones included: "
        "delete what is far from the table, or save the sheet as CSV"
    )


def test_a_small_workbook_that_unpacks_to_more_than_the_limit_is_refused(tmp_path, monkeypatch):
    path = workbook(tmp_path / "a.xlsx", log=[["t", "x"], [0, 5]])
    packed(path, b"<sheetData>", b"<sheetData>" + b" " * 2**22)
    assert path.stat().st_size < 20_000
    monkeypatch.setattr(excel, "MOST_BYTES", 2**21)
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"{path} unpacks to 4.0 MiB, more than the 2 MiB that are read of a workbook: "
        "save its sheets as CSV, or split it"
    )


def test_a_first_column_of_a_sheet_without_a_name_may_hold_the_timestamps(tmp_path):
    path = workbook(tmp_path / "floats.xlsx", log=[[None, "x"], [0.0, 5], [0.5, 6]])
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"{path} has a column that may hold the timestamps: one without a name; name it, or choose one with time=, or "
        f"on the command line --time-column ('' for none)"
    )
    dates = [dt.datetime(2024, 5, 1, 10), dt.datetime(2024, 5, 1, 11)]
    path = workbook(tmp_path / "dates.xlsx", log=[[None, "x"], [dates[0], 5], [dates[1], 6]])
    assert str(rtamt.read(path).end) == "2024-05-01T11:00:00.000000000"
    path = workbook(tmp_path / "rows.xlsx", log=[[None, "x"], [0, 5], [1, 6]])
    assert rtamt.read(path).names == ("x",)


# ---- PX4 ULog ------------------------------------------------------------------------------------


def ulog(path, topics, dropouts=()):
    """Write a flight log: ``topics`` are (name, instance, fields, rows), fields floats: "float x;float[2] q"."""
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))

    def message(kind, payload):
        out.extend(struct.pack("<HB", len(payload), ord(kind)) + payload)

    for name, fields in {name: fields for name, _, fields, _ in topics}.items():
        message("F", f"{name}:uint64_t timestamp;{fields};".encode())
    for number, (name, instance, _, _) in enumerate(topics):
        message("A", struct.pack("<BH", instance, number) + name.encode())
    for number, (_, _, fields, rows) in enumerate(topics):
        counts = [int(re.search(r"\[(\d+)\]", field + "[1]")[1]) for field in fields.split(";")]
        code = f"<HQ{sum(counts)}f"
        for row in rows:
            message("D", struct.pack(code, number, *row))
    for milliseconds in dropouts:
        message("O", struct.pack("<H", milliseconds))
    path.write_bytes(out)
    return path


def test_ulog(tmp_path):
    topics = [
        ("battery", 0, "float x", [(1_000_000, 12.5), (1_500_000, 12.25)]),
        ("battery", 1, "float x", [(1_000_000, 11.5), (2_000_000, 11.25), (3_000_000, 11)]),
        ("attitude", 0, "float[2] q", [(1_000_001, 1, 0)]),
    ]
    path = ulog(tmp_path / "flight.ulg", topics, dropouts=[100, 19])
    trace = rtamt.read(path)
    assert trace.names == ("attitude.q[0]", "attitude.q[1]", "battery.x", "battery[1].x")
    assert trace.notes == ("2 dropouts of the logger, 0.119 s in all: nothing was recorded in them",)
    assert trace.losses == trace.notes
    assert rtamt.read(ulog(tmp_path / "once.ulg", topics, dropouts=[7])).losses == (
        "a dropout of the logger, 0.007 s: nothing was recorded in it",
    )
    assert trace["attitude.q[0]"].times.tolist() == [1.000001]
    named = rtamt.read(path, columns=["battery.x", "v"], names={"v": "battery[1].x"})
    spec = rtamt.parse("always(battery.x >= v)")
    result = spec.evaluate(named, time="dense")
    assert result.signal.times.tolist() == [1, 2, 3]
    assert result.signal.values.tolist() == [0.75, 1, 1.25]


FLIGHTS = [Path(os.environ.get("RTAMT_FLIGHT", "")), Path(__file__).parents[4] / "shared/data/px4_flight.ulg"]


@pytest.mark.skipif(
    not any(path.is_file() for path in FLIGHTS), reason="no recorded flight; RTAMT_FLIGHT names one"
)
def test_a_real_flight():
    trace = rtamt.read(next(path for path in FLIGHTS if path.is_file()))
    rates = [name for name in trace.names if name.startswith("vehicle_attitude.") and name.endswith("speed")]
    assert len(rates) == 3
    for name in rates:
        result = rtamt.parse(f"always(abs({name}) <= 20)").evaluate(trace, time="dense")
        assert result.robustness == 20 - np.abs(trace[name].values).max()


# ---- MDF -----------------------------------------------------------------------------------------


def test_mdf(tmp_path):
    def channel(name, times, values, **more):
        return asammdf.Signal(np.array(values), np.array(times, dtype=float), name=name, **more)

    path = tmp_path / "drive.mf4"
    gear = {"val_0": 0, "text_0": b"neutral", "val_1": 1, "text_1": b"first"}
    with asammdf.MDF(version="4.10") as file:
        file.start_time = dt.datetime(2024, 5, 1, 12, tzinfo=dt.timezone(dt.timedelta(hours=2)))
        file.append([channel("speed", [0, 0.5, 1], [3.0, 4.0, 5.0], unit="m/s"),
                     channel("gear", [0, 0.5, 1], np.array([0, 1, 1], dtype="u1"), conversion=gear)])  # fmt: skip
        file.append([channel("torque", [0, 0.25], [7, 8], unit="Nm")])
        file.append([channel("torque", [0, 0.75], [9, 10], unit="Nm")])
        file.save(path)
    trace = rtamt.read(path, columns=["speed", "gear"])
    assert trace.origin == np.datetime64("2024-05-01T10:00:00", "ns")
    assert trace.channel("speed").unit == "m/s"
    assert trace["speed"].times.tolist() == [0, 0.5, 1]
    assert trace["gear"].values.tolist() == [0, 1, 1]
    assert rtamt.parse("always(gear >= 1 -> speed >= 4)").evaluate(trace).satisfied
    both = [name for name in rtamt.read(path).names if "torque" in name]
    assert [rtamt.read(path)[name].values.tolist() for name in both] == [[7, 8], [9, 10]]


@pytest.mark.parametrize(("kind", "axis"), [(2, "angle"), (3, "distance"), (4, "an index")])
def test_a_group_that_is_not_recorded_over_time_has_no_timestamps(tmp_path, kind, axis):
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array([0.0, 9.0, 0.0]), np.arange(3) * 90.0, name="p")])
        master = file.groups[0].channels[0]
        master.sync_type, master.name = kind, "crank"
        file.save(tmp_path / "engine.mf4")
    with pytest.raises(rtamt.TraceError, match="has no timestamps, which dense time needs"):
        rtamt.parse("always(p >= 0)", time="dense").evaluate(
            rtamt.read(tmp_path / "engine.mf4", columns=["p"])
        )
    trace = rtamt.read(tmp_path / "engine.mf4")
    assert trace["crank"].values.tolist() == [0, 90, 180]
    assert trace["p"].times.tolist() == [0, 1, 2]
    assert trace.losses == (f"group0 is recorded over {axis}, not over time, so that it has no timestamps",)


def test_formats_with_a_unit_of_time_refuse_another_one(tmp_path):
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array([3.0, 4.0]), np.array([0.0, 1.0]), name="x")])
        file.save(tmp_path / "log.mf4")
    flight = ulog(tmp_path / "flight.ulg", [("t", 0, "float x", [(1_000_000, 5.0)])])
    with Bag(tmp_path, "mcap") as bag:
        bag.stamped("/a", 1, 5.0)
    for path, unit in ((tmp_path / "log.mf4", "s"), (flight, "us"), (bag.path, "ns")):
        with pytest.raises(rtamt.TraceError) as caught:
            rtamt.read(path, time_unit="ms")
        assert str(caught.value) == (
            f"the timestamps of {path} have a unit, {unit}: leave out time_unit=, on the command line --time-unit"
        )


def test_what_asammdf_prints_is_not_printed(tmp_path, monkeypatch, capsys):
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array([3.0, 4.0]), np.array([0.0, 1.0]), name="x")])
        file.save(tmp_path / "log.mf4")
    get = asammdf.MDF.get

    def loud(*args, **options):
        print("MDF ====")
        return get(*args, **options)

    monkeypatch.setattr(asammdf.MDF, "get", loud)
    assert rtamt.read(tmp_path / "log.mf4")["x"].values.tolist() == [3, 4]
    assert capsys.readouterr().out == ""


def test_a_measurement_whose_conversion_is_python_code_is_refused_before_asammdf_runs_it(tmp_path):
    path = tmp_path / "drive.mf4"
    gone = tmp_path / "gone"
    for formula, problem in (
        (f"open('{gone}', 'w')", "has a conversion that is no arithmetic"),
        ("9**9**9**9", "has a conversion that is no arithmetic"),
        ("2*X + 1", None),
    ):
        with asammdf.MDF(version="4.10") as file:
            ticks = np.arange(2.0)
            file.append([asammdf.Signal(ticks, ticks, name="x", conversion={"formula": formula})])
            file.save(path, overwrite=True)
        if problem is None:
            assert rtamt.read(path)["x"].values.tolist() == [1, 3]
            continue
        with pytest.raises(rtamt.TraceError) as error:
            rtamt.read(path)
        assert str(error.value) == (
            f"'{path}' cannot be read as MDF: the channel 'x' of group 0 {problem}, '{formula}'; "
            "the file is damaged: copy or export it again"
        )
    assert not gone.exists()


# ---- messages ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "make", "options", "message"),
    [
        ("a.xlsx", lambda p: workbook(p, a=[["x"], [1]]), {"sheet": "b"}, "{path} has no sheet 'b'; sheets: a"),
        ("a.xlsx", lambda p: workbook(p, one=[["x"]], two=[["y"]]), {},
         "{path} has several sheets: one, two; choose one with sheet=, or on the command line --sheet"),
        ("a.xlsx", lambda p: workbook(p, a=[]), {},
         "{path} is empty: it needs a row of column names, then a row for each sample"),
        ("a.xlsx", lambda p: workbook(p, a=[[0, 1]]), {},
         "{path}: expected a row of column names, such as time, x; the first row is (0, 1)"),
        ("a.xlsx", lambda p: workbook(p, a=[["t", "x"], [0, "?"]]), {"columns": ["x"]},
         "'x' of {path} is '?' at sample 0, expected a number"),
        ("a.xlsx", lambda p: p.write_bytes(b"no"), {},
         "'{path}' cannot be read as Excel: File is not a zip file" + AGAIN),
        ("a.ulg", lambda p: p.write_bytes(b"no"), {},
         "'{path}' cannot be read as PX4 ULog: Invalid file format (Header too short)" + AGAIN),
        ("a.ulg", lambda _: None, {}, "there is no file '{path}'"),
        ("a.ulg", lambda p: ulog(p, []), {"columns": ["x"]}, "{path} has no column 'x'; columns: none"),
        ("a.csv", lambda p: p.write_text("x\n1\n"), {"sheet": "b"},
         "'{path}' is CSV, which has no sheets; leave the sheet out"),
        ("a.csv", lambda p: p.write_text("x\n1\n"), {"query": "select"},
         "a query is for a database, whose address looks like sqlite:///log.db"),
    ],
)  # fmt: skip
def test_messages(tmp_path, name, make, options, message):
    path = tmp_path / name
    make(path)
    with pytest.raises(rtamt.StlError) as error:
        rtamt.read(str(path), **options)
    assert str(error.value) == message.format(path=path)


def test_what_is_no_mdf(tmp_path):
    (tmp_path / "a.mf4").write_bytes(b"nothing of the kind" * 10)
    with pytest.raises(rtamt.TraceError, match=r"^'.*a\.mf4' cannot be read as MDF: .*not a valid"):
        rtamt.read(tmp_path / "a.mf4")


@pytest.mark.parametrize("where", ["__init__", "get"])
def test_what_asammdf_raises_at_damaged_blocks_is_told(tmp_path, monkeypatch, where):
    path = tmp_path / "a.mf4"
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(np.array([3.0, 4.0]), np.array([0.0, 1.0]), name="speed")])
        file.save(path)

    def damaged(*_, **__):
        raise ValueError("seek out of range")

    monkeypatch.setattr(asammdf.MDF, where, damaged, raising=where == "__init__")
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == f"'{path}' cannot be read as MDF: seek out of range{AGAIN}"


def test_a_topic_of_a_flight_log_without_its_clock_is_refused_and_not_a_key_error(tmp_path):
    path = ulog(tmp_path / "a.ulg", [("battery", 0, "float x", [(1_000_000, 12.5)])])
    path.write_bytes(path.read_bytes().replace(b"uint64_t timestamp", b"uint64_t timestemp"))
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{path}' cannot be read as PX4 ULog: the topic 'battery' has no field 'timestamp'"
    )


def test_what_pyulog_prints_of_a_damaged_flight_log_is_a_note_and_not_among_the_answers(tmp_path, capsys):
    topics = [("battery", 0, "float x", [(1_000_000, 12.5)])]
    path = ulog(tmp_path / "a.ulg", topics)
    path.write_bytes(path.read_bytes() + struct.pack("<HBHQf", 14, ord("D"), 9, 2_000_000, 1.0))
    trace = rtamt.read(path)
    assert trace["battery.x"].values.tolist() == [12.5]
    assert trace.notes == (
        "the file is damaged, read up to 1 s, as far as possible: Warning: no subscription found for message id 9. "
        "Continuing, but file is most likely corrupt",
    )
    assert capsys.readouterr().out == ""


def test_a_flight_log_that_was_cut_off_is_read_so_far_with_a_note(tmp_path, capsys):
    rows = [(1_000_000 * i, float(i)) for i in range(20)]
    whole = ulog(tmp_path / "whole.ulg", [("battery", 0, "float x", rows)]).read_bytes()
    message = 3 + 2 + 8 + 4
    path = tmp_path / "cut.ulg"
    for missing in range(1, message):
        path.write_bytes(whole[:-missing])
        trace = rtamt.read(path)
        assert trace["battery.x"].values.tolist() == [float(i) for i in range(19)]
        assert trace.notes == ("the file ends in the middle of a message: read up to 18 s",)
    path.write_bytes(whole[:-message])  # a whole file with a sample less
    assert rtamt.read(path).notes == ()
    path.write_bytes(whole[: -20 * message - 1])
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{path}' cannot be read as PX4 ULog: the file ends in the middle of a message: read up to 0 s, "
        "and no sample comes before that"
    )
    assert capsys.readouterr().out == ""


def test_pyulog_does_not_read_the_damaged_end_of_a_flight_log_for_ever(tmp_path):
    path = ulog(tmp_path / "a.ulg", [("battery", 0, "float x", [(1_000_000, 12.5)])])
    path.write_bytes(path.read_bytes()[:16] + struct.pack("<HB", 11, 0) + bytes(10))
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == f"'{path}' cannot be read as PX4 ULog: too much of it is damaged"


def test_a_flight_log_of_60_bytes_with_billions_of_fields_is_refused(tmp_path):
    path = ulog(tmp_path / "a.ulg", [("battery", 0, "float x", [])])
    out = bytearray(path.read_bytes()[:16])
    for kind, payload in (
        ("F", b"a:uint64_t timestamp;b[60000] x;"),
        ("F", b"b:c[60000] y;"),
        ("F", b"c:float z;"),
        ("A", struct.pack("<BH", 0, 0) + b"a"),
    ):
        out += struct.pack("<HB", len(payload), ord(kind)) + payload
    path.write_bytes(out)
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{path}' cannot be read as PX4 ULog: its topics have more than 1,048,576 fields, elements of arrays "
        "included; the file is damaged: copy or export it again"
    )
