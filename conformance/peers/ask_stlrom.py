"""STLRom, by its documentation: https://pypi.org/project/stlrom. Samples held until the next (PREVIOUS)."""

import stlrom
from protocol import UnsupportedError, Writer, horizon, serve, version

TABLE = {
    **{op: f"{{0}} {sign} {{1}}" for op, sign in (("ge", ">="), ("gt", ">"), ("le", "<="), ("lt", "<"))},
    "add": "({0} + {1})",
    "sub": "({0} - {1})",
    "mul": "({0} * {1})",
    "not": "not {0}",
    "and": "{0} and {1}",
    "or": "{0} or {1}",
    "implies": "{0} => {1}",
    "always": "alw_{I} {0}",
    "eventually": "ev_{I} {0}",
    "until": "{0} until_{I} {1}",
}


NUMBERS = {"add", "sub", "mul"}
PREDICATES = {"ge", "gt", "le", "lt"}


class Stl(Writer):
    """Its language: x[t] is the value of a signal; every sub-formula has a name, as in its examples."""

    def __init__(self):
        """Begin without definitions."""
        super().__init__(TABLE)
        self.lines = []

    @staticmethod
    def is_number(node):
        """Return whether a node is no formula."""
        return "op" not in node or node["op"] in NUMBERS

    def write(self, node):
        """Name a formula; write variables with their time."""
        if "var" in node:
            return f"{node['var']}[t]"
        if node.get("op") in ("always", "eventually", "until") and node.get("interval") is None:
            raise UnsupportedError("an interval left out")
        text = super().write(node)
        if "const" in node or node["op"] in NUMBERS:
            return text
        if node["op"] not in PREDICATES and any(self.is_number(operand) for operand in node["args"]):
            raise UnsupportedError("a number as a formula")
        self.lines.append(f"phi{len(self.lines)} := {text}")
        return f"phi{len(self.lines) - 1}"


def answer(formula, time, mode, signals, end):
    """Give it the whole trace, and ask for the robustness at every tick."""
    if (time, mode) != ("dense", "offline"):
        raise UnsupportedError(f"{time} {mode}")
    if Stl.is_number(formula):
        raise UnsupportedError("a number as a formula")
    driver = stlrom.STLDriver()
    names = list(signals)
    language = Stl()
    name = language.write(formula)
    if not driver.parse_string("\n".join([f"signal {', '.join(names)}", *language.lines, ""])):
        raise ValueError("its parser refuses the formula")
    driver.set_interpol("PREVIOUS")
    at = {name: dict(map(tuple, samples)) for name, samples in signals.items()}
    now = {}
    times = sorted({t for samples in at.values() for t in samples})
    for t in times:
        now.update({name: samples[t] for name, samples in at.items() if t in samples})
        driver.add_sample([float(t), *(now[name] for name in names)])
    monitor = driver.get_monitor(name)
    return {"points": [[t, monitor.eval_rob(float(t))] for t in range(end)]}


def reading(formula, time, mode, names):  # noqa: ARG001 - it has one mode
    """Let a driver parse the text; it is returned with the name of the formula."""
    if Stl.is_number(formula):
        raise UnsupportedError("a number as a formula")
    language = Stl()
    name = language.write(formula)
    text = "\n".join([f"signal {', '.join(names)}", *language.lines, ""])

    def read():
        driver = stlrom.STLDriver()
        if not driver.parse_string(text):
            raise ValueError("its parser refuses the formula")
        driver.set_interpol("PREVIOUS")
        return driver, name

    return read


def prepare(formula, time, mode, signals):
    """Offline ask for the whole signal; online add a sample, then ask one horizon back."""
    if time == "discrete":
        signals = {name: list(enumerate(column)) for name, column in signals.items()}
    driver, name = reading(formula, time, mode, list(signals))()
    rows = [[float(row[0][0]), *(v for _, v in row)] for row in zip(*signals.values())]
    if mode == "offline":

        def evaluate():
            monitor = driver.get_monitor(name)
            for row in rows:
                monitor.add_sample(row)
            monitor.set_eval_time(rows[0][0], rows[-1][0])
            monitor.eval_rob()
            return monitor.get_signal().get_samples_list()

        return evaluate
    ahead = horizon(formula)
    monitor = driver.get_monitor(name)

    def run(begin, end):
        for row in rows[begin:end]:
            monitor.add_sample(row)
            monitor.eval_rob(max(row[0] - ahead, 0.0))

    return run


serve(
    {
        "peer": f"STLRom {version('stlrom')}",
        "modes": [["dense", "offline"]],
        "conventions": {"until": "closed"},
        "notes": "bounded future; asked at every tick; until as found, its documentation does not say",
    },
    answer,
    prepare,
    reading,
)
