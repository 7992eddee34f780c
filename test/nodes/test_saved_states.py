# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Saved states: whole, of one node at a time, and never another's."""

import asyncio
from concurrent import futures
import errno
import fcntl
import math
import os
import resource
import select
import subprocess
import sys
import time

from bearing_twin import disksync
from bearing_twin.errors import BearingTwinError
from bearing_twin.packed import unpack
from bearing_twin.stamps import samples_ns
from bearing_twin.streams import statefile
from bearing_twin.streams.statefile import NodeStates, StateFolder
from loopdisk import loop_disk
import numpy as np
import pytest
import yaml


class Node:
    """What a node does with the state that it keeps."""

    def __init__(self, folder, name='/pump_1/diagnosis', former=''):
        self.log = []
        self.learnt = None
        self.states = NodeStates(self.log.append)
        values = {'state_directory': str(folder), 'state_name': 'pump', 'state_owner': former}
        self.state = self.states.kept(values, name)
        self.taken = self.load()

    def load(self):
        return self.state.load(self.take, wait=True)

    def take(self, state):
        if state == b'of a series':
            raise BearingTwinError('saved state has version 1006')
        self.learnt = state

    def keep(self, state):
        self.state.keep(lambda: state)
        self.states.disk.settle()


def test_a_refused_state_is_written_again_by_itself(tmp_path, monkeypatch):
    node = Node(tmp_path / 'states')
    (tmp_path / 'states').rename(tmp_path / 'away')
    node.keep(b'learnt')
    assert 'cannot be kept' in node.state.problem
    (tmp_path / 'away').rename(tmp_path / 'states')
    node.state.retry()
    node.states.disk.settle()
    assert node.state.problem, 'not tried again at once'
    later = time.monotonic() + statefile.RETRY
    monkeypatch.setattr(time, 'monotonic', lambda: later)
    node.state.retry()
    node.states.disk.settle()
    assert not node.state.problem
    node.states.release()
    assert Node(tmp_path / 'states').learnt == b'learnt'


def test_a_refused_state_is_written_again_at_the_end(tmp_path):
    node = Node(tmp_path / 'states')
    (tmp_path / 'states').rename(tmp_path / 'away')
    node.keep(b'learnt')
    (tmp_path / 'away').rename(tmp_path / 'states')
    node.states.release()
    assert Node(tmp_path / 'states').learnt == b'learnt'


def test_a_state_that_was_given_up_is_not_written_again(tmp_path):
    node = Node(tmp_path / 'states')
    node.keep(b'of one bearing')
    (tmp_path / 'states').rename(tmp_path / 'away')
    node.keep(b'of one bearing, later')
    (tmp_path / 'away').rename(tmp_path / 'states')
    node.state.set_aside('another bearing')
    node.states.release()
    assert Node(tmp_path / 'states').learnt is None


@pytest.mark.parametrize('name', ['', '.', '..', '../x', '/etc/passwd', 'a/b', 'a\0b'])
def test_states_stay_in_their_folder(tmp_path, name):
    with pytest.raises(BearingTwinError, match='plain file name'):
        StateFolder(str(tmp_path)).save(name, b'x')


@pytest.mark.parametrize('name', ['a' * 201, 'ä' * 101])
def test_names_leave_room_for_those_of_lock_and_part(tmp_path, name):
    folder = StateFolder(str(tmp_path))
    with pytest.raises(BearingTwinError, match='bytes is too long: 200 at most'):
        folder.load(name)
    folder.save(name[1:], b'x')
    assert folder.load(name[1:]) == b'x'


def test_a_folder_that_no_path_reaches_is_an_error_in_words(tmp_path):
    with pytest.raises(BearingTwinError, match='cannot be read: File name too long'):
        StateFolder(str(tmp_path / ('a' * 256))).load('pump')


@pytest.mark.parametrize('links', [True, False])
def test_a_state_is_saved_once_with_hard_links_and_without(tmp_path, monkeypatch, links):
    def refuse(*_):
        raise PermissionError(errno.EPERM, 'Operation not permitted')

    if not links:
        monkeypatch.setattr(os, 'link', refuse)
    folder = StateFolder(str(tmp_path / 'new'))
    folder.save('a', b'1')
    with pytest.raises(BearingTwinError, match='exists and is not overwritten'):
        folder.save('a', b'2')
    assert folder.load('a') == b'1'
    assert [path.name for path in folder.folder.iterdir()] == ['a']
    with pytest.raises(BearingTwinError, match='cannot be read'):
        folder.load('b')


KEEPER = """
import sys, time
from bearing_twin.streams.statefile import NodeStates
values = {'state_directory': sys.argv[1], 'state_name': 'a', 'state_owner': ''}
states = NodeStates(str)
state = states.kept(values, '/pump/diagnosis')
number = sys.argv[2].encode()
print('there', flush=True)
while True:
    state.load(lambda _: None, wait=True)
    state.keep(lambda: number * 100_000)
    states.disk.settle()
    if state.problem:
        assert 'kept by another node' in state.problem, state.problem
        time.sleep(0.001)
    else:
        print('kept', flush=True)
"""


def contend(rounds, folder):
    """Let three processes keep one state, kill the one that does: the next one takes over."""
    words = [sys.executable, '-c', KEEPER, str(folder)]
    keepers, before = [], None
    try:
        for number in range(rounds):
            while len(keepers) < 3:
                name = str((number + len(keepers)) % 10)
                keepers.append(subprocess.Popen([*words, name], stdout=subprocess.PIPE))
                assert keepers[-1].stdout.readline() == b'there\n'
            ready, _, _ = select.select([k.stdout for k in keepers], [], [], 120.0)
            [keeper] = [k for k in keepers if k.stdout in ready]
            assert keeper is not before
            before = keeper
            keeper.kill()
            keeper.wait()
            keepers.remove(keeper)
            # Whole, whenever it struck.
            _, held = unpack((folder / 'a').read_bytes(), statefile._VERSION)
            state = held['state'].tobytes()
            assert len(state) == 100_000
            assert len(set(state)) == 1
    finally:
        for keeper in keepers:
            keeper.kill()
            keeper.wait()


def test_three_processes_that_are_killed_leave_a_whole_state(tmp_path):
    contend(4, tmp_path)


@pytest.mark.soak
def test_a_hundred_killed_keepers_of_one_state(tmp_path):
    contend(100, tmp_path)


def test_of_states_that_come_faster_than_the_disk_the_newest_is_kept(tmp_path):
    pump = Node(tmp_path)
    for number in range(300):
        pump.state.keep(lambda number=number: b'%d' % number)
    pump.states.release()
    assert Node(tmp_path).learnt == b'299'


def test_no_state_is_read_or_written_through_a_link(tmp_path):
    outside = tmp_path / 'outside'
    outside.write_bytes(b'precious')
    states = tmp_path / 'states'
    pump = Node(states)
    pump.states.release()
    (states / 'pump').symlink_to(outside)
    pump = Node(states)
    pump.keep(b'1')
    assert pump.log == [f'{states}/pump cannot be kept: it is a link']
    folder = StateFolder(str(states))
    (states / 'link').symlink_to(outside)
    with pytest.raises(BearingTwinError, match='it is a link'):
        folder.load('link')
    with pytest.raises(BearingTwinError, match='exists'):
        folder.save('link', b'2')
    assert outside.read_bytes() == b'precious'
    os.mkfifo(states / 'pipe')
    with pytest.raises(BearingTwinError, match='no plain file'):
        folder.load('pipe')


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_state_is_claimed_before_it_is_read(tmp_path):
    first = Node(tmp_path)
    first.keep(b'of a series')
    before = (tmp_path / 'pump').read_bytes()
    # Neither what it holds nor that it could not be used is the second's.
    second = Node(tmp_path)
    assert (second.taken, second.learnt) == (False, None)
    assert [line.split('; ')[0] for line in second.log] == [
        f'{tmp_path}/pump is kept by another node'
    ]
    second.keep(b'2')
    assert second.state.problem == second.log[0]
    assert (tmp_path / 'pump').read_bytes() == before
    assert names(tmp_path) == ['.pump.lock', 'pump']
    first.keep(b'1')
    first.states.release()
    # It takes over once the first is gone.
    assert second.load()
    assert second.learnt == b'1'
    second.keep(b'2')
    assert (len(second.log), second.state.problem) == (1, '')


def test_a_state_of_another_machine_is_refused_by_name(tmp_path):
    pump = Node(tmp_path)
    pump.keep(b'pump 1')
    pump.states.release()
    before = (tmp_path / 'pump').read_bytes()
    other = Node(tmp_path, '/pump_2/diagnosis')
    assert other.learnt is None
    assert other.log == [
        f'{tmp_path}/pump was learnt by /pump_1/diagnosis, this is /pump_2/diagnosis: choose '
        'another state_name, or set state_owner to /pump_1/diagnosis if that is its former name'
    ]
    for reset in (False, True):
        if reset:
            other.state.give_up()
            assert not other.load()
        other.keep(b'pump 2')
        assert other.state.problem
    assert (tmp_path / 'pump').read_bytes() == before
    assert names(tmp_path) == ['.pump.lock', 'pump']
    # A node that was renamed loses nothing, and the state is then its own.
    renamed = Node(tmp_path, '/hall/pump_1/diagnosis', '/pump_1/diagnosis')
    assert renamed.learnt == b'pump 1'
    renamed.keep(b'still pump 1')
    renamed.states.release()
    assert Node(tmp_path, '/hall/pump_1/diagnosis').learnt == b'still pump 1'
    assert not Node(tmp_path).taken


@pytest.mark.parametrize('room', [0, 1], ids=['for no file', 'for the lock alone'])
@pytest.mark.parametrize('reset', [False, True])
def test_a_disk_that_gives_no_answer_costs_no_state(tmp_path, room, reset):
    pump = Node(tmp_path)
    pump.keep(b'1')
    pump.states.release()
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    lowest = os.dup(0)
    os.close(lowest)
    resource.setrlimit(resource.RLIMIT_NOFILE, (lowest + room, limits[1]))
    try:
        again = Node(tmp_path)
        again.keep(b'too early')
        if reset:
            again.state.give_up()
            again.keep(b'too early')
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert again.log == [f'{tmp_path}/pump cannot be kept: Too many open files']
    again.keep(b'too early')
    assert names(tmp_path) == ['.pump.lock', 'pump']
    # Later the disk answers; what a reset has given up is not taken up then.
    assert again.load() != reset
    assert again.learnt == (None if reset else b'1')
    again.keep(b'2')
    assert again.state.problem == ''
    again.states.release()
    assert Node(tmp_path).learnt == b'2'


@pytest.mark.parametrize('damaged', [False, True])
def test_content_that_cannot_be_used_is_set_aside_and_learnt_anew(tmp_path, damaged):
    pump = Node(tmp_path)
    pump.keep(b'of a series')
    pump.states.release()
    if damaged:
        (tmp_path / 'pump').write_bytes((tmp_path / 'pump').read_bytes()[:-1])
    again = Node(tmp_path)
    again.keep(b'2')
    assert not again.taken
    (said,) = again.log
    reason = 'is damaged' if damaged else 'has version 1006'
    assert reason in said
    assert said.endswith(
        f'the file was renamed to {tmp_path}/pump.unreadable-1; learning starts again'
    )
    assert names(tmp_path) == ['.pump.lock', 'pump', 'pump.unreadable-1']


def test_a_state_that_is_set_aside_stays_under_a_name_of_its_own(tmp_path):
    pump = Node(tmp_path)
    for number in (1, 2):
        pump.keep(b'other %d' % number)
        pump.state.set_aside('the bearing is now 6205')
    pump.state.set_aside('nothing is there any more')
    pump.states.release()
    assert pump.log == [
        f'the bearing is now 6205; the file was renamed to {tmp_path}/pump.unreadable-{number}; '
        'learning starts again'
        for number in (1, 2)
    ]
    assert names(tmp_path) == ['.pump.lock', 'pump.unreadable-1', 'pump.unreadable-2']


def is_locked(folder, name='pump'):
    """Whether a process keeps the state; a disk that hangs gives the lock to be looked at."""
    with (folder / f'.{name}.lock').open() as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


@pytest.fixture
def waits(monkeypatch):
    """Return for how long a disk is waited for from now on, s: a busy machine takes longer."""
    asked = []

    def wait(jobs, timeout, wait=futures.wait):
        asked.append(timeout)
        return wait(jobs, timeout)

    monkeypatch.setattr(futures, 'wait', wait)
    return asked


def test_what_a_hanging_disk_takes_late_is_not_written_over_the_next_nodes(
    tmp_path, monkeypatch, waits
):
    monkeypatch.setattr(disksync, 'LONGEST', 0.5)
    with loop_disk(tmp_path) as disk:
        states = disk.path / 'states'
        pump = Node(states)
        pump.keep(b'1')
        with disk.hanging():
            pump.state.keep(lambda: b'2')
            pump.states.release()
            assert is_locked(states)
            assert pump.log == [
                f'the disk has not answered for 10 s: not written and still locked: {states}/pump'
            ]
            # Nor does the next one wait for longer, at its start and later.
            waits.clear()
            following = Node(states)
            following.load()
            assert sum(waits) < 0.6
            assert following.state.problem.startswith(f'{states}/pump is not read yet')
        end = time.monotonic() + 60.0
        while not following.load():
            assert time.monotonic() < end, following.state.problem
        assert following.learnt == b'2'
        following.keep(b'3')
        following.states.release()
        assert Node(states).learnt == b'3'
        assert not is_locked(states)


@pytest.mark.ros
def test_a_fleet_waits_once_for_a_disk_that_hangs(here, tmp_path, monkeypatch, waits):
    from bearing_twin.nodes.fleet import FleetNode

    monkeypatch.setattr(disksync, 'LONGEST', 1.0)
    with loop_disk(tmp_path) as disk:
        states = disk.path / 'states'
        learnt = {'bearing': '6307', 'state_directory': str(states)}
        assets = {name: {'diagnosis': learnt | {'state_name': name}} for name in 'abcde'}
        (tmp_path / 'assets.yaml').write_text(yaml.safe_dump({'assets': assets}))
        fleet = here(FleetNode, assets_file=f'{tmp_path}/assets.yaml')
        fleet.bring_up()
        # A baseline of nothing is one, too.
        assert asyncio.run(fleet._reset_all()) == '5 assets start anew'
        before = names(states)
        assert set('abcde') < set(before)
        with disk.hanging():
            fleet.trigger_deactivate()
            for member in fleet._members:
                member.diagnosis._keep()
            waits.clear()
            fleet.trigger_cleanup()
            fleet.trigger_configure()
            assert sum(waits) < 1.1
        # What hung, and what was asked for since, is done in turn.
        while fleet.states.disk.busy:
            time.sleep(0.01)
        assert names(states) == before
        for member in fleet._members:
            assert member.diagnosis._state.load(lambda _: None)
            member.diagnosis._keep()
            fleet.states.disk.settle()
            assert member.diagnosis._state.problem == ''


@pytest.mark.ros
def test_a_configure_that_fails_leaves_no_state_claimed(here, tmp_path, capfd):
    from bearing_twin.nodes.fleet import FleetNode

    learnt = {'bearing': '6307', 'state_directory': str(tmp_path)}
    assets = {name: {'diagnosis': learnt | {'state_name': name}} for name in 'ab'}
    (tmp_path / 'assets.yaml').write_text(yaml.safe_dump({'assets': assets}))
    # The second is refused when the first has its state.
    refused = {'qos_overrides./b/diagnosis.publisher.reliability': 'sometimes'}
    fleet = here(FleetNode, assets_file=f'{tmp_path}/assets.yaml', **refused)
    for _ in range(2):
        assert fleet.trigger_configure().name == 'FAILURE'
        assert not is_locked(tmp_path, 'a')
    assert 'kept by another node' not in capfd.readouterr().err


@pytest.mark.ros
def test_no_block_waits_for_a_disk_that_hangs_while_a_state_is_saved(nodes, probe, tmp_path):
    from bearing_twin_msgs.msg import TwinState, Vibration
    from bearing_twin_msgs.srv import LoadState, SaveState
    from probe import check_complete, DEEP
    from std_srvs.srv import Trigger

    with loop_disk(tmp_path) as disk:
        folder = {'state_directory': str(disk.path / 'states')}
        learnt = folder | {'bearing': '6307', 'state_name': 'pump', 'state_owner': '/x'}
        nodes.start('diagnosis', learnt)
        nodes.start('twin', folder | DEEP)
        blocks = probe.collect(Vibration, 'vibration')
        states = probe.collect(TwinState, 'twin_state')
        probe.until(lambda: blocks and states, 'blocks')
        assert probe.call(SaveState, 'twin/save_state', path='before').success
        calls = [
            (SaveState, 'twin/save_state', {'path': 'meanwhile'}),
            (LoadState, 'twin/load_state', {'path': 'meanwhile'}),
            (Trigger, 'diagnosis/reset', {}),
        ]
        clients = [probe.node.create_client(kind, name) for kind, name, _ in calls]
        for client in clients:
            probe.until(client.service_is_ready, client.srv_name)
        with disk.hanging():
            asked = [
                client.call_async(kind.Request(**fields))
                for client, (kind, _, fields) in zip(clients, calls, strict=True)
            ]
            count = len(blocks)
            probe.until(lambda: len(blocks) > count + 75, 'three seconds of blocks')
            assert not any(answer.done() for answer in asked)
        probe.until(lambda: all(answer.done() for answer in asked), 'the answers')
        assert all(answer.result().success for answer in asked)
        check_complete(states, blocks)
        assert states[-1].blocks_dropped == 0
        assert {'before', 'meanwhile', 'pump'} < set(names(disk.path / 'states'))
        assert nodes.end('twin') == 0
        assert nodes.end('diagnosis') == 0


@pytest.mark.ros
def test_an_answer_that_comes_after_its_service_ends_no_node(here, tmp_path, monkeypatch):
    from bearing_twin.nodes.diagnosis import DiagnosisNode
    from bearing_twin.ros.executor import LeanExecutor
    import rclpy
    from std_srvs.srv import Trigger

    monkeypatch.setattr(disksync, 'LONGEST', 0.2)
    with loop_disk(tmp_path) as disk:
        node = here(DiagnosisNode, state_directory=str(disk.path), state_name='pump')
        node.trigger_configure()
        executor = LeanExecutor()
        executor.add_node(node)
        asker = rclpy.create_node('asker')
        client = asker.create_client(Trigger, 'diagnosis/reset')
        assert client.wait_for_service(60.0)
        with disk.hanging():
            client.call_async(Trigger.Request())
            while not node.states.disk.busy:
                executor.spin_once(timeout_sec=0.1)
            node.trigger_cleanup()
            for _ in range(10):
                executor.spin_once(timeout_sec=0.1)
        executor.shutdown()
        asker.destroy_node()


@pytest.mark.ros
def test_a_sensor_with_many_gaps_has_its_baseline_written_as_seldom_as_another(here, tmp_path):
    from bearing_twin.nodes.diagnosis import DiagnosisNode
    from bearing_twin.streams.vibration_input import VibrationBlock

    node = here(DiagnosisNode, state_directory=str(tmp_path), state_name='pump', shaft_hz=25.0)
    node.bring_up()
    file, rng = tmp_path / 'pump', np.random.default_rng(0)
    written, verdicts = set(), 0
    for number in range(1000):
        if number % 35:
            samples = rng.standard_normal(1024).astype(np.float32)
            stamp = samples_ns(number * 1024, 25600.0)
            block = VibrationBlock(
                number * 1024, samples, 25600.0, math.nan, 'm/s^2', False, stamp
            )
            verdicts += node._topics.hold(block, temperature=math.nan)
            node.states.disk.settle()
            written.add(file.stat().st_mtime_ns if file.exists() else 0)
    # Of 40 s.
    assert verdicts > 20
    assert 2 < len(written) < 6
