"""Formula to formula: pure functions."""
