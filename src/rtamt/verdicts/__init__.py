"""Whether a requirement holds, and since when it does not: decomposition, first violation, streams."""
