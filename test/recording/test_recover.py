# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Torn and damaged recordings: what is complete is saved, what is not is said."""

from __future__ import annotations

import fcntl
import os
import random
import shutil
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.foreign import read_signal
from bearing_twin.recording.mcapfile import UnfinishedRecording
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import find_unfinished, recover
from bearing_twin.recording.writer import RecordingWriter
from mcap.reader import make_reader
import pytest
from recording_samples import START, TEMPERATURE, temperature_cdr, VIBRATION, write_blocks
from rosbags.rosbag2 import Reader

if TYPE_CHECKING:
    from pathlib import Path


def chunks(path: Path) -> list[tuple[int, int, int]]:
    """Return begin, end and number of messages of every chunk of a sound file."""
    with path.open('rb') as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    found = []
    for index in summary.chunk_indexes:
        end = index.chunk_start_offset + index.chunk_length
        found.append((index.chunk_start_offset, end, index.message_index_length))
    return sorted(found)


def test_cut_at_any_byte_every_complete_chunk_is_saved(tmp_path: Path) -> None:
    whole = tmp_path / 'whole.mcap'
    written = write_blocks(whole, 60)
    ends = [end for _, end, _ in chunks(whole)]
    content = whole.read_bytes()
    cuts = {8, 9, 40, len(content) - 1, *ends, *(end - 1 for end in ends)}
    cuts |= set(random.Random(5).sample(range(10, len(content)), 30))
    for cut in sorted(cuts):
        torn, saved = tmp_path / 'torn.mcap', tmp_path / 'saved.mcap'
        torn.write_bytes(content[:cut])
        saved.unlink(missing_ok=True)
        report = recover(torn, saved)
        complete = sum(end <= cut for end in ends)
        assert report.kept == 20 * complete, cut
        vibration = list(read_messages(saved, topics=['/vibration']))
        assert [m.cdr for m in vibration] == written[: 10 * complete]
        assert recording_info(saved).finished
        # Of the last record, the footer, only the closing magic bytes may be missing.
        assert bool(report.losses) == (cut < len(content) - 8)


def test_saved_recording_has_schemas_qos_and_attachments(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'whole.mcap', 30)
    content = (tmp_path / 'whole.mcap').read_bytes()
    (tmp_path / 'torn.mcap').write_bytes(content[:-2000])
    recover(tmp_path / 'torn.mcap', tmp_path / 'saved')
    before, after = (
        recording_info(tmp_path / 'whole.mcap'),
        recording_info(tmp_path / 'saved'),
    )
    assert after.topics == before.topics
    assert after.attachments == before.attachments
    assert after.metadata['bearing_twin.test'] == {'key': 'value'}
    with Reader(tmp_path / 'saved') as reader:
        assert reader.message_count == 60


def test_a_damaged_chunk_costs_that_chunk_only(tmp_path: Path) -> None:
    path = tmp_path / 'run.mcap'
    written = write_blocks(path, 60)
    content = bytearray(path.read_bytes())
    begin, end, _ = chunks(path)[2]
    content[(begin + end) // 2] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(BearingTwinError, match='recover'):
        list(read_messages(path))
    report = recover(path, tmp_path / 'saved.mcap')
    assert len(report.losses) == 1
    assert 'CRC' in report.losses[0] or 'unpack' in report.losses[0]
    found = [m.cdr for m in read_messages(tmp_path / 'saved.mcap', topics=['/vibration'])]
    assert found == written[:20] + written[30:]


def test_torn_files_say_how_to_mend_them(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run.mcap', 20)
    torn = tmp_path / 'torn.mcap'
    torn.write_bytes((tmp_path / 'run.mcap').read_bytes()[:-500])
    with pytest.raises(UnfinishedRecording, match='bearing-twin recover'):
        list(read_messages(torn))
    assert len(list(read_messages(torn, recover=True))) == 40
    info = recording_info(torn)
    assert not info.finished
    assert info.count == 40


def test_source_is_left_alone_and_target_not_overwritten(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run.mcap', 20)
    torn = tmp_path / 'torn.mcap'
    torn.write_bytes((tmp_path / 'run.mcap').read_bytes()[:-500])
    before = torn.read_bytes()
    recover(torn, tmp_path / 'saved.mcap')
    assert torn.read_bytes() == before
    with pytest.raises(BearingTwinError, match='is not overwritten'):
        recover(torn, tmp_path / 'saved.mcap')


def test_what_is_not_ours_to_save(tmp_path: Path) -> None:
    other = tmp_path / 'other.mcap'
    other.write_bytes(b'SQLite format 3\0' * 20)
    with pytest.raises(BearingTwinError, match='is no MCAP file'):
        recover(other, tmp_path / 'saved.mcap')
    with pytest.raises(BearingTwinError, match='does not exist'):
        recover(tmp_path / 'nothing.mcap', tmp_path / 'saved2.mcap')


def test_own_unfinished_files_are_found_and_live_ones_are_not(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'sound', 10)
    shutil.copytree(tmp_path / 'sound', tmp_path / 'torn')
    file = tmp_path / 'torn' / 'sound_0.mcap'
    file.write_bytes(file.read_bytes()[:-100])
    (tmp_path / 'foreign.mcap').write_bytes(b'\x89MCAP0\r\n')
    (tmp_path / 'text.mcap').write_text('no MCAP')
    assert find_unfinished(tmp_path) == [tmp_path / 'torn']
    with RecordingWriter(tmp_path / 'live') as writer:
        writer.write('/t', TEMPERATURE, temperature_cdr(START, 20.0), log_time=1, publish_time=1)
        writer.flush()
        assert find_unfinished(tmp_path) == [tmp_path / 'torn']
        with pytest.raises(BearingTwinError, match='still being written'):
            recover(tmp_path / 'live', tmp_path / 'saved')
    with file.open('rb') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert find_unfinished(tmp_path) == []


def test_topic_with_two_types_in_two_files(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run') as writer:
        writer.write('/t', TEMPERATURE, temperature_cdr(1, 20.0), log_time=1, publish_time=1)
        writer.write('/t', VIBRATION, b'\x00\x01\x00\x00', log_time=2, publish_time=2)
        writer.write('/t', TEMPERATURE, temperature_cdr(3, 21.0), log_time=3, publish_time=3)
    types = [m.type_name for m in read_messages(tmp_path / 'run')]
    assert types == [TEMPERATURE, VIBRATION, TEMPERATURE]


@pytest.mark.parametrize('kind', ['mcap', 'npz', 'mat', 'wav', 'csv'])
def test_a_pipe_or_a_device_is_no_recording(kind: str, tmp_path: Path) -> None:
    pipe, device = tmp_path / f'pipe.{kind}', tmp_path / f'device.{kind}'
    os.mkfifo(pipe)
    device.symlink_to('/dev/zero')
    for path in (pipe, device):
        with pytest.raises(BearingTwinError, match='pipe, socket or device'):
            read_signal(path)
    if kind == 'mcap':
        for path in (pipe, device, tmp_path):
            with pytest.raises(BearingTwinError, match='pipe, socket or device'):
                recording_info(path)
            with pytest.raises(BearingTwinError, match='pipe, socket or device'):
                recover(path, tmp_path / 'out')
        assert not (tmp_path / 'out').exists()
        # The recorder looks here when it starts.
        assert find_unfinished(tmp_path) == []
