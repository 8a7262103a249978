"""Run programs written for RTAMT unchanged, on the engine of this library.

The classes keep declarations, assemble the text, and delegate everything else to
:mod:`rtamt.language`, :mod:`rtamt.rewrite` and :mod:`rtamt.engine`.

===============  ====================================================================
module           purpose
===============  ====================================================================
options          Semantics, Language, TimeInterpretation, StlIOType
declarations     shared by every class: names, types, topics, modules, the text
objects          variables that are objects, and their fields
formulas         the parsed formulas: canonical text, values of sub-formulas
online           pastification and the result, shared by the online classes
discrete         discrete time: sampling period, the offline class
discrete_online  the online class, and the combined one
dense            dense time: the offline, online and combined classes
dense_points     signals of dense time as lists of [time, value]
interface_aware  the classes for IA-STL: the same with another semantics
explained        explanations, shared by the offline classes
backends         select the compiled core, or the definition if the core is not built
associativity    the warning for chains that RTAMT parses differently
failures         convert every error to an RTAMTException
trees            RTAMT's syntax trees, pastifiers and interpreters
paths            modules without files, for RTAMT's module paths
===============  ====================================================================
"""
