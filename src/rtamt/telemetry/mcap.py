"""A result as an MCAP file with messages in JSON, which Foxglove and other readers show without ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import TraceError, UsageError
from rtamt.extras import library
from rtamt.files import replacing
from rtamt.telemetry.content import content_of
from rtamt.telemetry.messages import SCHEMAS, channels, in_order, text

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from rtamt.results import Result
    from rtamt.telemetry.content import Content

#: Seconds in a nanosecond, for messages.
_SECOND = 1e9


def write_mcap(
    result: Result | Mapping[str, Result], path: str | os.PathLike[str], *, bounds: bool = False
) -> None:
    """Write signals, robustness, bounds, verdicts and episodes of violation to an MCAP file.

    ``result``: of any specification, or results by the names of their requirements. Messages are logged at the
    times of the trace: nanoseconds since 1970 if it has dates, and otherwise since its time 0. ``bounds``: also the
    bounds of the robustness at the start, as known after each sample, which takes a run of a monitor. The file is
    written completely or not at all.

    Raises :class:`UsageError` if the package ``mcap`` is missing or a time is negative, and :class:`TraceError` if
    the file cannot be written.

    >>> import rtamt
    >>> from rtamt.telemetry import write_mcap
    >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 1, 4]})
    >>> write_mcap(result, "/dev/null")
    """
    write_content(content_of(result, bounds=bounds), path)


def write_content(content: Content, path: str | os.PathLike[str]) -> None:
    """Write what is exported of a result."""
    writer_module = library("mcap.writer", "writing MCAP files", "telemetry")
    starts = [int(variable.samples.times[0]) for variable in content.variables if len(variable.samples.times)]
    first = min([content.start, *starts])
    if first < 0:
        raise UsageError(
            f"the trace starts at {first / _SECOND:.15g} s, and an MCAP file has no times before 0; "
            f"add an offset to the timestamps"
        )
    found = channels(content)
    try:
        with replacing(path) as new, open(new, "wb") as file:
            writer = writer_module.Writer(file)
            writer.start(profile="", library="rtamt")
            schemas = {
                name: writer.register_schema(
                    name=name, encoding="jsonschema", data=text({"title": name, **one})
                )
                for name, one in SCHEMAS.items()
            }
            numbers = [
                writer.register_channel(
                    topic=channel.topic,
                    message_encoding="json",
                    schema_id=schemas[channel.schema],
                    metadata=dict(channel.metadata),
                )
                for channel in found
            ]
            for time, number, message in in_order(found):
                writer.add_message(
                    channel_id=numbers[number], log_time=time, publish_time=time, data=text(message)
                )
            writer.finish()
    except OSError as error:
        raise TraceError(f"cannot write '{path}': {error.strerror or error}") from None
