"""The protocol of the peers' adapters: a JSON line with a question in, a JSON line with the answer out.

An adapter runs in the environment of its peer, as a process of its own, and knows nothing of this
project but these lines. A question is a formula (nested dicts), a trace and a mode; the answer is what
the peer says. Times are in samples, or ticks of dense time from 0 on; the runner has translated the
trace, and judges the answer up to the instant ``end``, at which windows begin to leave the trace.

    {"op": "always", "interval": [0, 2], "args": [{"op": "ge", "args": [{"var": "x"}, {"const": 3.0}]}]}
"""

import json
import os
import sys

import timing


def version(distribution):
    """Return the version of an installed distribution, from the name of its folder.

    To import importlib.metadata takes 40 ms, several times as long as some tools, whose start is timed.
    """
    name = distribution.replace("-", "_") + "-"
    found = [entry for path in sys.path if os.path.isdir(path) for entry in os.listdir(path)]
    (folder,) = {entry for entry in found if entry.startswith(name) and entry.endswith(".dist-info")}
    return folder.removeprefix(name).removesuffix(".dist-info")


class UnsupportedError(Exception):
    """The peer does not claim to support this."""


class Writer:
    """Writes a formula in the language of a peer, from a table with an entry an operator."""

    def __init__(self, table, const=repr):
        """Take the table: from an operator to a format of its operands, {0} and {1}, and its interval, {I}."""
        self.table = table
        self.const = const

    def interval(self, bounds):
        """Write an interval; to be replaced where a peer writes it otherwise."""
        begin, end = bounds
        if end is None:
            raise UnsupportedError("an interval without end")
        return f"[{begin},{end}]"

    def write(self, node):
        """Return the text of a formula; raise :class:`UnsupportedError` where the table has no entry."""
        if "var" in node:
            return node["var"]
        if "const" in node:
            return self.const(node["const"])
        op = node["op"]
        if op not in self.table:
            raise UnsupportedError(op)
        bounds = node.get("interval")
        text = "" if bounds is None else self.interval(bounds)
        return self.table[op].format(*map(self.write, node["args"]), I=text)


def plain(node):
    """Return the variable and the number of a predicate that compares the two; raise for any other."""
    left, right = node["args"]
    if "var" not in left or "const" not in right:
        raise UnsupportedError("a predicate other than of a variable and a number")
    return left["var"], right["const"]


def operators(node):
    """Return the names of all operators of a formula."""
    return {node["op"]}.union(*map(operators, node["args"])) if "op" in node else set()


def horizon(node):
    """Return how far ahead a formula reads: in samples or ticks."""
    below = max(map(horizon, node.get("args", [])), default=0)
    if node.get("op") in ("next", "s_next"):
        return below + 1
    if node.get("op") not in ("always", "eventually", "until", "unless"):
        return below
    bounds = node.get("interval")
    if bounds is None or bounds[1] is None:
        raise UnsupportedError("unbounded future online")
    return below + bounds[1]


def serve(declaration, answer, prepare=None, reading=None):
    """Answer questions until there are no more; ``declaration`` comes first.

    ``prepare(formula, time, mode, signals)`` and ``reading(formula, time, mode, names)`` return a function
    that does the work that is to be timed (see ``timing.py``). What a peer prints itself goes to standard error.
    """
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)

    def send(what):
        lines.write(json.dumps(what) + "\n")
        lines.flush()

    send(declaration)
    for line in sys.stdin:
        question = json.loads(line)
        try:
            if "workload" in question:
                if prepare is None or reading is None:
                    raise UnsupportedError("timing")
                said = timing.measure(prepare, reading, **question)
            else:
                said = answer(**question)
        except UnsupportedError as reason:
            said = {"unsupported": str(reason)}
        except Exception as error:  # noqa: BLE001 - whatever a peer raises is its answer
            said = {"error": f"{type(error).__name__}: {error}"}
        send(said)
