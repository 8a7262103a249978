"""Tests of ``rtamt.lsp``."""
