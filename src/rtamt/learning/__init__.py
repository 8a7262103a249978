"""Rewards from requirements for reinforcement learning: wrappers of Gymnasium and PettingZoo environments.

==================  ============================================================================================
module              purpose
==================  ============================================================================================
gymnasium_wrapper   ``RobustnessReward``: one Gymnasium environment
vector_wrapper      ``VectorRobustnessReward``: a vector environment, whose environments are the keys of a fleet
pettingzoo_wrapper  ``ParallelRobustnessReward``: agents of a PettingZoo environment
episode             one episode of one requirement: rewards, potentials, the earliest verdict
signals             the variables of a requirement, from observations, actions and infos
==================  ============================================================================================
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rtamt.learning.gymnasium_wrapper import RobustnessReward
    from rtamt.learning.pettingzoo_wrapper import ParallelRobustnessReward
    from rtamt.learning.vector_wrapper import VectorRobustnessReward

__all__ = ["ParallelRobustnessReward", "RobustnessReward", "VectorRobustnessReward"]

_MODULES = {
    "ParallelRobustnessReward": "rtamt.learning.pettingzoo_wrapper",
    "RobustnessReward": "rtamt.learning.gymnasium_wrapper",
    "VectorRobustnessReward": "rtamt.learning.vector_wrapper",
}


def __getattr__(name: str) -> Any:
    """Import a wrapper, and Gymnasium or PettingZoo, on first use."""
    if name not in _MODULES:
        raise AttributeError(f"module 'rtamt.learning' has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)
