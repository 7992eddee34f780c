# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory that a program keeps, its end by a signal, and processes that end with it."""

from commands import python
import pytest

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


ENDED = """
import os, signal, sys, threading, time
from pathlib import Path
from bearing_twin.cli import main

before = {*Path().iterdir()}
def end_when_written():
    while {*Path().iterdir()} == before:
        time.sleep(0.001)
    os.kill(os.getpid(), signal.SIGTERM)

threading.Thread(target=end_when_written, daemon=True).start()
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture(scope='module')
def long_recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp('long')
    words = ['-m', 'bearing_twin', 'schedule', '--duration', '20000', '-o', 'long.mcap']
    python(*words, cwd=folder, check=True)
    return folder / 'long.mcap'


@pytest.mark.parametrize('command', ['schedule', 'recover', 'report'])
def test_sigterm_leaves_nothing_of_an_output(command, long_recording, tmp_path, monkeypatch):
    """It comes with the first file or folder, temporary ones among them."""
    monkeypatch.setenv('TMPDIR', str(tmp_path))
    words = ['--duration', '20000'] if command == 'schedule' else [long_recording]
    output = 'a.html' if command == 'report' else 'a.mcap'
    ran = python('-c', ENDED, command, *words, '-o', output, cwd=tmp_path)
    assert (ran.returncode, ran.stdout, ran.stderr) == (143, '', '')
    assert not list(tmp_path.iterdir())


WITH_POOL = """
from concurrent.futures import ProcessPoolExecutor
import os, signal, sys, threading, time
from bearing_twin.process import end_as_interrupted, end_with_parent, Terminated

def work(path):
    open(path, 'w').close()
    time.sleep(300.0)

def end_when_busy(path):
    while not os.path.exists(path):
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGTERM)

end_as_interrupted()
threading.Thread(target=end_when_busy, args=sys.argv[1:], daemon=True).start()
pool = ProcessPoolExecutor(1, initializer=end_with_parent)
try:
    pool.submit(work, sys.argv[1]).result()
except Terminated:
    sys.exit(143)
finally:
    pool.shutdown()
"""


def test_sigterm_waits_for_no_task_of_a_pool(tmp_path):
    assert python('-c', WITH_POOL, tmp_path / 'busy', timeout=60.0).returncode == 143
