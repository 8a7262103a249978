"""The conformance corpus, the generator that writes it, and the adapters that ask other tools."""
