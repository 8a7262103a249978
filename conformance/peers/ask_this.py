"""This project, asked like the others."""

import os
from fractions import Fraction
from functools import lru_cache

from protocol import Writer, horizon, serve

import rtamt
from rtamt.language.operators import STL
from rtamt.language.records import Bounds, Fixity

BACKEND = os.environ.get("RTAMT_BENCH_BACKEND", "cpp")
NOTES = "everything but unbounded future operators online, lookup tables and enumerations"
MODES = [["discrete", "offline"], ["discrete", "online"], ["dense", "offline"], ["dense", "online"]]


def spelled(op):
    """Return the form in which an operator is written, from the table of operators."""
    sign = op.spellings[0]
    if op.fixity is Fixity.ATOM:
        return op.name
    if op.fixity is Fixity.CONDITIONAL:
        return f"({sign} {{0}} then {{1}} else {{2}})"
    return f"({{0}}) {sign}{{I}} ({{1}})" if len(op.operands) == 2 else f"{sign}{{I}} ({{0}})"


class Text(Writer):
    """The language, with intervals that may be open ahead and operands that may be left out.

    ``step`` is the number of seconds in one of the intervals.
    """

    def __init__(self, table, step=1):
        """Take the table, and the length of a step."""
        super().__init__(table)
        self.step = step

    def interval(self, bounds):
        """Write inf for no end."""
        begin, end = bounds
        return f"[{begin * self.step}:{'inf' if end is None else end * self.step}]"

    def write(self, node):
        """Write a function with the operands that it has."""
        op = STL.get(node.get("op", ""))
        if op is None or op.fixity is not Fixity.FUNCTION:
            return super().write(node)
        bounds = node.get("interval")
        text = "" if bounds is None else self.interval(bounds)
        if bounds is not None and op.bounds is Bounds.DURATION:
            text = f"[{bounds[0] * self.step}]"
        operands = [*map(self.write, node["args"])]
        if "share" in node:
            kind, amount = node["share"]
            if kind == "duration":
                amount = f"{Fraction(amount) * self.step}s"
            operands.insert(0, f"{amount}%" if kind == "percent" else amount)
        return f"{op.spellings[0]}{text}({', '.join(operands)})"


TABLE = {op.name: spelled(op) for op in STL}
TEXT = Text(TABLE)


def answer(formula, time, mode, signals, step, **_unused):
    """Evaluate, or update sample by sample; times are seconds here, and steps in question and answer."""
    step = Fraction(step)
    length = {"period": step} if time == "discrete" else {"resolution": step}
    spec = rtamt.parse(Text(TABLE, step).write(formula), time=time, **length)
    if time == "discrete":
        if mode == "offline":
            return {"values": spec.evaluate({**signals}).signal.values.tolist()}
        horizon(formula)
        monitor = spec.monitor()
        n = len(next(iter(signals.values())))
        told = [monitor.update(float(i * step), **{k: v[i] for k, v in signals.items()}) for i in range(n)]
        return {"values": [v for v in told if v is not None]}
    if mode == "offline":
        seconds = {name: [(float(t * step), v) for t, v in samples] for name, samples in signals.items()}
        return {"values": in_ticks(spec.evaluate(seconds).signal, step)}
    horizon(formula)
    monitor = spec.monitor()
    told = []
    for t in sorted({t for samples in signals.values() for t, _ in samples}):
        now = {name: dict(map(tuple, samples)) for name, samples in signals.items()}
        values = {name: at[t] for name, at in now.items() if t in at}
        told += in_ticks(monitor.update(float(t * step), **values), step)
    return {"values": told, "until": told[-1][0] if told else 0}


def in_ticks(signal, step):
    """Return a signal as [tick, value] pairs."""
    ticks = [round(Fraction(t) / step) for t in signal.times.tolist()]
    return list(map(list, zip(ticks, signal.values.tolist(), strict=True)))


def reading(formula, time, mode, names):  # noqa: ARG001 - it declares none
    """Parse the text; online make the monitor, too."""
    text = TEXT.write(formula)

    def read():
        spec = rtamt.parse(text, time=time, backend=BACKEND)
        return spec if mode == "offline" else spec.monitor()

    return read


@lru_cache(maxsize=1)
def parsed(text, time):
    """Parse once what is evaluated again and again."""
    return rtamt.parse(text, time=time, backend=BACKEND)


def stepping(spec, signals):
    """Take the values of a sample by their places."""
    step = spec.monitor().step
    rows = list(zip(*signals.values(), strict=True))

    def run(begin, end):
        for row in rows[begin:end]:
            step(*row)

    return run


def updating(monitor, names, time):
    """Return the loop that a user writes who knows the names: ``update(t, a=a, b=b)``.

    An answer in dense time is read, as the peers' lists are.
    """
    values = ", ".join(f"v{k}" for k in range(len(names)))
    given = ", ".join(f"{name}=v{k}" for k, name in enumerate(names))
    read = ".points()" if time == "dense" else ""
    code = f"def run(update, rows):\n    for t, {values} in rows:\n        update(t, {given}){read}\n"
    scope = {}
    exec(code, scope)  # noqa: S102 - of names of the benchmark's own
    return lambda rows: scope["run"](monitor.update, rows)


def prepare(formula, time, mode, signals):
    """Take arrays offline, and named values a sample online."""
    spec = parsed(TEXT.write(formula), time)
    if "RTAMT_BENCH_STEP" in os.environ:
        return stepping(spec, signals)
    if mode == "offline":
        import numpy as np  # loaded where an array is made, as by every other tool

        if time == "discrete":
            data = {name: np.array(column) for name, column in signals.items()}
        else:
            data = {name: tuple(np.array(samples).T.copy()) for name, samples in signals.items()}
        return lambda: spec.evaluate(data).signal
    if time == "discrete":
        rows = [(float(i), *row) for i, row in enumerate(zip(*signals.values(), strict=True))]
    else:
        rows = [
            (events[0][0], *(value for _, value in events)) for events in zip(*signals.values(), strict=True)
        ]
    update = updating(spec.monitor(), list(signals), time)
    return lambda begin, end: update(rows[begin:end])


serve(
    {
        "peer": f"rtamt {rtamt.__version__} (this)",
        "modes": MODES,
        "conventions": {},
        "notes": NOTES,
        "steps": True,
    },
    answer,
    prepare,
    reading,
)
