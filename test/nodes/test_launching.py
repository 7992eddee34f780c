# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The processes that the demo and the benchmarks start."""

import os
import subprocess
import sys
import time

from bearing_twin.errors import REFUSED
from bearing_twin.recording.reader import recording_info
from bearing_twin.ros.processes.launching import NodeProcesses
import psutil
import pytest


@pytest.mark.ros
def test_nothing_is_imported_from_the_working_directory(ros_domain, tmp_path, monkeypatch):
    monkeypatch.delenv('PYTHONSAFEPATH', raising=False)
    monkeypatch.chdir(tmp_path)
    for name in ('bearing_twin', 'numpy', 'rclpy', 'runpy', 'yaml'):
        (tmp_path / f'{name}.py').write_text("raise SystemExit('imported from here')")
    with NodeProcesses(tmp_path / 'logs', os.environ) as nodes:
        nodes.start('twin', {'load': 5.0})
        assert nodes.wait('twin', 120.0) == REFUSED
    # It is our node that speaks, and refuses what it was given.
    assert 'twin: load=5.0 is outside' in (tmp_path / 'logs' / 'twin.log').read_text()


@pytest.mark.ros
def test_nodes_end_with_the_killed_program_that_started_them(ros_domain, tmp_path):
    script = f"""import os, pathlib, time
from bearing_twin.ros.processes.launching import NodeProcesses
with NodeProcesses(pathlib.Path({str(tmp_path / 'logs')!r}), os.environ) as nodes:
    nodes.start('recorder', {{'output': {str(tmp_path / 'bag')!r}}})
    print(nodes.pid('recorder'), flush=True)
    time.sleep(600.0)
"""
    with subprocess.Popen([sys.executable, '-c', script], stdout=subprocess.PIPE) as program:
        recorder = psutil.Process(int(program.stdout.readline()))
        end = time.monotonic() + 120.0
        while not (tmp_path / 'bag' / 'bag_0.mcap').exists():
            assert time.monotonic() < end
            time.sleep(0.05)
        program.kill()
        program.wait()
    # Where nobody takes the status of orphans, it stays as a zombie.
    while recorder.is_running() and recorder.status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < end
        time.sleep(0.05)
    assert recording_info(tmp_path / 'bag').finished
