"""Requirements of other tools, read and written.

============  =====================================================
module        purpose
============  =====================================================
formats       the list of formats
conversion    what a conversion gives, and what it leaves out
fret          FRET's structured English: read and written
c2po          the specifications of R2U2: read
c2po_types    the types of their expressions
c2po_writing  specifications of R2U2 written
c_integers    arithmetic with integers as in C
breach        Breach's files of signal temporal logic
mtl           formulas of py-metric-temporal-logic
dialect       operators of this language with the spellings of another
labels        names of requirements as other tools read them
written       the text of a specification that is read
============  =====================================================

>>> from rtamt.interchange import FORMATS
>>> print(FORMATS["fret"].read("R1: the pump shall always satisfy level > 3", None).text.splitlines()[-1].strip())
always(level > 3)
"""

from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.formats import FORMATS, Format, format_named

__all__ = ["FORMATS", "Conversion", "Format", "Rejection", "format_named"]
