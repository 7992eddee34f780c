# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a power cut leaves: a disk in a file, copied while it is mounted, and the copy mounted."""

from __future__ import annotations

from collections.abc import Iterator
import os
from pathlib import Path
import time
from typing import TYPE_CHECKING

from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.streams.statefile import NodeStates, StateFolder
from loopdisk import loop_disk
import pytest
from recording_samples import put_block, START
import yaml

if TYPE_CHECKING:
    from bearing_twin.streams.statefile import KeptState
    from loopdisk import Disk


@pytest.fixture(params=['auto_da_alloc', 'noauto_da_alloc'])
def disk(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Disk]:
    with loop_disk(tmp_path, request.param) as made:
        yield made


def test_a_state_survives_a_power_cut(disk: Disk) -> None:
    def states(folder: Path) -> tuple[NodeStates, list[KeptState]]:
        node = NodeStates(print)
        common = {'state_directory': str(folder), 'state_owner': ''}
        return node, [node.kept(common | {'state_name': n}, '/pump') for n in ('kept', 'first')]

    node, kept = states(disk.path / 'states')
    for state in kept:
        state.load(print, wait=True)
    kept[0].keep(lambda: b'A' * 20_000)
    node.disk.settle()
    os.sync()
    kept[0].keep(lambda: b'B' * 20_000)
    kept[1].keep(lambda: b'F' * 20_000)
    StateFolder(str(disk.path / 'states')).save('saved', b'S' * 20_000)
    node.release()
    assert not any(state.problem for state in kept)
    time.sleep(2.5)
    after = disk.cut() / 'states'
    learnt: list[bytes] = []
    for state in states(after)[1]:
        assert state.load(learnt.append, wait=True)
    learnt.append(StateFolder(str(after)).load('saved'))
    assert learnt == [letter * 20_000 for letter in (b'B', b'F', b'S')]


def test_a_finished_bag_survives_a_power_cut(disk: Disk) -> None:
    with RecordingWriter(disk.path / 'run') as writer:
        for index in range(20):
            put_block(writer, index)
    time.sleep(2.5)
    bag = disk.cut() / 'run'
    assert len(list(read_messages(bag))) == 20
    listed = yaml.safe_load((bag / 'metadata.yaml').read_text())
    assert listed['rosbag2_bagfile_information']['message_count'] == 20


def test_a_power_cut_costs_the_sync_and_the_flush_period(disk: Disk, tmp_path: Path) -> None:
    options = WriterOptions(sync_period=1.0, flush_period=0.2)
    writer = RecordingWriter(disk.path / 'run', options)
    began = time.monotonic()
    while (now := time.monotonic() - began) < 4.0:
        put_block(writer, 0, START + round(now * 1e9))
        time.sleep(0.02)
    after = disk.cut() / 'run'
    writer.close()
    recover(after, tmp_path / 'saved.mcap')
    info = recording_info(tmp_path / 'saved.mcap')
    # Besides the two periods, an fsync of a busy disk.
    assert info.duration >= 4.0 - 1.2 - 0.8
