"""Metrics and artifacts in a run of MLflow, whose store is a folder."""

import sys
from pathlib import Path

import pytest

import rtamt
from rtamt.telemetry import log_mlflow, metrics
from tests.unit.telemetry.results import EPOCH, drive

DRIVE = {
    "SPEED/robustness": -3.0,
    "SPEED/satisfied": 0.0,
    "SPEED/first_violation": 1.0,
    "SPEED/episodes": 2.0,
    "BRAKE/robustness": 5.0,
    "BRAKE/satisfied": 1.0,
    "BRAKE/episodes": 0.0,
}


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Start a run; return it with the folder of its artifacts."""
    monkeypatch.setenv("MLFLOW_ALLOW_FILE_STORE", "true")
    monkeypatch.chdir(tmp_path)
    import mlflow

    mlflow.set_tracking_uri((tmp_path / "runs").as_uri())
    with mlflow.start_run() as run:
        yield run, Path(mlflow.get_artifact_uri().removeprefix("file://"))


def stored_run(run):
    import mlflow

    return mlflow.get_run(run.info.run_id).data.metrics


def test_metrics_of_each_requirement_and_its_plot(run):
    run, artifacts = run
    log_mlflow(drive())
    assert stored_run(run) == metrics(drive()) == DRIVE
    assert sorted(path.name for path in (artifacts / "rtamt").iterdir()) == ["BRAKE.png", "SPEED.png"]
    assert (artifacts / "rtamt" / "SPEED.png").read_bytes().startswith(b"\x89PNG")


def test_names_that_mlflow_refuses_are_changed(run):
    run, _ = run
    log_mlflow({"wet & dry": rtamt.parse("x >= 3").evaluate({"x": [5]})}, plots=False)
    assert stored_run(run) == {"wet_dry/robustness": 2.0, "wet_dry/satisfied": 1.0, "wet_dry/episodes": 0.0}


def test_infinite_robustness_is_stored(run):
    run, _ = run
    log_mlflow(rtamt.parse("require R: once[1:1](x >= 3)").evaluate({"x": [5]}), plots=False)
    assert stored_run(run)["R/robustness"] == float("-inf")


def test_a_report_is_an_artifact(run, tmp_path):
    _, artifacts = run
    (tmp_path / "report.html").write_text("<p>all</p>")
    log_mlflow(drive(), plots=False, report=tmp_path / "report.html")
    assert [path.name for path in (artifacts / "rtamt").iterdir()] == ["report.html"]


def test_missing_samples_have_bounds_and_neither_a_verdict_nor_a_plot(run):
    run, artifacts = run
    result = rtamt.parse("x >= 3").evaluate({"x": [None]}, ranges={"x": (0, 10)})
    log_mlflow(result)
    name = "requirement_1"
    assert stored_run(run) == {
        f"{name}/robustness_lower": -3.0,
        f"{name}/robustness_upper": 7.0,
        f"{name}/episodes": 0.0,
    }
    assert not (artifacts / "rtamt").exists()


def test_the_first_violation_counts_from_the_start_of_the_trace():
    result = rtamt.parse("require R: always(x >= 3)").evaluate(
        {"time": [EPOCH, EPOCH + 500], "x": [5, 1]}, time_unit="ns"
    )
    assert metrics(result)["R/first_violation"] == 5e-7


def test_there_is_no_such_report():
    with pytest.raises(rtamt.UsageError) as error:
        log_mlflow(drive(), report="none.html")
    assert str(error.value) == "there is no report 'none.html'; write it with 'rtamt report'"


@pytest.mark.parametrize(
    ("module", "message"),
    [
        (
            "mlflow",
            "logging to MLflow needs the package 'mlflow', which is not installed: pip install 'rtamt[mlflow]'",
        ),
        (
            "matplotlib.figure",
            "plotting needs the package 'matplotlib', which is not installed: pip install 'rtamt[plot]'",
        ),
    ],
)
def test_without_a_package(monkeypatch, module, message):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(rtamt.UsageError) as error:
        log_mlflow(drive())
    assert str(error.value) == message
