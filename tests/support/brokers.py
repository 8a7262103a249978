"""A Kafka broker in this process: the mock cluster of librdkafka, which other processes reach by loopback.

confluent-kafka makes a mock cluster with four partitions a topic, whose groups wait three seconds for members; its
own library, by ctypes, lets a test choose both.
"""

from __future__ import annotations

import ctypes
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def broker(**topics):
    """Yield the address of a broker; ``topics``: the number of partitions of each."""
    import confluent_kafka

    place = Path(confluent_kafka.__file__).parents[1] / "confluent_kafka.libs"
    (found,) = place.glob("librdkafka*")
    lib = ctypes.CDLL(str(found))
    pointer, number, text = ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p

    def function(name, result, *parameters):
        called = getattr(lib, f"rd_kafka_{name}")
        called.restype, called.argtypes = result, parameters
        return called

    settings = function("conf_new", pointer)()
    error = ctypes.create_string_buffer(256)
    quiet = function("conf_set", number, pointer, text, text, text, ctypes.c_size_t)
    assert quiet(settings, b"log_level", b"0", error, len(error)) == 0
    client = function("new", pointer, number, pointer, text, ctypes.c_size_t)(0, settings, error, len(error))
    assert client, error.value
    cluster = function("mock_cluster_new", pointer, pointer, number)(client, 1)
    try:
        create = function("mock_topic_create", number, pointer, text, number, number)
        for name, partitions in topics.items():
            assert create(cluster, name.encode(), partitions, 1) == 0
        function("mock_group_initial_rebalance_delay_ms", None, pointer, ctypes.c_int32)(cluster, 0)
        yield function("mock_cluster_bootstraps", text, pointer)(cluster).decode()
    finally:
        function("mock_cluster_destroy", None, pointer)(cluster)
        function("destroy", None, pointer)(client)
