"""What is sent to Rerun, received by functions with the signatures of rerun-sdk 0.41, whose wheel has 170 MB."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import rtamt
from rtamt.telemetry import log_rerun
from tests.unit.telemetry.results import EPOCH, drive

SPEED = "/rtamt/requirements/SPEED"


class Rerun:
    """Keeps the columns of each entity; a recording that is saved writes a file."""

    def __init__(self):
        self.sent = {}
        self.recordings = []

        class Scalars:
            @staticmethod
            def columns(*, scalars=None):
                return np.asarray(scalars).tolist()

        class TextLog:
            @staticmethod
            def columns(*, text=None, level=None, color=None):
                assert color is None
                return list(zip(text, level, strict=True))

        fake = self

        class RecordingStream:
            def __init__(self, application_id, *, recording_id=None, make_default=False):
                assert (application_id, recording_id, make_default) == ("rtamt", None, False)
                self.path = None

            def save(self, path, default_blueprint=None, *, write_footer=True):
                assert write_footer is True
                self.path, fake.blueprint = path, default_blueprint

            def disconnect(self):
                Path(self.path).write_text("recording")

        self.blueprint = None
        self.Scalars, self.TextLog, self.RecordingStream = Scalars, TextLog, RecordingStream

    def TimeColumn(self, timeline, *, sequence=None, duration=None, timestamp=None):  # noqa: N802 - the name of Rerun
        assert (timeline, sequence) == ("time", None)
        return duration if timestamp is None else timestamp

    def send_columns(self, entity_path, indexes, columns, *, recording=None, strict=None):
        assert strict is None
        (times,) = indexes
        assert len(times) == len(columns)
        self.recordings.append(recording)
        self.sent[entity_path] = (times.dtype.str[1:], times.astype(np.int64).tolist(), columns)


class Blueprints:
    """Panels as tuples, with the signatures of rerun.blueprint."""

    @staticmethod
    def TimeSeriesView(*, origin="/", contents="$origin/**", name=None):  # noqa: N802 - the name of Rerun
        assert origin == "/"
        return "plot", name, contents

    @staticmethod
    def TextLogView(*, origin="/", contents="$origin/**", name=None):  # noqa: N802 - the name of Rerun
        assert origin == "/"
        return "list", name, contents

    @staticmethod
    def Vertical(*contents, row_shares=None, name=None):  # noqa: N802 - the name of Rerun
        assert row_shares is None
        return name, *contents

    @staticmethod
    def Horizontal(*contents, column_shares=None, name=None):  # noqa: N802 - the name of Rerun
        assert (len(column_shares), name) == (len(contents), None)
        return contents

    @staticmethod
    def Tabs(*contents, active_tab=None, name=None):  # noqa: N802 - the name of Rerun
        assert active_tab is name is None
        return contents

    @staticmethod
    def Blueprint(*parts, auto_layout=None, auto_views=None, collapse_panels=False):  # noqa: N802 - the name of Rerun
        assert (auto_layout, auto_views, collapse_panels) == (None, None, False)
        return parts


@pytest.fixture
def rerun(monkeypatch):
    fake = Rerun()
    monkeypatch.setitem(sys.modules, "rerun", fake)
    monkeypatch.setitem(sys.modules, "rerun.blueprint", Blueprints)
    return fake


def test_signals_and_robustness_are_scalars_and_verdicts_and_violations_are_text(rerun):
    log_rerun(drive(), bounds=True)
    second = 10**9
    every = [0, second, 2 * second, 3 * second, 4 * second]
    assert rerun.sent["/rtamt/signals/speed"] == ("m8[ns]", every, [20, 32, 31, 20, 33])
    assert rerun.sent[f"{SPEED}/robustness"] == ("m8[ns]", every, [-3, -3, -3, -3, -3])
    assert rerun.sent[f"{SPEED}/interval/lower"] == rerun.sent[f"{SPEED}/robustness"]
    assert rerun.sent[f"{SPEED}/known/upper"] == ("m8[ns]", every, [10, -2, -2, -2, -3])
    assert rerun.sent[f"{SPEED}/verdict"] == ("m8[ns]", [0], [("SPEED: violated", "ERROR")])
    assert rerun.sent[f"{SPEED}/violations"] == (
        "m8[ns]",
        [second, 2 * second, 4 * second, 4 * second],
        [
            ("SPEED: violation begins, worst robustness -2", "ERROR"),
            ("SPEED: violation ends, worst robustness -2", "INFO"),
            ("SPEED: violation begins, worst robustness -3", "ERROR"),
            ("SPEED: violation ends, worst robustness -3", "INFO"),
        ],
    )
    assert "/rtamt/requirements/BRAKE/violations" not in rerun.sent
    assert set(rerun.recordings) == {None}  # the current one


def test_dates_are_timestamps(rerun):
    for times, options in (
        (np.array([EPOCH, EPOCH + 10**9], "M8[ns]"), {}),
        ([EPOCH, EPOCH + 10**9], {"time_unit": "ns"}),
    ):
        log_rerun(rtamt.parse("x >= 3").evaluate({"time": times, "x": [5, 1]}, **options))
        assert rerun.sent["/rtamt/signals/x"] == ("M8[ns]", [EPOCH, EPOCH + 10**9], [5, 1])


def test_uncertain_samples_are_two_lines(rerun):
    log_rerun(rtamt.parse("x >= 3").evaluate({"x": [1, 2]}, uncertainty={"x": 0.5}))
    assert rerun.sent["/rtamt/signals/x/lower"][2] == [0.5, 1.5]
    assert rerun.sent["/rtamt/signals/x/upper"][2] == [1.5, 2.5]
    assert "/rtamt/signals/x" not in rerun.sent


def test_a_recording_is_given(rerun):
    mine = SimpleNamespace()
    log_rerun(drive(), recording=mine)
    assert all(each is mine for each in rerun.recordings)


def test_a_file_is_written_as_a_whole(rerun, tmp_path):
    log_rerun(drive(), tmp_path / "drive.rrd")
    assert [path.name for path in tmp_path.iterdir()] == ["drive.rrd"]
    assert (tmp_path / "drive.rrd").read_text() == "recording"
    assert len({id(each) for each in rerun.recordings}) == 1


def plots(blueprint):
    """Return the lines of each plot by its name, and the texts of the list."""
    ((pages, (_, _, texts)),) = blueprint
    return {name: contents for _, *panels in pages for _, name, contents in panels}, texts


def test_a_file_has_a_layout_whose_entities_are_in_it(rerun, tmp_path):
    log_rerun(drive(), tmp_path / "drive.rrd", bounds=True)
    found, texts = plots(rerun.blueprint)
    assert found["SPEED: signals"] == ["/rtamt/signals/speed"]
    assert found["SPEED: robustness"] == [
        f"{SPEED}/robustness",
        f"{SPEED}/known/lower",
        f"{SPEED}/known/upper",
    ]
    assert list(found) == ["SPEED: signals", "SPEED: robustness", "BRAKE: signals", "BRAKE: robustness"]
    assert {line for lines in found.values() for line in lines} <= set(rerun.sent)
    assert {text for text in texts if "BRAKE/violations" not in text} <= set(rerun.sent)
    log_rerun(rtamt.parse("x >= 3").evaluate({"x": [1, 2]}, uncertainty={"x": 0.5}), tmp_path / "x.rrd")
    found, _ = plots(rerun.blueprint)
    assert [line for lines in found.values() for line in lines] == [
        "/rtamt/signals/x/lower",
        "/rtamt/signals/x/upper",
        "/rtamt/requirements/requirement_1/interval/lower",
        "/rtamt/requirements/requirement_1/interval/upper",
    ]
    log_rerun(rtamt.parse("true").evaluate({"time": [0, 1]}), tmp_path / "x.rrd")
    assert len(plots(rerun.blueprint)[0]) == 1


@pytest.mark.usefixtures("rerun")
def test_a_file_that_cannot_be_written(tmp_path):
    with pytest.raises(rtamt.TraceError) as error:
        log_rerun(drive(), tmp_path / "none" / "x.rrd")
    assert str(error.value) == f"cannot write '{tmp_path}/none/x.rrd': No such file or directory"


def test_without_the_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(rtamt.UsageError) as error:
        log_rerun(drive())
    assert str(error.value) == (
        "logging to Rerun needs the package 'rerun', which is not installed: pip install 'rtamt[rerun]'"
    )
