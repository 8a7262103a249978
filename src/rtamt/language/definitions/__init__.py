"""Define what each operator means: pure functions, and their interval extensions.

===================  ============================================================================
module               purpose
===================  ============================================================================
discrete             the discrete-time meaning of each temporal operator: one pure function
dense                the dense-time meaning of temporal operators, at one time
pointwise            the meaning of each operator of one instant: one pure function
functions            the meaning of sin, round, clip and the other mathematical functions
enclosures           interval extensions: operators of one instant on operands known up to bounds
function_enclosures  interval extensions of the mathematical functions
===================  ============================================================================
"""
