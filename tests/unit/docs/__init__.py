"""The pages of README.md and docs/ are run: ``pages.py`` says how."""
