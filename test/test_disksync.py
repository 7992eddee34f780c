# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The thread that waits for the disk."""

from __future__ import annotations

from collections.abc import Callable
import threading
import time

from bearing_twin import disksync
from bearing_twin.disksync import DiskSync, SILENT
from bearing_twin.errors import BearingTwinError
import pytest


def threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == 'fsync']


def test_a_disk_that_was_silent_does_what_came_meanwhile_in_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(disksync, 'LONGEST', 0.1)
    disk, answer, done = DiskSync(), threading.Event(), list[int]()

    def work(number: int) -> Callable[[], None]:
        return lambda: done.append(number)

    disk.do(answer.wait)
    disk.do(work(1))
    assert not disk.settle()
    # Who comes later waits no longer.
    assert disk.patience == 0.0
    with pytest.raises(BearingTwinError, match=SILENT):
        disk.do(work(2)).wait()
    assert (done, len(threads())) == ([], 1)
    answer.set()
    while disk.busy:
        time.sleep(0.001)
    assert done == [1, 2]
    disk.do(work(3)).wait()
    assert done == [1, 2, 3]


def test_a_disk_that_is_slow_is_waited_for_as_long_as_it_answers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(disksync, 'LONGEST', 0.2)
    disk = DiskSync()
    for _ in range(5):
        disk.do(lambda: time.sleep(0.1))
    assert disk.settle()
    assert disk.longest >= 0.1


def test_what_work_raises_is_raised_for_who_waits(capsys: pytest.CaptureFixture[str]) -> None:
    disk = DiskSync()
    with pytest.raises(ZeroDivisionError):
        disk.do(lambda: 1 // 0).wait()
    # Perhaps nobody waits.
    assert 'ZeroDivisionError' in capsys.readouterr().err
    assert disk.do(lambda: 7).wait() == 7


def test_without_a_further_thread_the_work_is_done_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    disk = DiskSync()
    with monkeypatch.context() as patched:
        patched.setattr(threading.Thread, 'start', refuse)
        assert disk.do(threading.get_ident).wait() == threading.get_ident()
        assert not disk.busy
    assert disk.do(threading.get_ident).wait() != threading.get_ident()
