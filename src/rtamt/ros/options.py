"""The command-line arguments and parameters of all nodes: on ROS 1, on ROS 2 and on DDS alone."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any, NoReturn

from rtamt.errors import UsageError
from rtamt.language.units.durations import UNITS
from rtamt.lazy.dataclasses import dataclass
from rtamt.metrics import add_metrics_options
from rtamt.ros.binding import INSTANTS, VERDICTS, bind
from rtamt.ros.monitor import RosMonitor
from rtamt.settings import assignments
from rtamt.signals.time_domains import DEFAULT, DOMAINS, time_domain
from rtamt.specification_loader import load

if TYPE_CHECKING:
    from collections.abc import Mapping

#: The names of parameters, and their defaults.
DEFAULTS: Mapping[str, str] = {
    "spec": "",
    "period": "",
    "unit": "s",
    "time": DEFAULT,
    "stale": "",
    "verdict": "",
    "at": "",
    "set": "",
}


@dataclass(frozen=True, slots=True)
class Options:
    """The options of a node: texts as the user wrote them, "" if left out."""

    spec: str
    period: str
    unit: str
    time: str
    stale: str
    verdict: str
    at: str
    set: str

    def monitor(self) -> RosMonitor:
        """Load the specification and create its monitor; raise :class:`StlError` on failure."""
        if not self.spec:
            raise UsageError("no specification was given: name a file, or set the parameter spec")
        in_periods = time_domain(self.time).sampled
        if not in_periods and self.period:
            raise UsageError("dense time has no sampling period: leave out --period, or --time dense")
        period = self._duration(self.period) if self.period else None
        values = assignments(self.set.split(",")) if self.set else {}
        spec = load(self.spec, time=self.time, period=period).with_parameters(**values)
        if in_periods and spec.period is None:
            raise UsageError(
                "discrete time samples the topics once a period: give it, such as --period 100ms (the parameter "
                "period), or use --time dense, which reads every message at its own time"
            )
        rule = spec.domain.sampling(spec.sampling)
        stale = self._duration(self.stale) if self.stale else None if rule is None else rule.limit
        sampled = spec.period if in_periods else None
        monitor = RosMonitor(
            bind(spec, self.verdict or None, self.at or None),
            period=sampled,
            time=self.time,
            stale=stale,
            skip_nan=rule is not None and rule.skip_nan,
        )
        written = spec.document.sampling if in_periods else None
        if written is not None and written.period != spec.period:
            monitor.note(f"the period {self.period} replaces that of '{written}' in the specification")
        if written is not None and written.limit is not None and self.stale:
            monitor.note(f"stale after {self.stale} replaces the limit of '{written}' in the specification")
        return monitor

    def _duration(self, text: str) -> str:
        """Return a duration with its unit: ``--unit`` is that of a plain number, as in the paper's listing 5.

        It does not apply to bounds in the specification, which are in seconds or have their own units.
        """
        try:
            float(text)
        except ValueError:
            return text
        return f"{text}{self.unit}"


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see '{self.prog} --help'")


def parser(prog: str) -> argparse.ArgumentParser:
    """Return a parser of the arguments of all nodes."""
    made = _Parser(
        prog=prog,
        description="Monitor a specification on topics, and publish its robustness and verdict.",
        allow_abbrev=False,
    )
    add_options(made)
    return made


def add_options(made: argparse.ArgumentParser) -> None:
    """Add the arguments of all nodes."""
    made.add_argument(
        "spec", metavar="SPEC", nargs="?", help="a specification file (.stl) with topics and types"
    )
    made.add_argument(
        "--period",
        metavar="DURATION",
        help="the sampling period: a number, or with a unit: 100ms; required in discrete time, unless the "
        "specification declares it: sample 100ms hold",
    )
    made.add_argument(
        "--unit",
        help=f"the unit of --period and --stale if they are numbers: {', '.join(UNITS)} (default: s)",
    )
    made.add_argument(
        "--time",
        metavar=f"{{{','.join(DOMAINS)}}}",
        help=f"discrete: one sample per period; dense: every message is a sample at its timestamp (default: {DEFAULT})",
    )
    made.add_argument(
        "--stale",
        metavar="DURATION",
        help="the time after which a silent topic is stale; 0: never (default: ten periods, in dense time 5 s)",
    )
    made.add_argument(
        "--verdict",
        metavar=f"{{{','.join(VERDICTS)}}}",
        help="delayed: robustness and verdict of every sample, one horizon later; eager: the verdict of every "
        "instant, once no later sample can change it; interval: bounds and verdict at the start of the trace, "
        "valid for every continuation (default: interval for unbounded future, else delayed)",
    )
    made.add_argument(
        "--at",
        metavar=f"{{{','.join(INSTANTS)}}}",
        help="with --verdict interval: bounds at the start of the trace, or at every instant whenever they change "
        "(default: start)",
    )
    made.add_argument(
        "--set",
        metavar="NAME=VALUE,...",
        help="values of parameters that the specification declares, such as limit=3,gap=2",
    )
    add_metrics_options(made)


def options(arguments: argparse.Namespace, parameters: Mapping[str, Any]) -> Options:
    """Return the effective options: an argument, else a parameter, else the default."""
    chosen = {}
    for name, default in DEFAULTS.items():
        argument = getattr(arguments, name)
        chosen[name] = str(parameters.get(name, default)) if argument is None else argument
    return Options(**chosen)
