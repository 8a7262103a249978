"""Results for tools of robotics and telemetry: MCAP files with a Foxglove layout, Rerun, MLflow.

All of them show the same content: the signals that requirements read and, for each requirement, robustness, bounds,
verdict and episodes of violation, at the times of the trace in nanoseconds. Metrics of running monitors, for Prometheus
and OpenTelemetry, are those of :mod:`rtamt.metrics`.

=========  ==========================================================
module     purpose
=========  ==========================================================
content    what is exported of a result
messages   the topics, the schemas and the messages
mcap       messages as an MCAP file
foxglove   a layout of Foxglove for the topics
rerun      content as a recording of Rerun
mlflow     metrics and plots of a run of MLflow
=========  ==========================================================
"""

from rtamt.telemetry.foxglove import layout
from rtamt.telemetry.mcap import write_mcap
from rtamt.telemetry.mlflow import log_mlflow, metrics
from rtamt.telemetry.rerun import log_rerun

__all__ = ["layout", "log_mlflow", "log_rerun", "metrics", "write_mcap"]
