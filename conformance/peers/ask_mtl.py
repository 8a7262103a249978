"""py-metric-temporal-logic, by its documentation: https://github.com/mvcisback/py-metric-temporal-logic.

Its predicates are signals that hold their own robustness: the adapter subtracts.
"""

import mtl
from protocol import UnsupportedError, Writer, plain, serve, version

VALUES = {
    "ge": lambda v, c: v - c,
    "gt": lambda v, c: v - c,
    "le": lambda v, c: c - v,
    "lt": lambda v, c: c - v,
}
TABLE = {
    "not": "~({0})",
    "and": "(({0}) & ({1}))",
    "or": "(({0}) | ({1}))",
    "implies": "(({0}) -> ({1}))",
    "iff": "(({0}) <-> ({1}))",
    "xor": "(({0}) ^ ({1}))",
    "always": "G{I}({0})",
    "eventually": "F{I}({0})",
    "until": "({0} U{I} {1})",
    "unless": "({0} W {1})",
}


def predicate(number):
    """Return the name of a predicate: its grammar knows letters alone in names."""
    return "p" + "".join("abcdefghij"[int(digit)] for digit in str(number))


class Ltl(Writer):
    """Its language; remembers the signals that stand for predicates."""

    def __init__(self):
        """Begin without predicates."""
        super().__init__(TABLE)
        self.predicates = []

    def interval(self, bounds):
        """Write inf as its grammar does."""
        begin, end = bounds
        return f"[{begin}, {'inf' if end is None else end}]"

    def write(self, node):
        """Name a predicate."""
        if node.get("op") in VALUES:
            name, value = plain(node)
            self.predicates.append((name, value, VALUES[node["op"]]))
            return predicate(len(self.predicates))
        if "op" not in node:
            raise UnsupportedError("a number as a formula")
        if node["op"] == "unless" and node.get("interval") is not None:
            raise UnsupportedError("weak until with an interval")
        return super().write(node)


def answer(formula, time, mode, signals, end):
    """Evaluate the whole trace, and ask for the value at every tick."""
    if (time, mode) != ("dense", "offline"):
        raise UnsupportedError(f"{time} {mode}")
    language = Ltl()
    phi = mtl.parse(language.write(formula))
    data = {
        predicate(k): [(t, of(v, value)) for t, v in signals[name]]
        for k, (name, value, of) in enumerate(language.predicates, 1)
    }
    return {"points": [[t, phi(data, time=t, quantitative=True)] for t in range(end)]}


def reading(formula, time, mode, names):  # noqa: ARG001 - it declares none
    """Parse: what comes out is the monitor."""
    if mode != "offline":
        raise UnsupportedError(mode)
    text = Ltl().write(formula)
    return lambda: mtl.parse(text)


def prepare(formula, time, mode, signals):
    """Ask for the whole signal of values."""
    if mode != "offline":
        raise UnsupportedError(mode)
    language = Ltl()
    phi = mtl.parse(language.write(formula))
    if time == "discrete":
        signals = {name: list(enumerate(column)) for name, column in signals.items()}
    data = {
        predicate(k): [(t, of(v, value)) for t, v in signals[name]]
        for k, (name, value, of) in enumerate(language.predicates, 1)
    }
    return lambda: phi(data, time=None, quantitative=True)


serve(
    {
        "peer": f"py-metric-temporal-logic {version('metric-temporal-logic')}",
        "modes": [["dense", "offline"]],
        "conventions": {"until": "closed where it has an interval"},
        "notes": "future operators; asked at every tick; until as found, its documentation does not say",
    },
    answer,
    prepare,
    reading,
)
