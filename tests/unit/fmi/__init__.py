import pytest

#: Both versions of FMI.
BOTH = pytest.mark.parametrize("version", [2, 3])
