"""A third time domain: one class, ``Turns``, and this folder, its engine."""

from rtamt.engine import Engine
from rtamt.engine.backend import named
from tests.unit.signals.third_domain.engine import Definition, TurnMonitor

ENGINE = Engine(named(Definition(), Definition()), TurnMonitor)
