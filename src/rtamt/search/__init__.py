"""The search for violations: a plant is simulated again and again, its robustness made small.

>>> import rtamt
>>> from rtamt.search import Problem, Range, falsify
>>> def throw(speed):
...     time = [k / 10 for k in range(21)]
...     return {"time": time, "height": [speed * t - 4.9 * t * t for t in time]}
>>> problem = Problem(rtamt.parse("always(height <= 6)"), throw, {"speed": Range(1, 12)})
>>> print(falsify(problem, optimizer="random", seed=1).falsified)
True
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
