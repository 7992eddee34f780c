# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
A node that is told to end more than once still finishes its work.

Who presses Ctrl-C twice does that, and 'ros2 launch' without a terminal too: the whole process
group gets the signal, and the launcher passes it on once more.
"""

from __future__ import annotations

import os
import signal
import time
from typing import TYPE_CHECKING

from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.launching import NodeProcesses
import pytest

if TYPE_CHECKING:
    from pathlib import Path

PAUSES = (0.0, 0.001, 0.01, 0.05)
"""From the first interrupt to the second, s."""


@pytest.mark.ros
@pytest.mark.parametrize('pause', PAUSES)
def test_a_second_interrupt_leaves_no_torn_recording(
    pause: float, ros_domain: int, tmp_path: Path
) -> None:
    bag = tmp_path / 'bag'
    with NodeProcesses(tmp_path / 'logs', os.environ) as nodes:
        nodes.start('recorder', {'output': str(bag)})
        deadline = time.monotonic() + 120.0
        while b'recording to' not in (tmp_path / 'logs' / 'recorder.log').read_bytes():
            nodes.check()
            assert time.monotonic() < deadline
            time.sleep(0.1)
        pid = nodes.pid('recorder')
        os.kill(pid, signal.SIGINT)
        time.sleep(pause)
        assert nodes.end('recorder') == 0
    assert recording_info(bag).finished
    assert (bag / 'metadata.yaml').exists()
