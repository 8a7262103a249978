"""Provide RTAMT's module paths of its enumerations and interpreters.

The semantics of predicates are in ``rewrite/semantics.py``.
"""

from rtamt.compat.options import Language, Semantics, StlComparisonOperator, StlIOType, TimeInterpretation
from rtamt.compat.paths import provide
from rtamt.compat.trees import (
    StlDenseTimeOfflineInterpreter,
    StlDenseTimeOnlineInterpreter,
    StlDiscreteTimeOfflineInterpreter,
    StlDiscreteTimeOnlineInterpreter,
)

provide(
    __name__,
    {
        "enumerations.options": {
            "Language": Language,
            "Semantics": Semantics,
            "TimeInterpretation": TimeInterpretation,
        },
        "enumerations.io_type": {"StlIOType": StlIOType},
        "enumerations.comp_op": {"StlComparisonOperator": StlComparisonOperator},
        "enumerations.comp_oper": {"StlComparisonOperator": StlComparisonOperator},
        "stl.discrete_time.offline.interpreter": {
            "StlDiscreteTimeOfflineInterpreter": StlDiscreteTimeOfflineInterpreter
        },
        "stl.discrete_time.online.interpreter": {
            "StlDiscreteTimeOnlineInterpreter": StlDiscreteTimeOnlineInterpreter
        },
        "stl.dense_time.offline.interpreter": {
            "StlDenseTimeOfflineInterpreter": StlDenseTimeOfflineInterpreter
        },
        "stl.dense_time.online.interpreter": {"StlDenseTimeOnlineInterpreter": StlDenseTimeOnlineInterpreter},
    },
)
