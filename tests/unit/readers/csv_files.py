"""CSV files of tests as columns."""

import rtamt


def read(path, names=None, *, time_column=None):
    """Return time and values as columns."""
    trace = rtamt.read(path, columns=names, time=time_column)
    columns = {name: trace[name].values for name in trace}
    return columns if trace.start is None else {"time": trace[trace.names[0]].times, **columns}


def as_lists(data):
    """Return columns as lists."""
    return {name: column.tolist() for name, column in data.items()}
