"""RTAMT's module paths, for programs that import its classes from where they used to live."""
