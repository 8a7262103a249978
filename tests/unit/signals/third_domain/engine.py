"""The engine of time in turns: the definition, on all that came so far."""

import numpy as np

from rtamt.engine.backend import Defined
from rtamt.language.contents import variables
from rtamt.reference.discrete_robustness import evaluate
from rtamt.rewrite.horizon import horizon
from tests.unit.signals.third_domain.turns import TURN


class Definition(Defined):
    def evaluator(self, formulas, step, inputs):  # noqa: ARG002 - the interface has it
        return lambda trace: [evaluate(f, trace.columns, len(trace), step) for f in formulas]

    def bounds_of(self, formula, trace):
        raise NotImplementedError

    def session(self, formulas, inputs, domain, ignored=()):
        raise NotImplementedError


class TurnMonitor:
    """Takes a value of every variable a turn, and no time."""

    def __init__(self, formula, domain, **settings):  # noqa: ARG002 - the interface has it
        self.input_names = variables(formula)
        self.samples = 0
        self._formula = formula
        self._lag = int(horizon(formula, TURN))
        self._columns = {name: [] for name in self.input_names}

    def bind(self, binding):
        """Recordings have the names and units of the specification."""

    def update(self, **values):
        for name, column in self._columns.items():
            column.append(float(values[name]))
        self.samples += 1
        if self.samples <= self._lag:
            return None
        columns = {name: np.array(column) for name, column in self._columns.items()}
        return float(evaluate(self._formula, columns, self.samples, TURN)[-1 - self._lag])
