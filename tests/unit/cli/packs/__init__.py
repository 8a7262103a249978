"""Packs of requirements: traces that satisfy and violate them, and the command line."""
