# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A node that compiles is seen, says so, answers services and ends when told to."""

import os
import signal
import subprocess
import sys

from bearing_twin.ros.processes.launching import COMPILING, NodeProcesses
from cases import in_proofs
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
import pytest

pytestmark = pytest.mark.ros


def printed(script):
    """Return what a script prints in a process of its own."""
    return subprocess.run([sys.executable, '-c', script], capture_output=True, check=True).stdout


@pytest.mark.parametrize('node', ['fleet', *in_proofs('twin')])
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


def test_a_kernel_from_the_cache_is_loaded_and_not_compiled(compiled):
    script = (
        'from bearing_twin.dynamics import preset, Simulator\n'
        'from bearing_twin.numerics.compiled import has_compiled\n'
        "Simulator(preset('incipient')).advance(1024, 20.0, 25.0)\n"
        'print(has_compiled())\n'
    )
    assert printed(script) == b'False\n'


def test_the_state_of_the_first_block_of_a_node_waits_for_no_compiler():
    script = (
        'from bearing_twin.assets.twin import Twin\n'
        'from bearing_twin.assets.parameters.twin import SPECS\n'
        'from bearing_twin.dynamics.single.condition import _observed\n'
        'Twin({spec.name: spec.default for spec in SPECS}).warm_up()\n'
        'print(len(_observed.signatures))\n'
    )
    assert printed(script) == b'1\n'


def test_state_snapshot_picture_and_thermal_tick_wait_for_no_compiler():
    script = """
import numpy as np
from bearing_twin.diagnosis.compilation import warm_up as warm_up_diagnosis
from bearing_twin.diagnosis.series.monitor import SeriesMonitor
from bearing_twin.diagnosis.signal.severity import _powers
from bearing_twin.dynamics import preset, warm_up
from bearing_twin.dynamics.equations import load_zone
from bearing_twin.dynamics.single import kernel, simulator
from bearing_twin.dynamics.single.condition import _observed
def known():
    kernels = (_observed, _powers, load_zone._force, kernel.advance, simulator._advance)
    return [len(each.signatures) for each in kernels]
warm_up(), warm_up_diagnosis()
print(*known())
SeriesMonitor(None).add(0.0, np.sin(np.arange(2560.0)), 25600.0, 25.0)
load_zone.contact_forces(np.zeros((3, 8)), np.zeros((3, 1)), 0.0, 0.0, 1.0)
twin = simulator.Simulator(preset('paper', thermal_mode='physical'))
# A thermal tick within a block.
twin.advance(simulator.inner_ring.tick_length(25600.0) + 1000, 30.0, 25.0)
twin.condition()
print(*known())
# The run-in calls the kernel that blocks call; a bearing at rest has none.
simulator.Simulator(preset('paper'), shaft_hz=0.0)
print(*(types[-1].layout for types in kernel.advance.signatures))
"""
    before, after, layouts = printed(script).splitlines()
    assert before.startswith(b'1 2 1 ')
    assert (after, layouts) == (before, b'A')


SLOW_NODE = """
import threading
import time
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.processes.running import run
class SlowNode(ManagedNode):
    def __init__(self):
        super().__init__('slow', ())
{method}
raise SystemExit(run(SlowNode, ['--ros-args', '-p', 'autostart:=false']))
"""


def test_a_node_ends_while_its_parameters_are_checked(ros_domain):
    """The check compiles at a first start: launch kills what has not ended after ten seconds."""
    method = """
    def check(self, values):
        print('checking', flush=True)
        time.sleep(60.0)
"""
    script = SLOW_NODE.format(method=method)
    with subprocess.Popen([sys.executable, '-c', script], stdout=subprocess.PIPE) as node:
        assert node.stdout.readline() == b'checking\n'
        node.send_signal(signal.SIGINT)
        assert node.wait(30.0) == 0


@pytest.mark.parametrize('ends', [False, True])
def test_a_configuration_waits_for_the_compiler(ros_domain, probe, ends):
    """A manager may ask for it as soon as the node is there; a signal ends the node anyway."""
    method = f"""
    asked = threading.Event()
    def prepare(self):
        self.asked.wait()
        time.sleep({60.0 if ends else 0.5})
        self.prepared = True
    def on_configure(self, state):
        print('configuring', flush=True)
        self.asked.set()
        return super().on_configure(state)
    def setup(self):
        print(self.prepared, flush=True)
"""
    script = SLOW_NODE.format(method=method)
    with subprocess.Popen([sys.executable, '-c', script], stdout=subprocess.PIPE) as node:
        manager = probe.node.create_client(ChangeState, '/slow/change_state')
        probe.until(manager.service_is_ready, 'the node')
        configure = Transition(id=Transition.TRANSITION_CONFIGURE)
        answer = manager.call_async(ChangeState.Request(transition=configure))
        assert node.stdout.readline() == b'configuring\n'
        if not ends:
            assert node.stdout.readline() == b'True\n'
            probe.until(answer.done, 'an answer')
            assert answer.result().success
        node.send_signal(signal.SIGINT)
        assert node.wait(30.0) == 0
