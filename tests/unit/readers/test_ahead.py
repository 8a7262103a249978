"""Chunks that a thread reads ahead: the same, in order, with the same error, and no thread is left."""

import threading

import pytest

from rtamt.readers.ahead import ahead


def left():
    return [thread for thread in threading.enumerate() if thread.name == "rtamt-reader"]


def test_all_items_come_in_order_and_the_thread_ends():
    assert list(ahead(iter(range(1000)))) == list(range(1000))
    assert left() == []


def test_an_error_is_raised_after_the_items_before_it():
    def items():
        yield 1
        yield 2
        raise OSError("the disk is gone")

    found = []
    with pytest.raises(OSError, match="the disk is gone"):
        found.extend(ahead(items()))
    found = ahead(items())
    assert [next(found), next(found)] == [1, 2]
    with pytest.raises(OSError, match="the disk is gone"):
        next(found)
    assert left() == []


def test_whoever_stops_early_stops_the_thread_which_is_at_most_four_items_ahead():
    made = []

    def items():
        for number in range(1000):
            made.append(number)
            yield number

    found = ahead(items())
    assert next(found) == 0
    found.close()
    assert left() == []
    assert len(made) <= 5
