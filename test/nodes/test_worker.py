# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import os
import signal
import threading
import time

from bearing_twin.streams.worker import Worker
from commands import python
import pytest

HEAD = """
import os, time
from bearing_twin.streams.worker import Worker
if __name__ == '__main__':
"""


@pytest.fixture
def worker():
    workers = []

    def make(work):
        workers.append(Worker(work))
        return workers[-1]

    yield make
    for each in workers:
        each.end()


def test_tasks_are_done_in_turn_by_one_process(worker):
    pid = worker(os.getpgid)
    assert len({(pid.submit(0).result(60.0), pid._process.pid) for _ in range(3)}) == 1
    assert pid.submit(0).result(60.0) == os.getpgid(0)
    size = worker(len)
    # Larger than what a pipe holds, and all before the process has come up.
    asked = [size.submit(bytes(count)) for count in (3_000_000, 5, 1_000_000)]
    assert [future.result(60.0) for future in asked] == [3_000_000, 5, 1_000_000]


def test_what_the_work_raises_is_raised_and_does_not_end_it(worker):
    number = worker(int)
    with pytest.raises(ValueError, match=r"invalid literal .* 'a'") as raised:
        number.submit('a').result(60.0)
    # A log shows where it was raised, in the other process.
    assert 'done = work(task)' in str(raised.value.__cause__)
    with pytest.raises((TypeError, AttributeError), match=r'pickle|local object'):
        number.submit(lambda: None).result(60.0)
    assert number.submit('7').result(60.0) == 7
    locks = worker(threading.Semaphore)
    with pytest.raises(TypeError, match=r'Semaphore.* cannot be sent: .*pickle'):
        locks.submit(1).result(60.0)
    with pytest.raises(ValueError, match='initial value'):
        locks.submit(-1).result(60.0)


def test_a_killed_process_is_told_and_replaced(worker):
    sleeper = worker(time.sleep)
    assert sleeper.submit(0.0).result(60.0) is None
    first = sleeper._process
    running = sleeper.submit(300.0)
    os.kill(first.pid, signal.SIGKILL)
    with pytest.raises(ChildProcessError, match='killed'):
        running.result(60.0)
    first.join(60.0)
    assert sleeper.submit(0.0).result(60.0) is None
    assert sleeper._process.pid != first.pid
    sleeper.end()
    assert sleeper.submit(0.0).result(60.0) is None


def test_a_process_that_cannot_be_started_is_told_and_leaves_nothing_to_end():
    script = f"""{HEAD}    import resource
    worker = Worker(len)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    # Descriptors for nothing, for a pipe only, for a part of what a process needs.
    for most in range(3, 40):
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
        try:
            worker.submit(b'1')
        except OSError:
            pass
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        worker.end()
    print(worker.submit(b'12').result(60.0))
"""
    ran = python('-c', script)
    assert (ran.stdout, ran.returncode) == ('2\n', 0), ran.stderr


@pytest.mark.parametrize('wait', ['0', "worker.submit(b'1').result()"], ids=['at once', 'later'])
def test_left_with_a_large_task_it_keeps_nobody(tmp_path, wait):
    # A process that is left before it has read what it was given: the pipe to it stays full.
    script = f'{HEAD}    worker = Worker(len)\n    {wait}\n    worker.submit(bytes(9_000_000))\n'
    (tmp_path / 'left.py').write_text(f"{script}    worker.end()\n    print('ended', flush=True)")
    done = python(tmp_path / 'left.py', timeout=60.0)
    assert (done.returncode, done.stdout, done.stderr) == (0, 'ended\n', '')


def test_a_worker_ends_with_its_owner(tmp_path):
    """Killed, an owner can not end its worker: that looks for it, in the middle of a task too."""
    script = f'{HEAD}    worker = Worker(time.sleep)\n    worker.submit(0.0).result()\n'
    script += '    print(worker._process.pid, flush=True)\n    worker.submit(300.0)\n'
    (tmp_path / 'owner.py').write_text(f'{script}    os.kill(os.getpid(), 9)')
    # The worker has the same output, which ends when both have.
    done = python(tmp_path / 'owner.py', timeout=60.0)
    assert done.returncode == -9
    assert int(done.stdout) > 0
