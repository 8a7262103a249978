"""The paper's listings, Fig. 4 and timing experiments, for any package called rtamt: prints one JSON object.

It speaks the API of the paper, so the same file runs in an environment with RTAMT and in one with this
library. `python experiments.py --quick` measures less.
"""

import json
import statistics
import sys
import time

import rtamt

LISTING_1 = "G((req>=3)->(F[0,5](gnt>=3)))"
LISTING_2 = "H[0,10]((O[5,5](req>=3))->(O[0,5](gnt>=3)))"
FORMULAS = {
    "φ1": "req >= 3",
    "φ2": "(req >= 3) -> (gnt >= 3)",
    "φ3": "(req >= 3) -> (eventually[0,5](gnt >= 3))",
    "φ4": "historically((req >= 3) -> ((not(req >= 3)) until[0,5] (gnt >= 3)))",
}
#: Fig. 4: req and gnt at 0, 1, 2, ... s.
RECORDINGS = {
    "a": ([0, 6, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 6, 0, 0, 0]),
    "b": ([0, 2, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0, 0, 0]),
    "c": ([0, 6, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0, 0, 0]),
    "d": ([0, 4, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0, 0, 0]),
}
SEMANTICS = {
    "robustness": "StlDiscreteTimeOfflineSpecification",
    "output robustness": "IAStlOutputRobustnessDiscreteTimeOfflineSpecification",
    "input vacuity": "IAStlInputVacuityDiscreteTimeOfflineSpecification",
}


def specification(name, text, pastify=False):
    """Return a specification over req and gnt of the class of this name."""
    kind = getattr(rtamt, name, None)
    if kind is None:  # RTAMT keeps some in modules of their own
        from rtamt.spec.iastl.discrete_time import specification as iastl

        kind = getattr(iastl, name)
    spec = kind()
    for variable in ("req", "gnt"):
        spec.declare_var(variable, "float")
        spec.set_var_io_type(variable, "input" if variable == "req" else "output")
    spec.spec = text
    spec.parse()
    if pastify:
        spec.pastify()
    return spec


def listing_1():
    """Dense time, offline."""
    spec = specification("StlDenseTimeOfflineSpecification", LISTING_1)
    req = [[0.0, 0.0], [2.0, 6.0], [4.0, 0.0], [10.0, 0.0]]
    gnt = [[0.0, 0.0], [6.0, 6.0], [8.0, 0.0], [10.0, 0.0]]
    return spec.evaluate(["req", req], ["gnt", gnt])


def listing_2():
    """Dense time, online, in two chunks."""
    spec = specification("StlDenseTimeOnlineSpecification", LISTING_2)
    first = spec.update(["req", [[0.0, 0.0], [2.0, 6.0]]], ["gnt", [[0.0, 0.0], [5.0, 6.0]]])
    second = spec.update(["req", [[4.0, 0.0], [10.0, 0.0]]], ["gnt", [[8.0, 0.0], [10.0, 0.0]]])
    return [first, second]


def figure_4():
    """Interface-aware semantics: the robustness at the first instant, for each recording."""
    found = {}
    for name, (req, gnt) in RECORDINGS.items():
        data = {"time": list(range(len(req))), "req": [float(v) for v in req], "gnt": [float(v) for v in gnt]}
        found[name] = {}
        for semantics, kind in SEMANTICS.items():
            spec = specification(kind, "always((req >= 3) -> (eventually[0,5](gnt >= 3)))")
            found[name][semantics] = spec.evaluate(data)[0][1]
    return found


def scaling(sizes):
    """Offline: seconds for each formula and number of samples, discrete and dense."""
    found = {}
    for label, text in FORMULAS.items():
        for size in sizes:
            req = [float(6 * (i % 20 == 3)) for i in range(size)]
            gnt = [float(6 * (i % 20 == 6)) for i in range(size)]
            found[f"discrete {label} {size}"] = seconds(
                lambda text=text, size=size, req=req, gnt=gnt: specification(
                    "StlDiscreteTimeOfflineSpecification", text
                ).evaluate({"time": list(range(size)), "req": req, "gnt": gnt})
            )
            found[f"dense {label} {size}"] = seconds(
                lambda text=text, req=req, gnt=gnt: specification(
                    "StlDenseTimeOfflineSpecification", text
                ).evaluate(
                    ["req", [[float(i), v] for i, v in enumerate(req)]],
                    ["gnt", [[float(i), v] for i, v in enumerate(gnt)]],
                )
            )
    return found


def windows(bounds, samples):
    """Online: the median of seconds a sample of always[0,k](a + b >= -2), pastified, for each k."""
    found = {}
    for k in bounds:
        spec = rtamt.StlDiscreteTimeOnlineSpecification()
        spec.declare_var("a", "float")
        spec.declare_var("b", "float")
        spec.spec = f"always[0,{k}]((a + b) >= (0 - 2))"
        spec.parse()
        spec.pastify()
        took = []
        for i in range(samples):
            begin = time.perf_counter()
            spec.update(i, [("a", float(i % 7)), ("b", float(i % 5))])
            took.append(time.perf_counter() - begin)
        found[str(k)] = statistics.median(took)
    return found


def seconds(run, budget=2.0):
    """Return the shortest of up to five runs, of fewer where they take longer than the budget."""
    best = None
    begin = time.perf_counter()
    for _ in range(5):
        start = time.perf_counter()
        run()
        took = time.perf_counter() - start
        best = took if best is None else min(best, took)
        if time.perf_counter() - begin > budget:
            break
    return best


def attempted(run, *arguments):
    """Return what came of it; a tool that fails has failed, and the others go on."""
    try:
        return run(*arguments)
    except Exception as error:  # noqa: BLE001 - another tool's: whatever it raises is its answer
        return f"{type(error).__name__}: {error}"


def plain(value):
    """Return a value as JSON has it: numbers, and infinities as text."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, float) and abs(value) == float("inf"):
        return str(value)
    return value


if __name__ == "__main__":
    quick = "--quick" in sys.argv
    sizes, bounds, samples = (
        ((10, 100), (100, 1000), 50) if quick else ((100, 1000, 5000), (100, 1000, 10000, 100000), 300)
    )
    found = {
        "listing 1": attempted(listing_1),
        "listing 2": attempted(listing_2),
        "figure 4": attempted(figure_4),
        "scaling": attempted(scaling, sizes),
        "windows": attempted(windows, bounds, samples),
    }
    print(json.dumps(plain(found)))
