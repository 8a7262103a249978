"""mstlo, by its documentation: https://INTO-CPS-Association.github.io/mstlo. Bounded future, online."""

import mstlo_python as mstlo
from protocol import UnsupportedError, Writer, plain, serve, version

SIGNS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<"}
TABLE = {
    "true": "true",
    "false": "false",
    "not": "!({0})",
    "and": "({0}) && ({1})",
    "or": "({0}) || ({1})",
    "implies": "({0}) -> ({1})",
    "always": "G{I}({0})",
    "eventually": "F{I}({0})",
    "until": "({0}) U{I} ({1})",
}


class Dsl(Writer):
    """Its language: intervals [a, b] with a < b, always written."""

    def interval(self, bounds):
        """Refuse what its documentation leaves out."""
        begin, end = bounds
        if end is None or begin == end:
            raise UnsupportedError("an interval other than [a, b], a < b")
        return f"[{begin}, {end}]"

    def write(self, node):
        """Write predicates by themselves."""
        if node.get("op") in SIGNS:
            name, value = plain(node)
            return f"{name} {SIGNS[node['op']]} {value}"
        if "op" not in node:
            raise UnsupportedError("a number as a formula")
        if node["op"] in ("always", "eventually", "until") and node.get("interval") is None:
            raise UnsupportedError("an interval left out")
        return super().write(node)


def answer(formula, time, mode, signals, **_unused):
    """Feed its monitor sample by sample, in the order of time."""
    if (time, mode) != ("dense", "online"):
        raise UnsupportedError(f"{time} {mode}")
    monitor = mstlo.Monitor(mstlo.parse_formula(Dsl(TABLE).write(formula)), semantics="DelayedQuantitative")
    told = {}
    samples = [(t, name, v) for name, pairs in signals.items() for t, v in pairs]
    for t, name, value in sorted(samples, key=lambda sample: sample[0]):
        told.update(monitor.update(name, value, float(t)).verdicts())
    values = sorted(map(list, told.items()))
    return {"values": values, "until": values[-1][0] if values else 0}


def reading(formula, time, mode, names):  # noqa: ARG001 - it declares none
    """Parse, and make the monitor."""
    if mode != "online":
        raise UnsupportedError(mode)
    text = Dsl(TABLE).write(formula)
    return lambda: mstlo.Monitor(mstlo.parse_formula(text), semantics="DelayedQuantitative")


def prepare(formula, time, mode, signals):
    """Take a value a variable and instant; samples one second apart stand for discrete time."""
    monitor = reading(formula, time, mode, list(signals))()
    if time == "discrete":
        signals = {name: list(enumerate(column)) for name, column in signals.items()}
    rows = [
        [(name, float(v), float(t)) for name, (t, v) in zip(signals, row)] for row in zip(*signals.values())
    ]

    def run(begin, end):
        update = monitor.update
        for row in rows[begin:end]:
            for name, value, t in row:
                update(name, value, t).verdicts()

    return run


serve(
    {
        "peer": f"mstlo {version('mstlo-python')}",
        "modes": [["dense", "online"]],
        "conventions": {"until": "closed"},
        "notes": "bounded future, intervals longer than a point, predicates of a variable and a number; "
        "until by its documentation",
    },
    answer,
    prepare,
    reading,
)
