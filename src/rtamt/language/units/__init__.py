"""Convert durations, and check physical units through formulas.

==========  ===================================================================
module      purpose
==========  ===================================================================
durations   durations with units
moments     times in messages: seconds, or dates
pint_units  physical units by pint
dimensions  the units of numbers, and whether they fit together
rules       how the unit of a result follows from those of the operands
check       dimensional analysis: declared units through the formulas of a text
==========  ===================================================================
"""
