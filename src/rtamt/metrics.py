"""Metrics of what runs for long: workers, ``rtamt monitor`` and ROS nodes, for Prometheus and OpenTelemetry.

:data:`METRICS` is the list of all; exporters, nodes and the dashboard in ``examples/fleet`` use its names alone. Needs
``rtamt[metrics]`` for exporting; metrics themselves need nothing.
"""

from __future__ import annotations

import threading
from contextlib import contextmanager
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Mapping

#: Where metrics are served by default: for this machine alone.
LOCALHOST = "127.0.0.1"
_PROMETHEUS, _OPEN_TELEMETRY = "exporting to Prometheus", "exporting to OpenTelemetry"
#: The verdicts of a robustness; its sign does not decide it at 0.
SATISFIED, VIOLATED, UNDECIDED = "satisfied", "violated", "undecided"


class Metric(NamedTuple):
    """A metric: counters only grow, a gauge is the latest value."""

    name: str
    kind: str
    doc: str
    labels: tuple[str, ...] = ()


METRICS: Mapping[str, Metric] = MappingProxyType(
    {
        each.name: each
        for each in (
            Metric("rtamt_samples_total", "counter", "samples that monitors have taken"),
            Metric(
                "rtamt_verdicts_total",
                "counter",
                "verdicts that have become known: satisfied, violated, or undecided at robustness 0",
                ("requirement", "verdict"),
            ),
            Metric("rtamt_violations_total", "counter", "verdicts that are violations", ("requirement",)),
            Metric(
                "rtamt_robustness",
                "gauge",
                "the latest robustness; of a worker, the lowest of its latest batch",
                ("requirement",),
            ),
            Metric(
                "rtamt_late_total",
                "counter",
                "samples that came too late: after a newer one of their key, or later than the lateness",
            ),
            Metric(
                "rtamt_rejected_total",
                "counter",
                "messages that are no samples, and samples with wrong values",
            ),
            Metric(
                "rtamt_expired_total",
                "counter",
                "keys that have expired, because no message of them came for long",
            ),
            Metric("rtamt_keys", "gauge", "keys, such as vehicles, that are monitored"),
            Metric(
                "rtamt_lag_messages",
                "gauge",
                "messages of the broker that have not been read",
                ("partition",),
            ),
            Metric("rtamt_lag_seconds", "gauge", "the clock minus the time of the latest sample"),
        )
    }
)

Labels = tuple[tuple[str, str], ...]


class Metrics:
    """The values of metrics; threads may change and read them.

    >>> metrics = Metrics()
    >>> metrics.known("SPEED", -1.5)
    >>> metrics.values("rtamt_violations_total")
    {(('requirement', 'SPEED'),): 1.0}
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._values: dict[str, dict[Labels, float]] = {name: {} for name in METRICS}

    def count(self, name: str, by: float = 1, **labels: str) -> None:
        """Increase a counter."""
        place = _labels(name, "counter", labels)
        with self._lock:
            known = self._values[name]
            known[place] = known.get(place, 0.0) + by

    def set(self, name: str, value: float, **labels: str) -> None:
        """Set a gauge."""
        place = _labels(name, "gauge", labels)
        with self._lock:
            self._values[name][place] = float(value)

    def replace(self, name: str, label: str, values: Mapping[str, float]) -> None:
        """Set a gauge for exactly these values of its label: others, such as revoked partitions, are dropped."""
        with self._lock:
            self._values[name] = {
                _labels(name, "gauge", {label: each}): float(v) for each, v in values.items()
            }

    def known(self, requirement: str, robustness: float) -> None:
        """Note a robustness that has become known, and its verdict."""
        self.set("rtamt_robustness", robustness, requirement=requirement)
        self.verdict(requirement, None if robustness == 0 else robustness > 0)

    def verdict(self, requirement: str, satisfied: bool | None, by: int = 1) -> None:
        """Note verdicts that have become known; None: undecided."""
        name = UNDECIDED if satisfied is None else SATISFIED if satisfied else VIOLATED
        self.count("rtamt_verdicts_total", by, requirement=requirement, verdict=name)
        self.count("rtamt_violations_total", by if name == VIOLATED else 0, requirement=requirement)

    def values(self, name: str) -> dict[Labels, float]:
        """Return the values of a metric by label; a counter without labels is 0 before it is counted."""
        metric = METRICS[name]
        with self._lock:
            found = dict(self._values[name])
        return found or ({(): 0.0} if metric.kind == "counter" and not metric.labels else {})


def _labels(name: str, kind: str, given: Mapping[str, str]) -> Labels:
    metric = METRICS[name]
    if metric.kind != kind or tuple(given) != metric.labels:
        raise UsageError(f"'{name}' is a {metric.kind} with the labels {', '.join(metric.labels) or 'none'}")
    return tuple(given.items())


# ---- exporters -----------------------------------------------------------------------------------


class _Collector:
    """A collector that reads the metrics whenever Prometheus does."""

    def __init__(self, metrics: Metrics) -> None:
        self._metrics = metrics
        core = library("prometheus_client.core", _PROMETHEUS, "metrics")
        self._families = {"counter": core.CounterMetricFamily, "gauge": core.GaugeMetricFamily}

    def describe(self) -> list[Any]:
        return []

    def collect(self) -> Iterator[Any]:
        for metric in METRICS.values():
            family = self._families[metric.kind](metric.name, metric.doc, labels=metric.labels)
            for labels, value in self._metrics.values(metric.name).items():
                family.add_metric([text for _, text in labels], value)
            yield family


def prometheus_text(metrics: Metrics) -> str:
    """Return the metrics for Prometheus."""
    prometheus = library("prometheus_client", _PROMETHEUS, "metrics")
    registry = prometheus.CollectorRegistry()
    registry.register(_Collector(metrics))
    text: str = prometheus.generate_latest(registry).decode()
    return text


@contextmanager
def prometheus(metrics: Metrics, address: str) -> Iterator[int]:
    """Serve metrics at ``PORT`` of this machine alone, or at ``HOST:PORT``; yield the port, which is chosen for 0."""
    client = library("prometheus_client", _PROMETHEUS, "metrics")
    host, _, port = address.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise UsageError(f"the address of metrics is '{address}', expected PORT or HOST:PORT, such as 9464")
    registry = client.CollectorRegistry()
    registry.register(_Collector(metrics))
    try:
        server, thread = client.start_http_server(int(port), host.strip("[]") or LOCALHOST, registry)
    except OSError as error:
        raise UsageError(f"cannot serve metrics at '{address}': {error.strerror or error}") from None
    try:
        yield server.server_address[1]
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


@contextmanager
def open_telemetry(metrics: Metrics, reader: Any) -> Iterator[None]:
    """Let a reader of OpenTelemetry, such as one that exports periodically, read metrics; it is flushed at the end."""
    sdk = library("opentelemetry.sdk.metrics", _OPEN_TELEMETRY, "metrics")
    observation = library("opentelemetry.metrics", _OPEN_TELEMETRY, "metrics").Observation
    resources = library("opentelemetry.sdk.resources", _OPEN_TELEMETRY, "metrics")
    provider = sdk.MeterProvider(
        [reader], resources.Resource.create({"service.name": "rtamt"}), shutdown_on_exit=False
    )
    meter = provider.get_meter("rtamt")

    def observe(name: str) -> Any:
        return lambda _: [observation(value, dict(labels)) for labels, value in metrics.values(name).items()]

    make = {"counter": meter.create_observable_counter, "gauge": meter.create_observable_gauge}
    for metric in METRICS.values():
        make[metric.kind](metric.name, [observe(metric.name)], description=metric.doc)
    try:
        yield
    finally:
        provider.shutdown()


@contextmanager
def otlp(metrics: Metrics, url: str) -> Iterator[None]:
    """Send metrics to a collector of OpenTelemetry, by OTLP over HTTP: ``http://localhost:4318/v1/metrics``."""
    if not url.startswith(("http://", "https://")):
        raise UsageError(
            f"the collector is '{url}', expected an address such as http://localhost:4318/v1/metrics"
        )
    export = library("opentelemetry.sdk.metrics.export", _OPEN_TELEMETRY, "metrics")
    sender = library("opentelemetry.exporter.otlp.proto.http.metric_exporter", _OPEN_TELEMETRY, "metrics")
    reader = export.PeriodicExportingMetricReader(sender.OTLPMetricExporter(endpoint=url, timeout=10))
    with open_telemetry(metrics, reader):
        yield


# ---- options of programs -------------------------------------------------------------------------


def add_metrics_options(parser: Any) -> None:
    """Add the options of exporters to a parser or a group of options."""
    parser.add_argument(
        "--metrics",
        metavar="[HOST:]PORT",
        help="serve metrics for Prometheus, without HOST for this machine alone, such as 9464",
    )
    parser.add_argument(
        "--otlp",
        metavar="URL",
        help="send metrics to a collector of OpenTelemetry, such as http://localhost:4318/v1/metrics",
    )


@contextmanager
def exported(args: argparse.Namespace) -> Iterator[Metrics | None]:
    """Yield the metrics that the options of a program export; None without such an option."""
    if args.metrics is None and args.otlp is None:
        yield None
        return
    metrics = Metrics()
    if args.otlp is None:
        with prometheus(metrics, args.metrics):
            yield metrics
        return
    with otlp(metrics, args.otlp):
        if args.metrics is None:
            yield metrics
        else:
            with prometheus(metrics, args.metrics):
                yield metrics
