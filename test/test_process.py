# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory that a program keeps, and processes that end with it."""

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


OWNER = """
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
import os, time
from bearing_twin.process import end_with_parent
if __name__ == '__main__':
    pool = ProcessPoolExecutor(1, get_context('spawn'), end_with_parent)
    pool.submit(len, '')
    os.kill(os.getpid(), 9)
else:
    # Libraries load, for seconds.
    time.sleep(1.0)
"""


def test_a_process_whose_parent_is_killed_while_it_loads_ends(tmp_path):
    """It holds the pipe open, so that the call returns only then."""
    (tmp_path / 'owner.py').write_text(OWNER)
    assert python(tmp_path / 'owner.py', timeout=60.0).returncode == -9
