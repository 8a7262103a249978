"""Metrics and plots of a result in a run of MLflow."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.telemetry.content import content_of, results_by_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.results import Result
    from rtamt.telemetry.content import Content

#: The folder of the artifacts.
FOLDER = "rtamt"
_SECOND = 10**9


def metrics(result: Result | Mapping[str, Result]) -> dict[str, float]:
    """Return the metrics of a result, with names that MLflow accepts.

    For each requirement: ``robustness``, or ``robustness_lower`` and ``robustness_upper`` if samples are missing or
    uncertain; ``satisfied``, 1 or 0, unless the samples do not decide it; ``first_violation``, in seconds after the
    start of the trace, if there is one; and the number of ``episodes`` of violation.

    >>> import rtamt
    >>> metrics(rtamt.parse("require LOW: always(x <= 3)").evaluate({"time": [5, 6], "x": [1, 4]}))
    {'LOW/robustness': -1.0, 'LOW/satisfied': 0.0, 'LOW/first_violation': 1.0, 'LOW/episodes': 1.0}
    """
    return _metrics(content_of(result))


def log_mlflow(
    result: Result | Mapping[str, Result], *, plots: bool = True, report: str | os.PathLike[str] | None = None
) -> None:
    """Log the metrics of a result, and plots as artifacts, to the active run of MLflow.

    If no run is active, MLflow starts one. ``plots``: a plot of each requirement, as by :meth:`Result.plot`;
    results of missing or uncertain samples have none. ``report``: a page of ``rtamt report``, also stored as an
    artifact. Artifacts are in the folder ``rtamt``.

    Raises :class:`UsageError` if the package ``mlflow`` is missing, matplotlib is for plots, or there is no such
    report.
    """
    mlflow = library("mlflow", "logging to MLflow", "mlflow")
    if report is not None and not os.path.isfile(report):
        raise UsageError(f"there is no report '{os.fspath(report)}'; write it with 'rtamt report'")
    content = content_of(result)
    figures = {}
    if plots:
        figure_module = library("matplotlib.figure", "plotting", "plot")
        parts = results_by_name(result)
        for finding in content.findings:
            part = parts[finding.name]
            if not part.trace.bounds:
                figures[finding.key] = part.plot(figure=figure_module.Figure())
    mlflow.log_metrics(_metrics(content))
    for key, figure in figures.items():
        mlflow.log_figure(figure, f"{FOLDER}/{key}.png")
    if report is not None:
        mlflow.log_artifact(os.fspath(report), FOLDER)


def _metrics(content: Content) -> dict[str, float]:
    found: dict[str, float] = {}
    for finding in content.findings:
        lower, upper = float(finding.robustness.lower[0]), float(finding.robustness.upper[0])
        known = (
            {"robustness": lower}
            if lower == upper
            else {"robustness_lower": lower, "robustness_upper": upper}
        )
        if finding.satisfied is not None:
            known["satisfied"] = float(finding.satisfied)
        if finding.first_violation is not None:
            known["first_violation"] = (finding.first_violation - finding.start) / _SECOND
        known["episodes"] = float(len(finding.episodes))
        found |= {f"{finding.key}/{name}": value for name, value in known.items()}
    return found
