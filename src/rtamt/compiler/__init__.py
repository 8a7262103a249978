"""Formula to program: instructions, delays, parameters, and the bytes that run without Python."""
