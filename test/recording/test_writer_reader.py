# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as others see them, and as we read them back."""

from __future__ import annotations

import os
from pathlib import Path
import shlex
import struct
import sys
from types import SimpleNamespace

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording import bagmetadata, reader
from bearing_twin.recording.health import examine, SENT_BEFORE, sent_before
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.writer import RecordingWriter, whole_recording, WriterOptions
from copies import raw_recording
from mcap.reader import make_reader
from mcap_ros2.reader import read_ros2_messages
import numpy as np
import pytest
from recording_samples import (
    NANO,
    PERIOD,
    put_block,
    START,
    TEMPERATURE,
    temperature_cdr,
    VIBRATION,
    write_blocks,
)
from rosbags.convert.cli import main as convert_bag
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
import yaml


@pytest.mark.parametrize('name', ['run', 'run.mcap'])
@pytest.mark.parametrize('compression', ['zstd', 'lz4', 'none'])
def test_round_trip(tmp_path: Path, name: str, compression: str) -> None:
    path = tmp_path / name
    written = write_blocks(path, 30, WriterOptions(compression=compression))
    messages = list(read_messages(path, topics=['/vibration']))
    assert [m.cdr for m in messages] == written
    assert [m.log_time for m in messages] == [START + i * PERIOD for i in range(30)]
    assert all(m.publish_time == m.log_time - 5 for m in messages)
    block = messages[7].decode()
    assert block.first_sample == 7 * 1024
    np.testing.assert_array_equal(block.y, 2.0 * block.x)
    assert block.header.frame_id == 'sensor'


def test_rosbags_opens_the_folder_and_the_file(tmp_path: Path) -> None:
    written = write_blocks(tmp_path / 'run', 30)
    with Reader(tmp_path / 'run') as reader:
        assert reader.message_count == 60
        assert reader.duration == 29 * PERIOD + 1 + 1
        connection = next(c for c in reader.connections if c.topic == '/vibration')
        assert connection.ext.offered_qos_profiles[0].depth == 50
        assert connection.ext.offered_qos_profiles[0].reliability.name == 'RELIABLE'
        assert [raw for _, _, raw in reader.messages(connections=[connection])] == written
    with AnyReader([tmp_path / 'run']) as reader:
        connection = next(c for c in reader.connections if c.topic == '/temperature')
        values = [
            reader.deserialize(raw, connection.msgtype).temperature
            for _, _, raw in reader.messages(connections=[connection])
        ]
    assert values == [20.0 + i for i in range(30)]


def test_mcap_ros2_support_decodes_every_message(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run.mcap', 5)
    decoded = list(read_ros2_messages(str(tmp_path / 'run.mcap'), topics=['/vibration']))
    assert [m.ros_msg.first_sample for m in decoded] == [1024 * i for i in range(5)]
    assert decoded[3].ros_msg.y[5] == pytest.approx(2.0 * decoded[3].ros_msg.x[5])


def test_what_rosbag2_looks_for(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 30)
    with (tmp_path / 'run' / 'run_0.mcap').open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == 'ros2'
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 60
        channel = next(c for c in summary.channels.values() if c.topic == '/vibration')
        schema = summary.schemas[channel.schema_id]
        assert channel.message_encoding == 'cdr'
        assert (schema.name, schema.encoding) == (VIBRATION, 'ros2msg')
        assert b'MSG: std_msgs/Header' in schema.data
        assert channel.metadata['topic_type_hash'].startswith('RIHS01_')
        records = {record.name: record.metadata for record in reader.iter_metadata()}
        assert sum(1 for _ in reader.iter_messages()) == 60
    inside = yaml.safe_load(records['rosbag2']['serialized_metadata'])
    outside = yaml.safe_load((tmp_path / 'run' / 'metadata.yaml').read_text())
    assert outside == {'rosbag2_bagfile_information': inside}
    assert inside['version'] == 9
    assert inside['relative_file_paths'] == ['run_0.mcap']


def test_info_agrees_with_what_was_written(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 30)
    info = recording_info(tmp_path / 'run')
    assert (info.count, info.finished, info.problems) == (60, True, [])
    assert info.duration == pytest.approx(29 * PERIOD / NANO, abs=1e-6)
    assert info.topics['/vibration'].count == 30
    assert info.metadata['bearing_twin.test'] == {'key': 'value'}
    assert info.attachments == {'note.txt': 8}


def test_a_split_recording_reads_as_one(tmp_path: Path) -> None:
    written = write_blocks(tmp_path / 'run', 130, WriterOptions(split_duration=0.4), flush_each=1)
    files = sorted((tmp_path / 'run').glob('*.mcap'))
    assert len(files) == 13
    messages = list(read_messages(tmp_path / 'run', topics=['/vibration']))
    assert [m.cdr for m in messages] == written
    with Reader(tmp_path / 'run') as reader:
        assert reader.message_count == 260
    for file in files:
        # Each file stands alone.
        assert recording_info(file).attachments == {'note.txt': 8}


def test_a_folder_around_a_bag_names_it(tmp_path: Path) -> None:
    bag = tmp_path / 'demo' / 'bag'
    write_blocks(bag, 3)
    with pytest.raises(BearingTwinError, match=f'name the bag in it, e.g. {bag}'):
        recording_info(tmp_path / 'demo')
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BearingTwinError, match=r'no \.mcap file is in it$'):
        recording_info(tmp_path / 'empty')


def test_a_bag_of_the_storage_sqlite3_is_converted_as_its_refusal_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    def convert(words: list[str]) -> None:
        monkeypatch.setattr(sys, 'argv', words)
        with pytest.raises(SystemExit, match='0'):
            convert_bag()

    write_blocks(tmp_path / 'mcap', 3)
    convert(['', '--src', 'mcap', '--dst', 'run 7', '--dst-storage', 'sqlite3'])
    for name in ('run 7', 'run 7/run 7.db3'):
        with pytest.raises(BearingTwinError, match='bags in the storage sqlite3 are not') as error:
            recording_info(tmp_path / name)
    convert(shlex.split(str(error.value).split("'", 1)[1].removesuffix("'")))
    assert len(list(read_messages(tmp_path / 'run 7_mcap'))) == 6


def test_split_by_size(tmp_path: Path) -> None:
    options = WriterOptions(split_size=100_000, compression='none')
    write_blocks(tmp_path / 'run', 60, options, flush_each=1)
    sizes = [f.stat().st_size for f in (tmp_path / 'run').glob('*.mcap')]
    assert len(sizes) > 3
    # One block, and index and end of the file, may go beyond.
    assert max(sizes) < 100_000 + 20_000


def test_time_section(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 50)
    start, end = START + 10 * PERIOD, START + 20 * PERIOD
    found = [m.log_time for m in read_messages(tmp_path / 'run', start=start, end=end)]
    assert min(found) == start
    assert max(found) == end - PERIOD + 1
    assert len(found) == 20


def test_messages_out_of_order_come_in_order(tmp_path: Path) -> None:
    times = [5, 1, 9, 3, 7, 2, 8, 0, 6, 4]
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        for time in times:
            cdr = temperature_cdr(time, float(time))
            writer.write('/t', TEMPERATURE, cdr, log_time=time)
            if time % 2:
                writer.flush()
    found = [m.decode().temperature for m in read_messages(tmp_path / 'run.mcap')]
    assert found == sorted(float(t) for t in times)


def test_files_without_chunks_and_without_summary_are_read(tmp_path: Path) -> None:
    path = tmp_path / 'plain.mcap'
    with raw_recording(
        path, use_chunking=False, use_statistics=False, use_summary_offsets=False
    ) as writer:
        schema = writer.register_schema(TEMPERATURE, 'ros2msg', b'float64 temperature\n')
        channel = writer.register_channel('/t', 'cdr', schema)
        for time in range(5):
            data = struct.pack('<4xd', float(time))
            data = b'\x00\x01\x00\x00' + data[4:]
            writer.add_message(channel, time, data, time)
    messages = list(read_messages(path))
    assert [m.decode().temperature for m in messages] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert recording_info(path).count == 5


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run', 1)
    before = (tmp_path / 'run' / 'run_0.mcap').read_bytes()
    with pytest.raises(BearingTwinError, match='is not overwritten'):
        RecordingWriter(tmp_path / 'run')
    (tmp_path / 'file.mcap').write_bytes(b'mine')
    with pytest.raises(BearingTwinError, match='is not overwritten'):
        RecordingWriter(tmp_path / 'file.mcap')
    assert (tmp_path / 'run' / 'run_0.mcap').read_bytes() == before
    assert (tmp_path / 'file.mcap').read_bytes() == b'mine'


@pytest.mark.parametrize('name', ['run', 'file.mcap'])
def test_of_two_that_take_one_name_at_once_the_later_one_removes_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / name
    with RecordingWriter(path) as first:
        put_block(first, 0)
        # The later one has looked before the first one came.
        with monkeypatch.context() as patched:
            patched.setattr(type(path), 'exists', lambda _: False)
            with pytest.raises(BearingTwinError, match=r'cannot be made: .*exists'):
                RecordingWriter(path)
    assert first.lost == 0
    assert recording_info(path).count == 1


def test_storage_limit_stops(tmp_path: Path) -> None:
    limit = 200_000
    with RecordingWriter(tmp_path / 'run', WriterOptions(storage_limit=limit)) as writer:
        for index in range(100):
            put_block(writer, index, index)
            writer.flush()
        assert 'storage limit' in writer.stopped
        assert writer.written + writer.dropped == 100
        assert writer.written > 10
    assert sum(f.stat().st_size for f in (tmp_path / 'run').iterdir()) < limit + 40_000
    assert recording_info(tmp_path / 'run').count == writer.written


def test_storage_limit_holds_where_a_file_may_be_larger(tmp_path: Path) -> None:
    options = WriterOptions(
        storage_limit=200_000, split_duration=1e6, delete_oldest=True, compression='none'
    )
    with RecordingWriter(tmp_path / 'run', options) as writer:
        for index in range(200):
            put_block(writer, index, index)
            writer.flush()
        assert writer.size < 210_000
    assert recording_info(tmp_path / 'run').count > 10


def test_what_files_of_a_bag_repeat_is_no_problem(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reader, 'MOST_METADATA', 10_000)
    with RecordingWriter(tmp_path / 'run') as writer:
        writer.metadata('told', {'text': 'x' * 8000})
        for index in range(5):
            put_block(writer, index, index)
            writer.split()
    info = recording_info(tmp_path / 'run')
    assert not info.problems
    assert info.metadata['told'] == {'text': 'x' * 8000}


def test_an_interrupted_result_is_not_left(tmp_path: Path) -> None:
    def interrupted() -> None:
        with whole_recording(tmp_path / 'run') as writer:
            put_block(writer, 0)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not (tmp_path / 'run').exists()


def test_storage_limit_deletes_its_own_oldest_files_only(tmp_path: Path) -> None:
    options = WriterOptions(
        storage_limit=200_000, split_size=50_000, delete_oldest=True, compression='none'
    )
    with RecordingWriter(tmp_path / 'run', options) as writer:
        (tmp_path / 'run' / 'other.txt').write_text('not ours')
        for index in range(200):
            put_block(writer, index, index)
            writer.flush()
        assert writer.dropped == 0
    assert (tmp_path / 'run' / 'other.txt').exists()
    messages = list(read_messages(tmp_path / 'run'))
    assert messages[-1].decode().first_sample == 199 * 1024
    assert messages[0].decode().first_sample > 0
    with Reader(tmp_path / 'run') as reader:
        assert reader.message_count == len(messages)


@pytest.mark.parametrize('delete', [True, False])
def test_the_list_of_files_is_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, delete: bool
) -> None:
    monkeypatch.setattr(bagmetadata, 'MOST_FILES', 3)
    run = tmp_path / 'run'
    options = WriterOptions(split_size=1, storage_limit=10**9, delete_oldest=delete)
    with RecordingWriter(run, options) as to:
        for index in range(10):
            put_block(to, index, index)
            to.flush()
        assert len(to._finished.files) == 3
        on_disk = {path.name: path.stat().st_size for path in run.glob('*.mcap')}
        assert to.size == sum(on_disk.values())
        assert len(on_disk) == (4 if delete else 10)
    with Reader(run) as reader:
        assert [message[1] for message in reader.messages()][-1] == 9
    assert [m.log_time for m in read_messages(run)] == list(range(6 if delete else 0, 10))


@pytest.mark.parametrize(
    ('options', 'name', 'text'),
    [
        (WriterOptions(split_size=1), 'a.mcap', 'cannot be split'),
        (WriterOptions(delete_oldest=True), 'a', 'needs a storage limit'),
        (WriterOptions(compression='rar'), 'a', 'is not one of'),
    ],
)
def test_options_that_do_not_fit(
    tmp_path: Path, options: WriterOptions, name: str, text: str
) -> None:
    with pytest.raises(BearingTwinError, match=text):
        RecordingWriter(tmp_path / name, options)
    assert not (tmp_path / name).exists()


def test_unknown_types_and_impossible_times_are_refused(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        with pytest.raises(BearingTwinError, match='not installed'):
            writer.write('/a', 'no_such/msg/Type', b'', log_time=0)
        with pytest.raises(BearingTwinError, match='no message type'):
            writer.write('/a', '../../etc/passwd', b'', log_time=0)
        with pytest.raises(BearingTwinError, match='log_time=-1'):
            writer.write('/a', TEMPERATURE, b'', log_time=-1, publish_time=0)


def test_what_was_received_at_one_time_comes_as_it_was_written(tmp_path: Path) -> None:
    """A chunk with an early message is opened before those that lie before it in the file."""
    path = tmp_path / 'a.mcap'
    with raw_recording(path, chunk_size=2**20) as writer:
        channel = writer.register_channel('/x', 'cdr', 0)
        for number, time in enumerate((5, 7, 7, 7, 7, 3, 7, 9)):
            writer.add_message(channel, time, bytes([number]), time)
            if number in (2, 4):
                writer.flush()
    numbers = [message.cdr[0] for message in read_messages(path)]
    assert numbers == [5, 0, 1, 2, 3, 4, 6, 7]


def test_two_sources_on_one_topic_are_said_to_be_two(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        for count in range(20):
            for source in (0, 858_926):
                time = START + (2 * count + (source > 0)) * PERIOD
                put_block(writer, source + count + (count > 10), time)
    health = examine(tmp_path / 'run.mcap')[1]
    topic = health.topics['/vibration']
    assert topic.alternations >= 30
    # Not the 879 million between their indices.
    assert topic.samples_missing <= 2 * 1024
    assert any('several sources alternate' in problem for problem in health.problems)


def test_health_finds_what_is_missing(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        for index in [0, 1, 2, 5, 6, 4, 7]:
            put_block(writer, index)
    health = examine(tmp_path / 'run.mcap')[1]
    topic = health.topics['/vibration']
    # 2 -> 5 leaves out two blocks, 6 -> 4 goes back, 4 -> 7 leaves out two again.
    assert (topic.gaps, topic.samples_missing, topic.restarts) == (2, 4 * 1024, 1)
    assert topic.backwards == 1
    assert topic.longest_gap == pytest.approx(3 * PERIOD / NANO)
    assert len(health.problems) == 3
    write_blocks(tmp_path / 'sound', 20)
    sound = examine(tmp_path / 'sound')[1]
    assert sound.problems == []
    assert sound.topics['/vibration'].worst_stamp_error < 1e-9


def test_a_name_that_metadata_cannot_hold_is_refused(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b'bag\xff')
    with pytest.raises(BearingTwinError, match='is not UTF-8; choose another name'):
        RecordingWriter(path)
    assert list(tmp_path.iterdir()) == []


def test_many_topics_cost_what_they_hold(tmp_path: Path) -> None:
    path = tmp_path / 'a.mcap'
    with RecordingWriter(path, WriterOptions(compression='none', flush_period=60.0)) as writer:
        for k in range(20_000):
            writer.write(f'/t{k}', TEMPERATURE, bytes(100), log_time=k)
    # Each is described once, and once or twice again: not all of them in each chunk.
    assert path.stat().st_size < 20_000 * 3000
    assert recording_info(path).count == 20_000


def test_a_count_of_more_digits_than_a_number_has_is_none() -> None:
    item = SimpleNamespace(key=SENT_BEFORE, value=f'/a {"9" * 5000}; /b 3')
    diagnostics = SimpleNamespace(status=[SimpleNamespace(values=[item])])
    assert sent_before(diagnostics) == {'/b': 3}
