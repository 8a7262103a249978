"""Metrics: one list for all programs; what Prometheus, OpenTelemetry and the dashboard see of it."""

import json
import re
import socket
import sys
import threading
from argparse import Namespace
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from types import SimpleNamespace
from urllib.request import ProxyHandler, build_opener

import pytest

import rtamt
from rtamt.metrics import METRICS, Metrics, exported, open_telemetry, prometheus, prometheus_text
from rtamt.ros import RosMonitor, bind
from rtamt.ros.metrics import note

DASHBOARD = Path(__file__).parents[2] / "examples" / "fleet" / "grafana.json"


def filled():
    """Return metrics with a value of each."""
    metrics = Metrics()
    for robustness in (2.0, -1.5, 0.0):
        metrics.known("SPEED", robustness)
    for name in ("rtamt_samples_total", "rtamt_late_total", "rtamt_rejected_total"):
        metrics.count(name, 3)
    metrics.set("rtamt_keys", 7)
    metrics.set("rtamt_lag_seconds", 0.5)
    metrics.replace("rtamt_lag_messages", "partition", {"0": 4, "1": 5})
    return metrics


SPEED = (("requirement", "SPEED"),)


def test_values():
    metrics = filled()
    assert metrics.values("rtamt_robustness") == {SPEED: 0.0}
    assert metrics.values("rtamt_violations_total") == {SPEED: 1.0}
    assert metrics.values("rtamt_verdicts_total") == {
        (*SPEED, ("verdict", verdict)): 1.0 for verdict in ("satisfied", "violated", "undecided")
    }
    metrics.replace("rtamt_lag_messages", "partition", {"1": 2})
    assert metrics.values("rtamt_lag_messages") == {(("partition", "1"),): 2.0}
    assert Metrics().values("rtamt_late_total") == {(): 0.0}
    assert Metrics().values("rtamt_keys") == {}
    for wrong in (
        lambda: metrics.set("rtamt_late_total", 1),
        lambda: metrics.count("rtamt_late_total", key="a"),
    ):
        with pytest.raises(rtamt.UsageError) as caught:
            wrong()
        assert str(caught.value) == "'rtamt_late_total' is a counter with the labels none"


def sample_names(text):
    return {re.match(r"\w+", line)[0] for line in text.splitlines() if not line.startswith("#")}


def test_prometheus_reads_every_metric():
    text = prometheus_text(filled())
    assert sample_names(text) == set(METRICS)
    for metric in METRICS.values():
        assert f"# TYPE {metric.name} {metric.kind}" in text
        assert f"# HELP {metric.name} {metric.doc}" in text
    assert 'rtamt_verdicts_total{requirement="SPEED",verdict="violated"} 1.0' in text
    assert 'rtamt_lag_messages{partition="1"} 5.0' in text


def read(port, host="127.0.0.1"):
    with build_opener(ProxyHandler({})).open(f"http://{host}:{port}/metrics", timeout=10) as answer:
        return answer.read().decode()


def test_prometheus_is_served_to_this_machine_alone():
    metrics = filled()
    with prometheus(metrics, "0") as port:
        assert sample_names(read(port)) == set(METRICS)
        metrics.count("rtamt_samples_total")
        assert "rtamt_samples_total 4.0" in read(port)
        with pytest.raises(
            rtamt.UsageError, match=rf"^cannot serve metrics at '{port}': Address already in use"
        ):
            prometheus(metrics, str(port)).__enter__()
        # Whatever else listens on all addresses would hold this one, too.
        with socket.socket() as other:
            other.bind(("127.0.0.2", port))
    with socket.socket() as again:
        again.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.bind(("127.0.0.1", port))


def test_open_telemetry_reads_every_metric():
    from opentelemetry.sdk.metrics.export import InMemoryMetricReader

    reader = InMemoryMetricReader()
    with open_telemetry(filled(), reader):
        (resource,) = reader.get_metrics_data().resource_metrics
        found = {
            metric.name: {tuple(point.attributes.items()): point.value for point in metric.data.data_points}
            for scope in resource.scope_metrics
            for metric in scope.metrics
        }
    assert resource.resource.attributes["service.name"] == "rtamt"
    assert found == {name: filled().values(name) for name in METRICS}


@pytest.fixture
def collector():
    """Yield the address of a collector of OpenTelemetry, and the requests that it got."""
    got = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            got.append((self.path, self.headers, self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(200)
            self.end_headers()

        def log_message(self, *_):
            """Print nothing."""

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/v1/metrics", got
    server.shutdown()
    thread.join()
    server.server_close()


def sent(got):
    """Return the values that a collector has at the end."""
    import gzip

    from opentelemetry.proto.collector.metrics.v1.metrics_service_pb2 import ExportMetricsServiceRequest

    path, headers, body = got[-1]
    assert path == "/v1/metrics"
    body = gzip.decompress(body) if headers["Content-Encoding"] == "gzip" else body
    found = {}
    for resource in ExportMetricsServiceRequest.FromString(body).resource_metrics:
        for scope in resource.scope_metrics:
            for metric in scope.metrics:
                data = metric.sum if metric.HasField("sum") else metric.gauge
                for point in data.data_points:
                    labels = tuple((each.key, each.value.string_value) for each in point.attributes)
                    found[(metric.name, *labels)] = point.as_double
    return found


def monitor(run, collector, *more):
    lines = '{"time": 0, "speed": 25}\n{"time": 1, "speed": 31}\nnonsense\n{"time": 2, "speed": 28}\n'
    url, _ = collector
    return run("monitor", *more, "--keep-going", "--otlp", url, stdin=lines)


@pytest.fixture
def run(monkeypatch, capsys):
    """Return a function that runs the command line with text on stdin."""
    import io

    def call(*args, stdin=""):
        monkeypatch.setattr(
            sys, "stdin", SimpleNamespace(buffer=io.BytesIO(stdin.encode()), isatty=lambda: False)
        )
        code = rtamt.cli.main(list(args))
        return code, capsys.readouterr()

    import rtamt.cli

    return call


def test_the_monitor_of_a_stream(run, collector):
    code, said = monitor(run, collector, "speed <= 30")
    assert (code, len(said.out.splitlines())) == (2, 3)
    found = sent(collector[1])
    name = ("requirement", "requirement")
    assert found[("rtamt_robustness", name)] == 2.0
    assert found[("rtamt_verdicts_total", name, ("verdict", "satisfied"))] == 2
    assert found[("rtamt_violations_total", name)] == 1
    assert (found[("rtamt_samples_total",)], found[("rtamt_rejected_total",)]) == (3, 1)


def test_the_monitor_of_several_requirements_in_dense_time(run, collector):
    text = "require LOW: speed <= 30\nrequire HIGH: speed >= 20"
    monitor(run, collector, text, "--time", "dense")
    found = sent(collector[1])
    assert found[("rtamt_violations_total", ("requirement", "LOW"))] == 1
    assert found[("rtamt_violations_total", ("requirement", "HIGH"))] == 0


def test_early_verdicts_have_no_robustness(run, collector):
    _, said = monitor(run, collector, "speed <= 30", "--verdict", "eager")
    assert said.err == (
        "rtamt: metrics are those of the robustness: leave out --metrics and --otlp, or use --verdict delayed\n"
    )


def test_a_node_of_ros():
    requirement = """
        from rtamt_msgs.msg import FloatStamped
        input FloatStamped req  output FloatStamped rob
        rob.value = once[0:1](req.value >= 3)"""
    node = RosMonitor(bind(rtamt.parse(requirement)), period=1)
    metrics = Metrics()
    for second, value in enumerate((5.0, 2.0, 1.0, 1.0)):
        now = second * 10**9 + 5 * 10**8
        note(metrics, node.message("rtamt/req", SimpleNamespace(value=value), now), now + 25 * 10**7)
    note(None, node.tick(5 * 10**9), 5 * 10**9)
    (output,) = node.binding.outputs
    name = ("requirement", output.name)
    assert metrics.values("rtamt_robustness") == {(name,): -2.0}
    assert metrics.values("rtamt_violations_total") == {(name,): 2.0}
    assert metrics.values("rtamt_samples_total") == {(): 4.0}
    assert metrics.values("rtamt_lag_seconds") == {(): 0.25}


def queried(board):
    return {
        name
        for panel in board["panels"]
        for target in panel["targets"]
        for name in re.findall(r"\brtamt_\w+", target["expr"])
    }


def test_the_dashboard_queries_every_metric_and_no_other():
    board = json.loads(DASHBOARD.read_text())
    assert queried(board) == set(METRICS) == sample_names(prometheus_text(filled()))
    labels = {label for metric in METRICS.values() for label in metric.labels} | {"instance"}
    for panel in board["panels"]:
        for target in panel["targets"]:
            for group in re.findall(r"by \(([^)]*)\)", target["expr"]):
                assert set(group.split(", ")) <= labels
    assert len({panel["id"] for panel in board["panels"]}) == len(board["panels"])


def test_mistakes_in_options():
    for given, error in (
        (
            {"metrics": "localhost", "otlp": None},
            "the address of metrics is 'localhost', expected PORT or HOST:PORT, such as 9464",
        ),
        (
            {"metrics": None, "otlp": "localhost:4318"},
            "the collector is 'localhost:4318', expected an address such as http://localhost:4318/v1/metrics",
        ),
    ):
        with pytest.raises(rtamt.UsageError) as caught, exported(Namespace(**given)):
            pass
        assert str(caught.value) == error
    with exported(Namespace(metrics=None, otlp=None)) as metrics:
        assert metrics is None


def test_without_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "prometheus_client", None)
    with pytest.raises(rtamt.UsageError) as caught, exported(Namespace(metrics="0", otlp=None)):
        pass
    assert str(caught.value) == (
        "exporting to Prometheus needs the package 'prometheus_client', which is not installed: "
        "pip install 'rtamt[metrics]'"
    )
