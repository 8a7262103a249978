"""Recordings that are all read before a command begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError
from rtamt.cli.reading_options import on_time_base, read_for, reading_of, recording
from rtamt.plot.saving import save
from rtamt.readers.sql import shown

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence
    from typing import Any

    from rtamt.cli.terminal import Progress
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


def recordings_of(
    args: argparse.Namespace, spec: Specification, traces: Sequence[str], progress: Progress
) -> dict[str, Trace]:
    """Read recordings as ``rtamt check`` does; of a quantified specification all signals, which may be of members."""
    reading = reading_of(args, spec.input_names, whole=True)
    found: dict[str, Trace] = {}
    for number, trace in enumerate(traces):
        progress.bar(number, len(traces), trace)
        name = shown(trace)
        if name in found:
            raise CommandError(f"'{name}' is given twice; leave it out once")
        if spec.groups:
            found[name] = recording(args, trace, spec)
        else:
            data = spec.binding.applied(read_for([spec], trace, reading))
            found[name] = on_time_base(data, spec, trace, reading)
    return found


def save_plot(axes: Any, path: str) -> None:
    """Write the figure of axes; see :func:`save_figure`."""
    save_figure(axes.figure, path)


def save_figure(figure: Any, path: str) -> None:
    """Write a plot completely or not at all; an error is one sentence."""
    try:
        save(figure, path, 130)
    except (OSError, ValueError) as error:
        raise CommandError(f"cannot write the plot '{path}': {error}") from None
