"""Reelay, by its documentation: https://doganulus.github.io/reelay. Past operators, known as they come."""

from protocol import UnsupportedError, Writer, plain, serve, version
from reelay import dense_timed_monitor, discrete_timed_monitor

SIGNS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<", "eq": "==", "ne": "!="}
TABLE = {
    "not": "not ({0})",
    "and": "({0}) and ({1})",
    "or": "({0}) or ({1})",
    "implies": "({0}) -> ({1})",
    "historically": "historically{I} ({0})",
    "once": "once{I} ({0})",
    "since": "({0}) since{I} ({1})",
    "s_prev": "pre ({0})",
}
LOWEST = -1.7976931348623157e308


class Rye(Writer):
    """Its language: a predicate stands in braces."""

    def interval(self, bounds):
        """Write an interval with a colon, its end left out where there is none."""
        begin, end = bounds
        return f"[{begin}:{'' if end is None else end}]"

    def write(self, node):
        """Write predicates by themselves."""
        if node.get("op") in SIGNS:
            name, value = plain(node)
            return f"{{{name} {SIGNS[node['op']]} {value}}}"
        if "op" not in node:
            raise UnsupportedError("a number as a formula")
        return super().write(node)


def answer(formula, time, mode, signals, **_unused):
    """Feed one of its two monitors, row by row; in dense time the last row closes the trace."""
    if mode != "online":
        raise UnsupportedError(mode)
    pattern = Rye(TABLE).write(formula)
    if time == "discrete":
        monitor = discrete_timed_monitor(pattern=pattern, semantics="robustness", condense=False)
        n = len(next(iter(signals.values())))
        rows = ({"time": i, **{name: signals[name][i] for name in signals}} for i in range(n))
        told = [monitor.update(row)["value"] for row in rows]
        return {"values": [float("-inf") if v == LOWEST else v for v in told]}
    if "s_prev" in str(formula):
        raise UnsupportedError("pre in dense time")
    try:
        monitor = dense_timed_monitor(pattern=pattern, semantics="robustness")
    except ValueError as error:
        if "Unsupported" in str(error):  # == and != in dense time
            raise UnsupportedError(str(error)) from None
        raise
    at = {name: dict(map(tuple, samples)) for name, samples in signals.items()}
    now = {}
    told = [[0.0, 0.0]]  # changes alone are told, and the first value is compared with 0
    times = sorted({t for samples in at.values() for t in samples})
    for t in times:
        now.update({name: samples[t] for name, samples in at.items() if t in samples})
        told += [[event["time"], event["value"]] for event in monitor.update({"time": float(t), **now})]
    if len(told) > 1 and told[1][0] == 0.0:
        del told[0]
    return {"values": told, "until": times[-1]}


def reading(formula, time, mode, names):  # noqa: ARG001 - it declares none
    """Make one of its two monitors of a pattern."""
    if mode != "online":
        raise UnsupportedError(mode)
    pattern = Rye(TABLE).write(formula)
    if time == "discrete":
        return lambda: discrete_timed_monitor(pattern=pattern, semantics="robustness", condense=False)
    return lambda: dense_timed_monitor(pattern=pattern, semantics="robustness")


def prepare(formula, time, mode, signals):
    """Take a dict a sample; in dense time one whose "time" is later."""
    names = list(signals)
    monitor = reading(formula, time, mode, names)()
    if time == "discrete":
        rows = [dict(zip(names, row)) for row in zip(*signals.values())]
    else:
        rows = [
            {"time": row[0][0], **{name: v for name, (_, v) in zip(names, row)}}
            for row in zip(*signals.values())
        ]

    def run(begin, end):
        update = monitor.update
        for row in rows[begin:end]:
            update(row)

    return run


serve(
    {
        "peer": f"Reelay {version('reelay')}",
        "modes": [["discrete", "online"], ["dense", "online"]],
        "conventions": {},
        "notes": "past operators; predicates of a variable and a number; its pre is s_prev; in dense time it "
        "names changes only, and what it has not named by the last sample is taken as unchanged",
    },
    answer,
    prepare,
    reading,
)
