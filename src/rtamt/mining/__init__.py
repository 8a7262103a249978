"""Infer from recordings: the parameters of a template, and rules that separate good recordings from bad ones.

>>> import rtamt
>>> from rtamt.mining import mine
>>> template = rtamt.parse("input float x  parameter float limit = 9  always(x <= limit)")
>>> mine(template, {"a": {"x": [5, 3.25]}, "b": {"x": [7.5, 1]}})
<limit=7.5 on 2 recordings>

====================  ===================================================================================
module                purpose
====================  ===================================================================================
mine                  the tight values of the parameters of a template
direction             whether a parameter makes a requirement easier or harder to satisfy, by its formula
region                which values satisfy the template on every recording, within a budget
grid                  the values that a parameter takes, from the easiest to the hardest
parameter_ranges      the range of a parameter, by its kind and by what recordings satisfy
pareto_front          the Pareto front of two parameters
search                parameters without a known direction
classify              a decision list over templates that separates good recordings from bad ones
classifier_templates  the templates of a classifier
decision_list         decision lists
plot                  plots of what was mined
====================  ===================================================================================
"""

from rtamt.mining.classify import Classifier, classify
from rtamt.mining.direction import directions
from rtamt.mining.mine import Mined, Point, mine

__all__ = ["Classifier", "Mined", "Point", "classify", "directions", "mine"]
