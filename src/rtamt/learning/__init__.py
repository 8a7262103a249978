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

from typing import TYPE_CHECKING

from rtamt.lazy import attributes

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

#: A wrapper imports Gymnasium or PettingZoo.
__getattr__ = attributes(__name__, _MODULES)
