"""Formula and signals to numbers."""
