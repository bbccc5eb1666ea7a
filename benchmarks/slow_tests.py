"""The tests that take too long for each change: such as the whole paper.

    python benchmarks/slow_tests.py [options of pytest]

Run it before a release, and after a change to engines, laws or claims.
"""

import sys

import pytest

if __name__ == "__main__":
    sys.exit(pytest.main(["-m", "slow", "--durations=0", *sys.argv[1:]]))
