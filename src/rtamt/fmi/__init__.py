"""Export monitors as Functional Mock-up Units (FMUs) for co-simulation, FMI 2.0 and 3.0.

===========  ================================================================
module       purpose
===========  ================================================================
package      write the FMU: a zip archive of description, program and library
description  write modelDescription.xml
variables    the variables of an FMU, in the order of their value references
===========  ================================================================
"""

from rtamt.fmi.package import export, platform

__all__ = ["export", "platform"]
