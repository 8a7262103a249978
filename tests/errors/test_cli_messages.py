"""What the command line says when something is wrong: a sentence on stderr, exit code 2, no traceback."""

import errno
import sys

import pytest

from rtamt.cli import COMMANDS
from tests.unit.cli import invoke

USE_PYTHON = "; on the command line: --backend python\n"


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.csv").write_text("time,x\n0,5\n1,4\n")
    (tmp_path / "bad.stl").write_text("specification s\ninput float x\nout = always(x >= );\n")
    (tmp_path / "folder").mkdir()
    return lambda *args, stdin="": invoke(capsys, monkeypatch, args, stdin)


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (
            ["chek"],
            f"there is no command 'chek'; did you mean 'check'? (commands: {', '.join([*COMMANDS][:16])} and "
            f"{len(COMMANDS) - 16} more); see 'rtamt --help'",
        ),
        (["--verion"], "unknown option '--verion'; did you mean '--version'?; see 'rtamt --help'"),
        (["check"], "the following arguments are required: SPEC, TRACE; see 'rtamt check --help'"),
        (["check", "x"], "there is no trace to check: name a file, or --sql URL; see 'rtamt check --help'"),
        (
            ["check", "x", "good.csv", "--jsn"],
            "unknown option '--jsn'; did you mean '--json'?; see 'rtamt check --help'",
        ),
        (["info", "x", "good.csv"], "'good.csv' chooses signals of a recording, and 'x' is none"),
        (
            ["check", "x", "good.csv", "--backend", "pyton"],
            "unknown backend 'pyton'; did you mean 'python'? (back ends: python, cpp)",
        ),
        (
            ["check", "x", "good.csv", "--color", "alway"],
            "unknown colour mode 'alway'; did you mean 'always'? (modes: always, auto, never)",
        ),
        (
            ["check", "x", "good.csv", "--period", "soon"],
            "'soon' is not a duration; write for example '100ms', '1/3s' or 5",
        ),
        (["info", "x", "--period", "0"], "the sampling period is '0'; it must be positive"),
        (["info", "x", "--unit", "d"], "'d' is not a unit of time; units: h, min, s, ms, us, ns"),
        (
            ["monitor", "x", "--tolerance", "-1"],
            "the tolerance is -1; give a fraction of the period, such as 0.1",
        ),
        (
            ["monitor", "x", "--tolerance", "nan"],
            "the tolerance is nan; give a fraction of the period, such as 0.1",
        ),
        (
            ["monitor", "x", "--tolerance", "a lot"],
            "argument --tolerance: invalid float value: 'a lot'; see 'rtamt monitor --help'",
        ),
        (
            ["check", "nowhere.stl", "good.csv"],
            "there is no file 'nowhere.stl' (if a formula is meant, put it in parentheses)",
        ),
        (
            ["check", "specs/nowhere", "good.csv"],
            "there is no file 'specs/nowhere' (if a formula is meant, put it in parentheses)",
        ),
        (["info", "folder"], "'folder' is a directory, expected a specification file or a formula"),
        (["info", "/dev/zero"], "'/dev/zero' is a device, expected a specification file or a formula"),
        (["format", "/dev/zero"], "cannot read '/dev/zero': it is a device, expected a file"),
        (["falsify", "/dev/zero"], "cannot read '/dev/zero': it is a device, expected a file"),
        (
            ["info", " "],
            "the specification is empty; give a file or a formula, such as 'always(x >= 3)'",
        ),
        (
            ["check", "good.csv", "bad.stl"],
            "'good.csv' is a trace; the specification comes before the traces",
        ),
        (
            ["check", "bad.stl", "good.csv"],
            "bad.stl: expected an operand after '>=', got ')'\n"
            "  line 3, column 19:\n"
            "    out = always(x >= );\n"
            "                      ^",
        ),
        (
            ["info", "always(x >= )"],
            "expected an operand after '>=', got ')'\n"
            "  line 1, column 13:\n"
            "    always(x >= )\n"
            "                ^",
        ),
        (
            ["check", "x", "good.csv", "good.csv", "-o", "rho.csv"],
            "--output takes the robustness of one trace, got 2 traces",
        ),
        (
            ["check", "x", "good.csv", "--quiet", "-o", "nowhere/rho.csv"],
            "cannot write 'nowhere/rho.csv': No such file or directory",
        ),
        (["check", "x", "nowhere.csv"], "there is no file 'nowhere.csv'"),
        (
            ["check", "x", "folder"],
            "'folder' is a folder without metadata.yaml, so that it is no bag of ROS 2; name a file",
        ),
        (["check", "y", "good.csv"], "good.csv has no column 'y'; columns: time, x"),
        (
            ["check", "always[0:300ms](x > 0)", "good.csv"],
            "good.csv: The operator bound must be a multiple of the sampling period: "
            "300 ms is not a whole number of periods of 1 s; change the bound or the period "
            "(the period was taken from the timestamps; period=, or on the command line --period, sets it)\n"
            "  line 1, column 7:\n"
            "    always[0:300ms](x > 0)\n"
            "          ^^^^^^^^^",
        ),
        (
            ["check", "x", "good.csv", "--period", "2"],
            "good.csv: sample 1 at 1 s is 1 s after the one before, expected 2 s (within 10%): "
            "give the right period, resample the trace, or use dense time (time='dense', "
            "on the command line --time dense)",
        ),
        (
            ["monitor", "always(x)", "--verdict", "delayed"],
            "'always' without an upper bound needs the whole future and cannot be monitored online; "
            "give it a bound, such as always[0:10], evaluate the finished trace offline, "
            "or monitor its bounds or verdicts (verdict='interval', 'eager')\n"
            "  line 1, column 1:\n"
            "    always(x)\n"
            "    ^^^^^^^^^",
        ),
        (["operators", "untl"], "there is no operator 'untl'; did you mean 'until'?; see 'rtamt operators'"),
    ],
)
def test_messages(run, args, message):
    assert run(*args) == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize(
    ("stdin", "message"),
    [
        ("", "stdin has no samples: give one JSON object per line, or CSV with a header row"),
        ("time,x\n", "stdin has no samples: give one JSON object per line, or CSV with a header row"),
        (
            '[1, 2]\n{"x": 1}\n',
            'stdin, line 1: expected a JSON object, such as {"time": 0, "x": 1}, '
            "or a row of CSV column names, "
            "got '[1, 2]'",
        ),
        (
            "*" * 100,
            'stdin, line 1: expected a JSON object, such as {"time": 0, "x": 1}, '
            "or a row of CSV column names, "
            f"got '{'*' * 60}...'",
        ),
        (
            "\n1,2\n",
            "stdin, line 2: expected a row of column names, such as time,x; got '1,2': put the names above it",
        ),
        ("time,y\n", "stdin has no column 'x'; columns: time, y"),
        (
            "time [day],x\n",
            "stdin, line 1: the unit of the time column 'time [day]' is 'day', which is none of h, min, s, ms, us, ns",
        ),
        ("time,x\n0\n", "stdin, line 2: 1 value, but 2 columns (time, x)"),
        (
            "time,x\n0,\n",
            "stdin, line 2: 'x' is missing at sample 0, but discrete time needs a value at "
            "every sample: fill the gap, or use dense time (--time dense); --verdict eager and "
            "--verdict interval take missing samples",
        ),
        ('time,x\n0,"' + "1" * 200_000, "stdin, line 2: field larger than field limit (131072)"),
        ('{"x": 1\n', "stdin, line 1: not JSON: Expecting ',' delimiter at column 8"),
        (
            '{"x": ' + "[" * 100_000,
            "stdin, line 1: not JSON to read: a number is too long, or nesting too deep",
        ),
        ('{"y": 1}\n', "stdin, line 1: the data has no 'x'; signals: y"),
        (
            '{"x": null}\n',
            "stdin, line 1: 'x' is missing at sample 0, but discrete time needs a value at "
            "every sample: fill the gap, or use dense time (--time dense); --verdict eager and "
            "--verdict interval take missing samples",
        ),
        ('{"x": "abc"}\n', "stdin, line 1: 'x' is \"abc\", expected a number"),
        (
            '{"x": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14]}\n',
            "stdin, line 1: 'x' is [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, ..., expected a number",
        ),
        (
            '{"x": 1' + "0" * 400 + "}\n",
            f"stdin, line 1: 'x' is 1{'0' * 39}..., beyond the range of a double",
        ),
        (
            '{"x": NaN}\n',
            "stdin, line 1: 'x' is NaN at sample 0, time 0 s: fill the gap or leave the sample out",
        ),
        (
            '{"time": "now", "x": 1}\n',
            "stdin, line 1: 'time' is \"now\", expected a number, or a date such as 2026-05-01T12:00:00.5",
        ),
        (
            '{"time": "2026-02-30", "x": 1}\n',
            "stdin, line 1: 'time' is '2026-02-30', which is no date of the calendar",
        ),
        (b'{"x": "\xff"}\n', "stdin, line 1: not UTF-8 text"),
    ],
)
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_messages_about_the_first_sample(run, stdin, message, backend):
    assert run("monitor", "x", "--backend", backend, stdin=stdin) == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("3", 'expected a JSON object, such as {"time": 0, "x": 1}, got 3'),
        ('{"x": 1}', "the data has no 'time'; signals: x"),
        (
            '{"time": 2, "x": 1}',
            "sample 1 at 2 s is 2 s after the one before, expected 1 s (within 10%): "
            "give the right period, resample the trace, or use dense time (time='dense', "
            "on the command line --time dense)",
        ),
        ('{"time": Infinity, "x": 1}', "the time column 'time' is inf at sample 1, expected a finite number"),
    ],
)
def test_messages_about_a_later_sample(run, line, message):
    answer = run("monitor", "x", stdin=f'{{"time": 0, "x": 1}}\n{line}\n')
    assert answer == (2, '{"time": 0.0, "robustness": 1.0}\n', f"rtamt: stdin, line 2: {message}\n")


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_value_that_does_not_exist(run, backend):
    answer = run("monitor", "sqrt(x) >= 1", "--backend", backend, stdin='{"x": -1}\n')
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("rtamt: stdin, line 1: 'sqrt(x)' has no value at sample 0, time 0 s")


def test_without_the_core_the_way_out_is_named(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "rtamt.engine._core", None)
    monkeypatch.delattr("rtamt.engine._core", raising=False)
    answer = run("check", "x", "good.csv")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("rtamt: the compiled core cannot be loaded (")
    assert answer.err.endswith(USE_PYTHON)
    assert run("check", "x", "good.csv", "--backend", "python").code == 0


def test_a_specification_file_that_cannot_be_decoded(run, tmp_path):
    (tmp_path / "odd.stl").write_bytes(b"always(x >= \xff)")
    assert run("info", "odd.stl") == (
        2,
        "",
        "rtamt: 'odd.stl' is not UTF-8 text (byte 12); is it a specification?\n",
    )


def test_every_bad_trace_is_named_and_no_table_is_printed_where_none_is_good(run):
    assert run("check", "x", "a.csv", "b.csv") == (
        2,
        "",
        "rtamt: there is no file 'a.csv'\nrtamt: there is no file 'b.csv'\n",
    )


def test_a_mistake_of_ours_is_a_sentence_too(run, monkeypatch):
    def broken(*_args, **_options):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("rtamt.cli.command.parse", broken)
    message = "rtamt: internal error, please report it: ZeroDivisionError: division by zero\n"
    assert run("info", "x") == (2, "", message)


def test_a_window_that_no_machine_can_hold(run, monkeypatch):
    def broken(*_args, **_options):
        raise MemoryError

    monkeypatch.setattr("rtamt.cli.command.parse", broken)
    message = "rtamt: not enough memory: are the bounds of a window as large as they should be?\n"
    assert run("info", "x") == (2, "", message)


def test_interrupt_is_quiet(run, monkeypatch):
    def interrupted(*_args, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr("rtamt.cli.command.parse", interrupted)
    assert run("info", "x") == (130, "", "")


def test_a_trace_that_may_not_be_read(run, monkeypatch):
    def denied(*_args, **_options):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("builtins.open", denied)
    assert run("check", "x", "good.csv") == (2, "", "rtamt: cannot read 'good.csv': Permission denied\n")


@pytest.mark.parametrize("command", ["check", "monitor", "info"])
def test_an_unknown_semantics(run, command):
    traces = ["log.csv"] if command == "check" else []
    assert run(command, "x >= 3", *traces, "--semantics", "vacuity") == (
        2,
        "",
        "rtamt: unknown semantics 'vacuity'; did you mean 'input_vacuity'? (semantics: input_vacuity, "
        "output_vacuity, standard, output_robustness, input_robustness, boolean)\n",
    )
