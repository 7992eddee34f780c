# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A process that still waits for a viewer ends at once, with its status."""

from commands import python

PROGRAM = """
import atexit, sys, threading
from bearing_twin.view.rerun.ending import leave, SERVING

atexit.register(print, 'torn down')
done = threading.Event()
thread = threading.Thread(target=done.wait, name=SERVING, daemon=True)
thread.start()
if sys.argv[1] == 'done':
    done.set()
    thread.join()
print('finished')
leave(3)
assert 'rerun' not in sys.modules
sys.exit(4)
"""


def outcome(state):
    """Return status and output of a process whose thread is done or waits."""
    done = python('-c', PROGRAM, state)
    return done.returncode, done.stdout


def test_a_waiting_thread_is_left_behind():
    assert outcome('waits') == (3, 'finished\n')


def test_without_one_the_process_ends_as_ever():
    assert outcome('done') == (4, 'finished\ntorn down\n')
