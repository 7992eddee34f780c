# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a program has freed is not fetched from the system again."""

from commands import python

SCRIPT = """
import resource, sys
import numpy as np
from bearing_twin.process import keep_freed_memory
if sys.argv[1] == 'keep':
    assert keep_freed_memory()
for run in range(20):
    if run == 2:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    arrays = [np.ones(1 << 20) for _ in range(5)]
    del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def faults(how):
    ran = python('-c', SCRIPT, how, check=True)
    return int(ran.stdout)


def test_large_arrays_come_from_memory_that_was_freed():
    assert faults('keep') < 100
    assert faults('leave') > 1000
