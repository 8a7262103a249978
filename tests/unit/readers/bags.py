"""Bags of every kind, written by rosbags as ROS writes them."""

from __future__ import annotations

import numpy as np
import rosbags.rosbag1
import rosbags.rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from rtamt.ros.message_definitions import DEFINITIONS, FLOAT_STAMPED

SECOND = 10**9
LASER = "sensor_msgs/msg/LaserScan"
FLOAT = "std_msgs/msg/Float64"


class Bag:
    """A bag in the making: ``kind`` is ros1, sqlite3 or mcap; ``packed`` what is compressed, FILE or MESSAGE."""

    def __init__(self, folder, kind, packed=None):
        self.ros1 = kind == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_JAZZY)
        for name, text in DEFINITIONS.items():
            self.store.register(get_types_from_msg(text, name))
        if self.ros1:
            self.path = folder / "drive.bag"
            self.writer = rosbags.rosbag1.Writer(self.path)
        else:
            plugin = rosbags.rosbag2.StoragePlugin[kind.upper()]
            self.writer = rosbags.rosbag2.Writer(folder / "drive", version=8, storage_plugin=plugin)
            self.path = folder / "drive" / ("drive.mcap" if kind == "mcap" else "drive.db3")
            if packed is not None:
                compression = rosbags.rosbag2.CompressionMode[packed]
                self.writer.set_compression(compression, rosbags.rosbag2.CompressionFormat.ZSTD)
        self.topics = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    def header(self, stamp):
        time = self.store.types["builtin_interfaces/msg/Time"](*divmod(stamp, SECOND))
        given = {"stamp": time, "frame_id": ""}
        return self.store.types["std_msgs/msg/Header"](**({"seq": 0, **given} if self.ros1 else given))

    def write(self, topic, kind, recorded, message):
        if topic not in self.topics:
            self.topics[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        serialize = self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr
        self.writer.write(self.topics[topic], recorded, serialize(message, kind))

    def stamped(self, topic, at, value, late=0.25):
        """Write a number whose header says ``at``; it was recorded a little later."""
        stamp = round(at * SECOND)
        message = self.store.types[FLOAT_STAMPED](header=self.header(stamp), value=value)
        self.write(topic, FLOAT_STAMPED, stamp + round(late * SECOND), message)

    def plain(self, topic, at, value):
        """Write a number without a header."""
        self.write(topic, FLOAT, round(at * SECOND), self.store.types[FLOAT](data=value))

    def scan(self, topic, at, ranges, limits=(0.05, 8.0)):
        zero = dict.fromkeys(
            ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time"), 0.0
        )
        message = self.store.types[LASER](
            header=self.header(round(at * SECOND)),
            **zero,
            range_min=limits[0],
            range_max=limits[1],
            ranges=np.array(ranges, np.float32),
            intensities=np.zeros(0, np.float32),
        )
        self.write(topic, LASER, round(at * SECOND), message)
