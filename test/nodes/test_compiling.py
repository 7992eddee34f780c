# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A node that compiles is seen, says so, answers services and ends when told to."""

import os
import signal

from bearing_twin.ros.launching import COMPILING, NodeProcesses
import pytest

pytestmark = pytest.mark.ros


@pytest.mark.parametrize('node', ['twin', 'fleet'])
def test_first_start(node, ros_domain, probe, tmp_path):
    environment = {**os.environ, 'NUMBA_CACHE_DIR': str(tmp_path / 'empty')}
    given = {'names': ['pump']} if node == 'fleet' else {}
    with NodeProcesses(tmp_path / 'logs', environment) as nodes:
        nodes.start(node, given)
        probe.watch_diagnostics()
        part = f'{node}: real time'
        probe.until(lambda: probe.statuses.get(part, ('', ''))[1] == COMPILING, 'a status')
        assert COMPILING in (tmp_path / 'logs' / f'{node}.log').read_text()
        assert probe.state(f'/{node}') == 'unconfigured'
        assert nodes.end(node, by=signal.SIGTERM) == 0
    # It has not waited for the compiler, with which the work begins.
    log = (tmp_path / 'logs' / f'{node}.log').read_text()
    assert 'twin of' not in log and '1 twins' not in log
