"""The paper's tool, RTAMT, by its own documentation: https://github.com/nickovic/rtamt."""

from functools import lru_cache

from protocol import UnsupportedError, Writer, horizon, operators, serve, version

import rtamt

TABLE = {
    **{op: f"({{0}}) {sign} ({{1}})" for op, sign in (("ge", ">="), ("gt", ">"), ("le", "<="), ("lt", "<"))},
    "eq": "({0}) == ({1})",
    "ne": "({0}) !== ({1})",
    "add": "({0}) + ({1})",
    "sub": "({0}) - ({1})",
    "mul": "({0}) * ({1})",
    "div": "({0}) / ({1})",
    "abs": "abs({0})",
    "sqrt": "sqrt({0})",
    "exp": "exp({0})",
    "pow": "pow({0}, {1})",
    "not": "not({0})",
    "and": "({0}) and ({1})",
    "or": "({0}) or ({1})",
    "implies": "({0}) -> ({1})",
    # Its own iff and xor are of another form, whose sign is no verdict: asked as what they mean.
    "iff": "(({0}) -> ({1})) and (({1}) -> ({0}))",
    "xor": "not((({0}) -> ({1})) and (({1}) -> ({0})))",
    **{op: f"{op}{{I}}({{0}})" for op in ("always", "eventually", "historically", "once")},
    **{op: f"({{0}}) {op}{{I}} ({{1}})" for op in ("until", "unless", "since")},
    "prev": "prev({0})",
    "next": "next({0})",
    "s_prev": "s_prev({0})",
    "s_next": "s_next({0})",
    "rise": "rise({0})",
    "fall": "fall({0})",
}
CLASSES = {
    ("discrete", "offline"): rtamt.StlDiscreteTimeOfflineSpecification,
    ("discrete", "online"): rtamt.StlDiscreteTimeOnlineSpecification,
    ("dense", "offline"): rtamt.StlDenseTimeOfflineSpecification,
    ("dense", "online"): rtamt.StlDenseTimeOnlineSpecification,
}
FUTURE = {"always", "eventually", "until", "unless", "next", "s_next"}


def number(value):
    """Write a number as its grammar reads it: digits, a point, digits."""
    text = f"{abs(value):.1f}" if value * 2 == int(value * 2) else repr(abs(value))
    return f"-{text}" if value < 0 else text


def answer(formula, time, mode, signals, **_unused):
    """Ask one of its four classes."""
    text = Writer(TABLE, number).write(formula)
    if time == "discrete" and len(next(iter(signals.values()))) == 1:
        raise UnsupportedError("a trace of one sample")
    spec = CLASSES[time, mode]()
    for name in signals:
        spec.declare_var(name, "float")
    spec.spec = text
    late = 0
    if mode == "online":
        late = horizon(formula)
    spec.parse()
    if mode == "online" and operators(formula) & FUTURE:
        spec.pastify()
    if time == "discrete":
        n = len(next(iter(signals.values())))
        if mode == "offline":
            return {"values": [v for _, v in spec.evaluate({"time": list(range(n)), **signals})]}
        told = [spec.update(i, [(name, signals[name][i]) for name in signals]) for i in range(n)]
        return {"values": told[late:]}
    if mode == "offline":
        return {"values": spec.evaluate(*([name, samples] for name, samples in signals.items()))}
    longest = max(len(samples) for samples in signals.values())
    cut = (longest + 1) // 2
    told = spec.update(*([name, samples[:cut]] for name, samples in signals.items()))
    told = told + spec.update(*([name, samples[cut:]] for name, samples in signals.items()))
    return {"values": [[t - late, v] for t, v in told], "until": told[-1][0] - late if told else 0}


def made(text, names, time, mode, pastified):
    """Parse a text with its classes, and pastify it where it is to run online."""
    spec = CLASSES[time, mode]()
    for name in names:
        spec.declare_var(name, "float")
    spec.spec = text
    spec.parse()
    if pastified:
        spec.pastify()
    return spec


@lru_cache(maxsize=1)
def parsed(*text_and_settings):
    """Parse once what is evaluated again and again; a monitor is made anew."""
    return made(*text_and_settings)


def reading(formula, time, mode, names):
    """Declare the variables, parse and pastify."""
    text = Writer(TABLE, number).write(formula)
    if mode == "online":
        horizon(formula)
    pastified = mode == "online" and bool(operators(formula) & FUTURE)
    return lambda: made(text, names, time, mode, pastified)


def prepare(formula, time, mode, signals):
    """Take lists, as all its examples do."""
    text = Writer(TABLE, number).write(formula)
    if mode == "online":
        horizon(formula)
        parsed.cache_clear()
    spec = parsed(text, tuple(signals), time, mode, mode == "online" and bool(operators(formula) & FUTURE))
    if mode == "offline":
        if time == "discrete":
            n = len(next(iter(signals.values())))
            data = {"time": list(range(n)), **{name: list(column) for name, column in signals.items()}}
            return lambda: spec.evaluate(data)
        data = [[name, [list(pair) for pair in samples]] for name, samples in signals.items()]
        return lambda: spec.evaluate(*data)
    if time == "discrete":
        rows = [(i, list(zip(signals, row))) for i, row in enumerate(zip(*signals.values()))]

        def run(begin, end):
            for i, values in rows[begin:end]:
                spec.update(i, values)

        return run
    rows = [[[name, [list(pair)]] for name, pair in zip(signals, row)] for row in zip(*signals.values())]

    def run_dense(begin, end):
        for events in rows[begin:end]:
            spec.update(*events)

    return run_dense


serve(
    {
        "peer": f"RTAMT {version('rtamt')}",
        "modes": [list(mode) for mode in CLASSES],
        "conventions": {},
        "notes": "future operators online by its pastify(); dense online in two updates; not asked about traces of "
        "one sample, on which its discrete offline monitor raises UnboundLocalError",
    },
    answer,
    prepare,
    reading,
)
