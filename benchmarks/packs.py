"""A pack on a flight log of 100 MB: ``python benchmarks/packs.py [MEGABYTES]`` prints the time that a check takes.

The log is synthetic: the topics of the pack and others of a real log, at the rates at which PX4 logs them. The time is
that of a fresh process, reading and start of Python included; the processor time is what counts on a busy machine.
"""

from __future__ import annotations

import os
import resource
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np


class Topic(NamedTuple):
    """A topic: its fields, all float, how often it is logged in a second, and the values that are not 0."""

    name: str
    fields: tuple[str, ...]
    rate: int
    values: tuple[tuple[str, float], ...] = ()


def _array(name: str, length: int) -> str:
    return f"{name}:{length}"


#: The topics of the pack, and the bulk of a log: raw sensors, actuators, states.
TOPICS = (
    Topic("vehicle_status", ("arming_state", "failsafe"), 2, (("arming_state", 2),)),
    Topic("failsafe_flags", ("manual_control_signal_lost",), 2),
    Topic("battery_status", ("voltage_v", "cell_count", "remaining"), 5,
          (("voltage_v", 16), ("cell_count", 4), ("remaining", 0.8))),
    Topic("vehicle_attitude", (_array("q", 4), _array("delta_q_reset", 4)), 100),
    Topic("vehicle_attitude_setpoint", (_array("q_d", 4), _array("thrust_body", 3)), 50),
    Topic("vehicle_angular_velocity", (_array("xyz", 3), _array("xyz_derivative", 3)), 250),
    Topic("vehicle_rates_setpoint", ("roll", "pitch", "yaw", _array("thrust_body", 3)), 100),
    Topic("vehicle_imu_status", ("accel_vibration_metric", _array("mean_accel", 3)), 10),
    Topic("estimator_status",
          ("vel_test_ratio", "pos_test_ratio", "hgt_test_ratio", "hdg_test_ratio", "filter_fault_flags"), 10),
    Topic("sensor_gps", ("fix_type", "satellites_used", "eph"), 10, (("fix_type", 3), ("satellites_used", 12))),
    Topic("sensor_combined", (_array("gyro_rad", 3), _array("accelerometer_m_s2", 3)), 250),
    Topic("actuator_outputs", (_array("output", 16),), 100),
    Topic("vehicle_local_position", (_array("state", 40),), 50),
    Topic("estimator_states", (_array("states", 24), _array("covariances", 24)), 20),
)  # fmt: skip


def write(path: Path, size: int) -> float:
    """Write a log of about ``size`` bytes; return its length in seconds."""
    with path.open("wb") as file:
        file.write(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))
        layouts = [_define(file, number, topic) for number, topic in enumerate(TOPICS)]
        for number, topic in enumerate(TOPICS):  # all formats stand before these
            added = struct.pack("<BH", 0, number) + topic.name.encode()
            file.write(struct.pack("<HB", len(added), ord("A")) + added)
        second = 0
        while file.tell() < size:
            for topic, layout in zip(TOPICS, layouts, strict=True):
                file.write(_messages(topic, layout, second))
            second += 1
    return second


def _define(file: BinaryIO, number: int, topic: Topic) -> np.ndarray:
    """Write what a topic is; return a message of it, header included."""
    declared, names = [], []
    for field in topic.fields:
        name, _, length = field.partition(":")
        declared.append(f"float[{length}] {name}" if length else f"float {name}")
        names += [f"{name}[{k}]" for k in range(int(length))] if length else [name]
    text = f"{topic.name}:uint64_t timestamp;{';'.join(declared)};".encode()
    file.write(struct.pack("<HB", len(text), ord("F")) + text)
    layout = [
        ("size", "<u2"),
        ("kind", "u1"),
        ("id", "<u2"),
        ("timestamp", "<u8"),
        *((name, "<f4") for name in names),
    ]
    message = np.zeros(1, dtype=layout)
    message["size"], message["kind"], message["id"] = message.itemsize - 3, ord("D"), number
    for name, value in topic.values:
        message[name] = value
    for name in names:
        if name in ("q[0]", "q_d[0]"):
            message[name] = 1
    return message


def _messages(topic: Topic, message: np.ndarray, second: int) -> bytes:
    """Return what a topic has in one second."""
    many = np.repeat(message, topic.rate)
    many["timestamp"] = (1_000_000 * (second + 1 + np.arange(topic.rate) / topic.rate)).astype(np.uint64)
    return many.tobytes()


def main() -> None:
    """Write a log, check it, print what that took."""
    megabytes = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "flight.ulg")
        seconds = write(path, megabytes * 10**6)
        begin = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "rtamt", "check", "px4", path, "--quiet"], check=True, env=os.environ
        )
        wall = time.perf_counter() - begin
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(
            f"rtamt check px4 on {path.stat().st_size / 1e6:.0f} MB, {seconds / 60:.0f} min of flight: "
            f"{used.ru_utime + used.ru_stime:.1f} s of processor time, {wall:.1f} s elapsed, "
            f"{used.ru_maxrss / 1024:.0f} MB of memory"
        )


if __name__ == "__main__":
    main()
