# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A disk that is full, read-only or gone: nothing is raised, memory is bounded, it goes on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
import resource
import shutil
import sys
import time
import tracemalloc

from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import find_unfinished, recover
from bearing_twin.recording.snapshot import SnapshotWriter
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.streams.statefile import StateFolder
import pytest
from recording_samples import put_block, START, vibration_cdr
import yaml

SIZE = len(vibration_cdr(0))


@contextmanager
def file_size_limit(size: int) -> Iterator[None]:
    """
    Let the kernel refuse to make files larger than ``size`` bytes, as a full disk would.

    Modules that are imported meanwhile leave no code on the disk: Python would keep the part that
    is written, and no process could import them any more.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    kept, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = kept


def put(writer: RecordingWriter, index: int) -> None:
    put_block(writer, index, START + index)
    writer.flush()


def first_samples(path: Path) -> list[int]:
    return [m.decode().first_sample // 1024 for m in read_messages(path)]


def test_full_disk_loses_nothing_while_memory_lasts(tmp_path: Path) -> None:
    options = WriterOptions(compression='none')
    with RecordingWriter(tmp_path / 'run', options) as writer:
        with file_size_limit(100_000):
            for index in range(40):
                put(writer, index)
            assert 'File too large' in writer.problem
            torn = (tmp_path / 'run' / 'run_0.mcap').read_bytes()
            assert len(torn) == 100_000
        for index in range(40, 50):
            put(writer, index)
        assert writer.problem == ''
        assert writer.dropped == 0
    assert first_samples(tmp_path / 'run') == list(range(50))


@pytest.mark.parametrize('name', ['run', 'run.mcap'])
def test_a_recording_that_a_full_disk_refuses_leaves_nothing(tmp_path: Path, name: str) -> None:
    with file_size_limit(0), pytest.raises(BearingTwinError, match='File too large'):
        RecordingWriter(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_snapshot_that_a_full_disk_refuses_is_made_by_the_next_trigger(tmp_path: Path) -> None:
    writer = SnapshotWriter(tmp_path / 'run', before=1.0, after=1.0, memory=10**6)
    put(writer, 0)
    with file_size_limit(0), pytest.raises(BearingTwinError, match='File too large'):
        writer.trigger(START)
    put(writer, 1)
    writer.trigger(START + 1)
    writer.close()
    assert first_samples(tmp_path / 'run') == [0, 1]


def test_full_disk_drops_and_counts_when_memory_is_full(tmp_path: Path) -> None:
    options = WriterOptions(compression='none', cache_size=10 * SIZE)
    with RecordingWriter(tmp_path / 'run', options) as writer:
        with file_size_limit(100_000):
            for index in range(60):
                put(writer, index)
            dropped = writer.dropped
            assert dropped > 20
        writer.flush()
        for index in range(60, 70):
            put(writer, index)
        assert writer.dropped == dropped
    found = first_samples(tmp_path / 'run')
    assert len(found) == 70 - dropped
    assert found == sorted(found)
    # What came first after the disk filled up is kept, in one piece.
    assert found[: 60 - dropped] == list(range(60 - dropped))


@pytest.mark.parametrize('kind', ['recording', 'snapshot'])
def test_messages_that_wait_take_the_memory_that_is_stated(tmp_path: Path, kind: str) -> None:
    memory = 1_000_000
    with file_size_limit(4096):
        if kind == 'recording':
            options = WriterOptions(cache_size=memory, flush_period=60.0)
            writer = RecordingWriter(tmp_path / 'run', options)
            writer.problem = 'until the next flush'
        else:
            writer = SnapshotWriter(tmp_path / 'run', before=60.0, after=1.0, memory=memory)
        tracemalloc.start()
        for index in range(20_000):
            cdr = bytes((0, 1, 0, 0, index & 1))
            log_time = START + index
            writer.write(
                '/a', 'std_msgs/msg/Bool', cdr, log_time=log_time, publish_time=log_time - 7
            )
        taken, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert 0.8 * memory < taken < 1.2 * memory
    writer.close()


def test_disk_that_stays_full_leaves_a_file_to_recover(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / 'run', WriterOptions(compression='none'))
    with file_size_limit(100_000):
        for index in range(30):
            put(writer, index)
        with pytest.raises(BearingTwinError, match=r'could not be finished.*recover') as said:
            writer.close()
    assert not recording_info(tmp_path / 'run').finished
    # The writer is still there, and its file nobody's any more.
    recover(tmp_path / 'run', tmp_path / 'saved.mcap')
    report = first_samples(tmp_path / 'saved.mcap')
    assert report == list(range(len(report)))
    assert len(report) >= 100_000 // (SIZE + 300) - 1
    assert f'; {30 - len(report)} messages are lost' in str(said.value)


def test_folder_that_is_removed_is_made_again(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run', WriterOptions(compression='none')) as writer:
        for index in range(5):
            put(writer, index)
        shutil.rmtree(tmp_path / 'run')
        put(writer, 5)
        assert 'was removed' in writer.problem
        for index in range(6, 12):
            put(writer, index)
        assert writer.problem == ''
    # Only what the removed file held is lost; that is the nature of removing it.
    assert first_samples(tmp_path / 'run') == list(range(6, 12))
    assert (writer.written, writer.removed, writer.lost) == (6, 6, 6)


def test_finished_files_that_go_with_their_folder_are_counted(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run', WriterOptions(compression='none')) as writer:
        for index in range(12):
            put(writer, index)
            if index % 4 == 3:
                writer.split()
        while (tmp_path / 'run').exists():
            # Its metadata.yaml may be written just now.
            shutil.rmtree(tmp_path / 'run', ignore_errors=True)
        for index in range(12, 16):
            put(writer, index)
    assert first_samples(tmp_path / 'run') == [12, 13, 14, 15]
    assert (writer.written, writer.lost) == (4, 12)
    listed = yaml.safe_load((tmp_path / 'run' / 'metadata.yaml').read_text())
    assert listed['rosbag2_bagfile_information']['message_count'] == 4


def test_recovery_onto_a_full_disk_leaves_nothing_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with RecordingWriter(tmp_path / 'run.mcap', WriterOptions(compression='none')) as writer:
        for index in range(100):
            put(writer, index)
    for target in ('saved.mcap', 'saved'):
        with file_size_limit(100_000):
            command = ['recover', str(tmp_path / 'run.mcap'), '-o', str(tmp_path / target)]
            assert main(command) == 1
        said = capsys.readouterr()
        assert f'{target} was not written: ' in said.err
        assert 'make room, or choose another disk' in said.err
        assert not (tmp_path / target).exists()
        assert main(command) == 0


def test_folder_whose_parent_is_gone_waits(tmp_path: Path) -> None:
    disk = tmp_path / 'disk'
    with RecordingWriter(disk / 'run', WriterOptions(compression='none')) as writer:
        put(writer, 0)
        shutil.rmtree(disk)
        for index in range(1, 5):
            put(writer, index)
        assert writer.problem
        assert not disk.exists()
        disk.mkdir()
        put(writer, 5)
        assert writer.problem == ''
    assert first_samples(disk / 'run') == [2, 3, 4, 5]


def test_place_that_cannot_be_written_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / 'file').write_text('')
    with pytest.raises(BearingTwinError, match='cannot be made'):
        RecordingWriter(tmp_path / 'file' / 'run')
    with pytest.raises(BearingTwinError, match='cannot be made'):
        RecordingWriter(tmp_path / ('x' * 300))


def test_a_result_on_a_full_disk_is_whole_or_absent(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    schedule = tmp_path / 'schedule.mcap'
    write_temperature_recording(schedule, *paper_schedule(8.0), source='test')
    page, run = tmp_path / 'page.html', tmp_path / 'run'
    page.write_text('a page of before')
    with file_size_limit(2000):
        assert main(['schedule', '-o', str(tmp_path / 'cut.mcap')]) == 1
    assert 'was not written' in capsys.readouterr().err
    with file_size_limit(20_000):
        assert main(['replay', '--offline', str(schedule), '-o', str(run)]) == 1
    assert 'was not written' in capsys.readouterr().err
    assert not run.exists()
    assert main(['replay', '--offline', str(schedule), '-o', str(run)]) == 0
    with file_size_limit(20_000):
        assert main(['report', str(run), '-o', str(page)]) == 1
        assert main(['view', str(run), '--save', str(tmp_path / 'a.rrd')]) == 1
    assert page.read_text() == 'a page of before'
    assert sorted(p.name for p in tmp_path.iterdir()) == ['page.html', 'run', 'schedule.mcap']
    # A picture that failed leaves nothing behind that fails the next one of the process.
    assert main(['view', str(run), '--save', str(tmp_path / 'a.rrd')]) == 0


@contextmanager
def no_descriptor_left() -> Iterator[None]:
    held = []
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (256, hard))
    try:
        with suppress(OSError):
            while True:
                held.append(open('/dev/null'))  # noqa: PTH123, SIM115
        yield
    finally:
        for file in held:
            file.close()
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_no_descriptor_left_keeps_no_recorder_from_its_search(tmp_path: Path) -> None:
    (tmp_path / 'bag').mkdir()
    with no_descriptor_left():
        assert find_unfinished(tmp_path) == []


def test_no_descriptor_left_to_synchronise_is_told_and_recording_goes_on(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run', WriterOptions(sync_period=1e-3)) as writer:
        with no_descriptor_left():
            put_block(writer, 0)
            time.sleep(0.01)
            writer.flush()
        assert 'Too many open files' in writer.sync_problem
        put_block(writer, 1)
    assert recording_info(tmp_path / 'run').count == 2


def test_a_state_on_a_full_disk_takes_no_name(tmp_path: Path) -> None:
    states = StateFolder(str(tmp_path))
    with file_size_limit(20_000), pytest.raises(BearingTwinError, match='cannot be written'):
        states.save('a', bytes(100_000))
    assert not any(tmp_path.iterdir())
    states.save('a', bytes(100_000))
    with pytest.raises(BearingTwinError, match='is not overwritten'):
        states.save('a', b'')
    assert states.load('a') == bytes(100_000)
    assert [path.name for path in tmp_path.iterdir()] == ['a']
