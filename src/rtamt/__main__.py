"""``python -m rtamt``: the command line, where the command ``rtamt`` is not on the path."""

import sys

from rtamt.cli import main

sys.exit(main())
