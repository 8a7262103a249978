"""This project, asked like the others."""

from protocol import Writer, horizon, serve

import rtamt
from rtamt.language.operators import STL
from rtamt.language.records import Fixity

MODES = [["discrete", "offline"], ["discrete", "online"], ["dense", "offline"], ["dense", "online"]]


def spelled(op):
    """Return the form in which an operator is written, from the table of operators."""
    sign = op.spellings[0]
    operands = ", ".join(f"{{{k}}}" for k in range(len(op.operands)))
    if op.fixity is Fixity.ATOM:
        return op.name
    if op.fixity is Fixity.FUNCTION:
        return f"{sign}({operands})"
    return f"({{0}}) {sign}{{I}} ({{1}})" if len(op.operands) == 2 else f"{sign}{{I}} ({{0}})"


class Text(Writer):
    """The language, with intervals that may be open ahead."""

    def interval(self, bounds):
        """Write inf for no end."""
        begin, end = bounds
        return f"[{begin}:{'inf' if end is None else end}]"


def answer(formula, time, mode, signals, end):  # noqa: ARG001 - the whole trace is told
    """Evaluate, or update sample by sample."""
    spec = rtamt.parse(Text({op.name: spelled(op) for op in STL}).write(formula), time=time)
    if time == "discrete":
        if mode == "offline":
            return {"values": spec.evaluate({**signals}).signal.values.tolist()}
        horizon(formula)
        monitor = spec.monitor()
        n = len(next(iter(signals.values())))
        told = [monitor.update(float(i), **{k: v[i] for k, v in signals.items()}) for i in range(n)]
        return {"values": [v for v in told if v is not None]}
    if mode == "offline":
        signal = spec.evaluate(signals).signal
        return {"values": list(map(list, zip(signal.times.tolist(), signal.values.tolist(), strict=True)))}
    horizon(formula)
    monitor = spec.monitor(time="dense")
    told = []
    for t in sorted({t for samples in signals.values() for t, _ in samples}):
        now = {name: dict(map(tuple, samples)) for name, samples in signals.items()}
        signal = monitor.update(float(t), **{name: at[t] for name, at in now.items() if t in at})
        told += map(list, zip(signal.times.tolist(), signal.values.tolist(), strict=True))
    return {"values": told, "until": told[-1][0] if told else 0}


serve(
    {"peer": f"rtamt {rtamt.__version__} (this)", "modes": MODES, "conventions": {}, "notes": "everything"},
    answer,
)
