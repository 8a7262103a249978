"""Made traces for ``examples/requirements``, by the set of a file and its name."""

from tests.integration.examples.requirements import arch_comp, commonroad, lockheed_martin

#: From each file to its traces.
TRACES = {
    f"{module.__name__.rpartition('.')[2]}/{name}": traces
    for module in (lockheed_martin, arch_comp, commonroad)
    for name, traces in module.TRACES.items()
}
