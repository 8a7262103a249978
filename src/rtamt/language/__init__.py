"""Text to formula and back; knows nothing of signals."""
