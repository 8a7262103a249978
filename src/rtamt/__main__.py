"""``python -m rtamt``: the command line if the command ``rtamt`` is not on the path."""

import sys

from rtamt.cli import main

sys.exit(main())
