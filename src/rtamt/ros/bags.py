"""Bags: map variables to columns, and write a copy of a bag with results."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError
from rtamt.extras import library
from rtamt.files import replacing
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.readers.formats import BAG
from rtamt.readers.rosbag import messages, open_reader
from rtamt.ros.message_definitions import DEFINITIONS, FLOAT_STAMPED, SATISFIED, VERDICT, VIOLATED
from rtamt.ros.recording_times import RecordingTimes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rtamt.signals.signal import Signal
    from rtamt.specification import Specification

_HEADER = "std_msgs/msg/Header"


def columns_of(spec: Specification) -> dict[str, str]:
    """Return the column of a bag for every message field that a specification reads.

    >>> import rtamt
    >>> columns_of(rtamt.parse('''
    ...     from nav_msgs.msg import Odometry
    ...     input Odometry odom  @ topic(odom, base/odom)
    ...     always(odom.pose.pose.position.x <= 3)'''))
    {'odom.pose.pose.position.x': '/base/odom.pose.pose.position.x'}
    """
    document = spec.document
    imported = {known.name for known in document.imports}
    messages = {declaration.name for declaration in document.declarations if declaration.type in imported}
    found = {}
    for name in spec.input_names:
        variable, dot, field = name.partition(".")
        if dot and variable in messages:
            topic = document.topics.get(variable, f"rtamt/{variable}").lstrip("/")
            found[name] = f"/{topic}.{field}"
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """The result for a requirement: its robustness signal, and the signal of its truth.

    ``read``: the topics whose timestamps are the times of the signals.
    """

    name: str
    topic: str
    robustness: Signal
    truth: Signal
    read: tuple[str, ...]


def write_mcap(source: str, path: str, findings: Iterable[Finding], recover: bool = False) -> None:
    """Copy a bag to one MCAP file for ROS 2, with a robustness topic and a verdict topic for each finding.

    ``source``: any bag; ROS 1 messages are converted. If a topic already exists, ``/offline`` is appended
    to the new name. A result has the time of its robustness in its header, and is logged when the message with this
    timestamp was recorded. ``recover``: as for :func:`rtamt.read`. The file is written completely or not at all.
    Raises :class:`TraceError`, :class:`UsageError`.
    """
    if Path(path).exists() and Path(path).samefile(source):
        raise UsageError(f"'{path}' is the recording itself; write to another file")
    rosbag2 = library("rosbags.rosbag2", "reading ROS bags", "ros")
    with open_reader(source, recover) as (reader, _):
        try:
            with tempfile.TemporaryDirectory(dir=Path(path).resolve().parent) as folder:
                bag = Path(folder) / "bag"
                with rosbag2.Writer(bag, version=8, storage_plugin=rosbag2.StoragePlugin.MCAP) as writer:
                    store = _types(reader)
                    _copy(reader, writer, store)
                    taken = {connection.topic for connection in reader.connections}
                    recorded = RecordingTimes(reader)
                    for finding in findings:
                        _add(finding, writer, store, taken, recorded)
                with replacing(path) as new:
                    shutil.copyfile(next(bag.glob("*.mcap")), new)
        except OSError as error:
            raise TraceError(f"cannot write '{path}': {error.strerror or error}") from None


def _types(reader: Any) -> Any:
    """Return the types of a bag in their ROS 2 form, and those of ``rtamt_msgs``."""
    typesys = library("rosbags.typesys", "reading ROS bags", "ros")
    ros2 = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    own = {name: known for name, known in reader.typestore.fielddefs.items() if name != _HEADER}
    basic = {name: ros2.fielddefs[name] for name in (_HEADER, "builtin_interfaces/msg/Time")}
    for name, text in DEFINITIONS.items():
        own.update(typesys.get_types_from_msg(text, name))
    store.register({**basic, **own})
    return store


def _copy(reader: Any, writer: Any, store: Any) -> None:
    connections: dict[tuple[str, str], Any] = {}
    for known in reader.connections:
        key = known.topic, known.msgtype
        if key not in connections:
            offered = known.ext.offered_qos_profiles if reader.is2 else ()
            connections[key] = writer.add_connection(
                known.topic, known.msgtype, typestore=store, offered_qos_profiles=offered
            )
    for known, recorded, raw in messages(reader):
        with BAG.guard(str(reader.paths[0])):
            data = raw if reader.is2 else store.ros1_to_cdr(raw, known.msgtype)
        writer.write(connections[known.topic, known.msgtype], recorded, data)


def _add(finding: Finding, writer: Any, store: Any, taken: set[str], recorded: RecordingTimes) -> None:
    number, verdict = store.types[FLOAT_STAMPED], store.types[VERDICT]
    topic = _free(f"/{finding.topic.lstrip('/')}", taken)
    numbers = writer.add_connection(topic, FLOAT_STAMPED, typestore=store)
    for at, logged, value in _points(finding.robustness, finding.read, recorded):
        message = number(header=_header(store, at), value=value)
        writer.write(numbers, logged, store.serialize_cdr(message, FLOAT_STAMPED))
    verdicts = writer.add_connection(_free(f"{topic}/verdict", taken), VERDICT, typestore=store)
    for at, logged, truth in _points(finding.truth, finding.read, recorded):
        reported = SATISFIED if truth > 0 else VIOLATED
        message = verdict(header=_header(store, at), name=finding.name, verdict=reported, horizon=0.0)
        writer.write(verdicts, logged, store.serialize_cdr(message, VERDICT))


def _free(topic: str, taken: set[str]) -> str:
    while topic in taken:
        topic += "/offline"
    taken.add(topic)
    return topic


def _points(
    signal: Signal, read: Sequence[str], recorded: RecordingTimes
) -> Iterator[tuple[int, int, float]]:
    """Yield the times of a signal, when these were recorded, and its values."""
    times = signal.times
    exact = times if times.dtype.kind in "mM" else np.rint(times.astype(np.float64) * 1e9)
    at = exact.astype(np.int64)
    return zip(at.tolist(), recorded.at(at, read).tolist(), signal.values.tolist(), strict=True)


def _header(store: Any, at: int) -> Any:
    seconds, nanoseconds = divmod(at, 10**9)
    time = store.types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=nanoseconds)
    return store.types[_HEADER](stamp=time, frame_id="")
