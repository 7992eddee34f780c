# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The processes that the demo and the benchmarks start."""

import os

from bearing_twin.errors import REFUSED
from bearing_twin.ros.processes.launching import NodeProcesses
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
