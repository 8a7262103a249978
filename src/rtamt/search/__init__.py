"""Search for violations: simulate a plant repeatedly and minimise the robustness of its requirement.

>>> import rtamt
>>> from rtamt.search import Problem, Range, falsify
>>> def throw(speed):
...     time = [k / 10 for k in range(21)]
...     return {"time": time, "height": [speed * t - 4.9 * t * t for t in time]}
>>> problem = Problem(rtamt.parse("always(height <= 6)"), throw, {"speed": Range(1, 12)})
>>> print(falsify(problem, optimizer="random", seed=1).falsified)
True

===========  ========================================================
module       purpose
===========  ========================================================
problem      the requirement, the plant, and the inputs that vary
inputs       ranges, and input signals built from them
falsify      falsification
sensitivity  sensitivity analysis
optimizers   optimizers of scipy, cma and optuna behind one interface
executor     run simulations in batches, in one or several processes
log          record evaluations as JSON lines; resume a search
config       problem files (TOML)
fmu          an FMU as the plant
plot         plots of a search
===========  ========================================================
"""

from rtamt.search.falsify import Falsification, falsify
from rtamt.search.inputs import PiecewiseConstant, PiecewiseLinear, Pulse, Range, Sine, Step
from rtamt.search.log import Evaluation
from rtamt.search.optimizers import OPTIMIZERS
from rtamt.search.problem import Problem
from rtamt.search.sensitivity import Sensitivity, sensitivity

__all__ = [
    "OPTIMIZERS",
    "Evaluation",
    "Falsification",
    "PiecewiseConstant",
    "PiecewiseLinear",
    "Problem",
    "Pulse",
    "Range",
    "Sensitivity",
    "Sine",
    "Step",
    "falsify",
    "sensitivity",
]
