"""The paper's listings, examples and timing experiments, for any package called rtamt: prints one JSON object.

It speaks the API of the paper, so the same file runs in an environment with RTAMT and in one with this
library. `python experiments.py --quick` measures less.
"""

import json
import math
import statistics
import sys
import time

import rtamt

#: What the responses of the first figure reach: the caption gives the robustness of f <= 1.1 as +0.048 and -0.198.
PEAKS = {"satisfied": 1.052, "violated": 1.298}
LISTING_1 = "G((req>=3)->(F[0,5](gnt>=3)))"
LISTING_2 = "H[0,10]((O[5,5](req>=3))->(O[0,5](gnt>=3)))"
LISTING_8 = "always[0,10]((req >= 3) -> (eventually[0,5](gnt >= 3)))"
#: Bounded future, with its horizon: the paper's example, then past and future in one formula.
BOUNDED = {
    "(req >= 3) -> (eventually[0,5](gnt >= 3))": 5,
    LISTING_8: 15,
    "(req >= 3) until[1,4] (gnt >= 3)": 4,
    "historically(eventually[0,2](gnt >= 3))": 2,
    "once[0,3](always[0,2](req >= 3))": 2,
}
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


def response(peak, size=121, step=0.05):
    """Return the step response of a control loop of second order that reaches ``peak``, at 0, 0.05, ... s."""
    logarithm = math.log(peak - 1)
    damping = -logarithm / math.hypot(math.pi, logarithm)
    swing = math.sqrt(1 - damping**2)
    frequency = math.pi / (20 * step * swing)  # the peak is at sample 20
    return [
        1
        - math.exp(-damping * frequency * t)
        * (math.cos(swing * frequency * t) + damping / swing * math.sin(swing * frequency * t))
        for t in (i * step for i in range(size))
    ]


def figure_1():
    """Return the robustness of f <= 1.1, always, of both responses."""
    found = {}
    for name, peak in PEAKS.items():
        spec = rtamt.StlDiscreteTimeOfflineSpecification()
        spec.declare_var("f", "float")
        spec.spec = "always(f <= 1.1)"
        spec.parse()
        values = response(peak)
        found[name] = spec.evaluate({"time": list(range(len(values))), "f": values})[0][1]
    return found


def figure_2():
    """Return what always[1,3] and historically[1,3] make of a Boolean signal, which is 1 at 0 to 5 and 8 to 14."""
    values = [1.0 if i <= 5 or i >= 8 else -1.0 for i in range(15)]
    found = {"φ": values}
    for text in ("always[1,3](req >= 0)", "historically[1,3](req >= 0)"):
        spec = specification("StlDiscreteTimeOfflineSpecification", text)
        data = {"time": list(range(len(values))), "req": values, "gnt": values}
        found[text.replace("(req >= 0)", " φ")] = [value for _, value in spec.evaluate(data)]
    return found


def pastification():
    """Return for each formula at how many instants the pastified one has, a horizon later, the same value."""
    found = {}
    req = [6.0, 0, 5, 1, 4, 0, 0, 7, 2, 3, 3, 0, 6, 1, 0, 5, 0, 2, 4, 0, 0, 6, 3, 1, 0, 5, 5, 0, 2, 4]
    gnt = [0.0, 2, 4, 0, 1, 6, 0, 0, 5, 1, 0, 3, 2, 0, 0, 4, 6, 1, 0, 0, 2, 5, 0, 3, 4, 0, 1, 0, 6, 2]
    for text, horizon in BOUNDED.items():
        found[text] = attempted(agreement, text, horizon, req, [float(value) for value in gnt])
    return found


def agreement(text, horizon, req, gnt):
    """Return at how many instants the pastified formula agrees with the formula itself, and of how many."""
    offline = specification("StlDiscreteTimeOfflineSpecification", text)
    data = {"time": list(range(len(req))), "req": [float(value) for value in req], "gnt": gnt}
    expected = [value for _, value in offline.evaluate(data)]
    online = specification("StlDiscreteTimeOnlineSpecification", text, pastify=True)
    online_values = [online.update(i, [("req", float(req[i])), ("gnt", gnt[i])]) for i in range(len(req))]
    pairs = list(zip(expected, online_values[horizon:], strict=False))
    return f"{sum(a == b for a, b in pairs)} of {len(pairs)}"


def listing_8():
    """Return what the monitor of the ROS node publishes, from the horizon (15 periods) on."""
    spec = specification("StlDiscreteTimeOnlineSpecification", LISTING_8, pastify=True)
    published = []
    for i in range(30):
        sample = [("req", 6.0 if i % 10 == 2 else 0.0), ("gnt", 4.0 if i % 10 == 5 and i < 20 else 0.0)]
        published.append(spec.update(i, sample))
    return published[15:]


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
        found[str(k)] = seconds_a_sample(spec, samples)
    return found


def seconds_a_sample(spec, samples, budget=15.0):
    """Return the median of the processor's seconds that an update takes.

    ``budget``: seconds in all; who needs longer is asked for fewer samples, at least 5.
    """
    deadline = time.process_time() + budget
    took = []
    done, batch = 0, 1
    while done < samples and (done < 5 or time.process_time() < deadline):
        begin = time.process_time()
        for i in range(done, done + batch):
            spec.update(i, [("a", float(i % 7)), ("b", float(i % 5))])
        took.append((time.process_time() - begin) / batch)
        done += batch
        if done == 5 and took[-1] < 1e-3:
            batch = 25  # reading the clock costs as much as a fast update
            took.clear()
    return statistics.median(took)


def seconds(run, budget=2.0):
    """Return the shortest of up to five runs, in seconds of the processor; of fewer beyond the budget."""
    best = None
    begin = time.process_time()
    for _ in range(5):
        start = time.process_time()
        run()
        took = time.process_time() - start
        best = took if best is None else min(best, took)
        if time.process_time() - begin > budget:
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
        ((10, 100), (100, 1000), 50)
        if quick
        else ((100, 1000, 5000), (100, 1000, 10000, 100000, 1000000), 300)
    )
    found = {
        "figure 1": attempted(figure_1),
        "figure 2": attempted(figure_2),
        "pastification": attempted(pastification),
        "listing 1": attempted(listing_1),
        "listing 2": attempted(listing_2),
        "listing 8": attempted(listing_8),
        "figure 4": attempted(figure_4),
        "scaling": attempted(scaling, sizes),
        "windows": attempted(windows, bounds, samples),
    }
    print(json.dumps(plain(found)))
