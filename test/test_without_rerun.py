# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the Rerun SDK is missing, as after rosdep, what needs it says so and the rest works."""

import subprocess
import sys
import time

from commands import python
from probe import TIMEOUT
import pytest

BLOCKED = """
import sys
sys.modules['rerun'] = sys.modules['rerun_cli'] = None
from bearing_twin.cli import main
sys.exit(main(sys.argv[1:]))
"""


def ran(*words: str) -> 'subprocess.CompletedProcess[str]':
    return python('-c', BLOCKED, *words)


def test_the_command_that_shows_says_what_is_missing():
    done = ran('view', 'recording.mcap')
    assert done.returncode == 1
    assert 'rerun' in done.stderr
    assert 'pip install' in done.stderr
    assert 'Traceback' not in done.stderr


@pytest.mark.ros
def test_a_recorder_records_without_a_picture(ros_domain, tmp_path):
    pytest.importorskip('rclpy', reason='ROS 2 is not installed')
    output = tmp_path / 'bag'
    log = tmp_path / 'log'
    words = ['run', 'recorder', '--ros-args', '-p', f'output:={output}', '-p', 'rerun_port:=9876']
    with log.open('wb') as out:
        recorder = subprocess.Popen(
            [sys.executable, '-c', BLOCKED, *words], stdout=out, stderr=out
        )
        try:
            while 'recording to' not in log.read_text():
                assert recorder.poll() is None, log.read_text()
                time.sleep(0.1)
        finally:
            recorder.terminate()
            assert recorder.wait(TIMEOUT) == 0
    assert 'nothing is drawn' in log.read_text()
    assert 'Traceback' not in log.read_text()
