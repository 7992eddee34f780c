# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Torn and damaged recordings: complete chunks are saved, losses are reported."""

from __future__ import annotations

import errno
import fcntl
import io
import os
from pathlib import Path
import random
import shutil
import time

from bearing_twin.cli import main
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording import outfile
from bearing_twin.recording.health import examine
from bearing_twin.recording.mcap import catalogue
from bearing_twin.recording.mcap.mcapfile import (
    BrokenRecording,
    RECORD_HEAD,
    UnfinishedRecording,
)
from bearing_twin.recording.mcap.messages import in_file_order, Selection
from bearing_twin.recording.mcap.schema import MessageSchema
from bearing_twin.recording.outfile import MOST_CHANNELS
from bearing_twin.recording.player import Player
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import find_unfinished, recover, RecoveryReport
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from cases import in_proofs
from copies import raw_recording
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel
from mcap.writer import Writer
import pytest
from recording_samples import (
    seconds_of_heads,
    START,
    TEMPERATURE,
    temperature_cdr,
    write_blocks,
)
from rosbags.rosbag2 import Reader


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
    before, after = (recording_info(tmp_path / 'whole.mcap'), recording_info(tmp_path / 'saved'))
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


def flipped(content: bytes, at: int, bit: int = 0) -> bytes:
    damaged = bytearray(content)
    damaged[at] ^= 1 << bit
    return bytes(damaged)


def kept_of(content: bytes, folder: Path) -> tuple[int, RecoveryReport]:
    """Recover a file; return the number of its messages and the report."""
    torn, saved = folder / 'torn.mcap', folder / 'saved.mcap'
    torn.write_bytes(content)
    saved.unlink(missing_ok=True)
    report = recover(torn, saved)
    found = len(list(read_messages(saved)))
    assert found == report.kept
    return found, report


@pytest.mark.parametrize('finished', [True, False])
@pytest.mark.parametrize('compression', ['zstd', 'lz4', 'none'])
@pytest.mark.parametrize('step', [5, *in_proofs(1)])
def test_one_flipped_bit_costs_one_chunk(
    tmp_path: Path, finished: bool, compression: str, step: int
) -> None:
    path = tmp_path / 'run.mcap'
    write_blocks(path, 60, WriterOptions(compression=compression))
    content = path.read_bytes()
    begin, end, _ = chunks(path)[0]
    last = chunks(path)[-1][1]
    # A busy machine closes one before it is full.
    lengths = [end - begin for begin, end, _ in chunks(path)]
    if not finished:
        content = content[: last + 10]
    rng = random.Random(9)
    # In steps up to the head of the first chunk, then anywhere in it and anywhere at all.
    # Compressed or not, the file is the same up to there.
    places = [*range(0, begin + 60, step)] if compression == 'zstd' else []
    places += [rng.randrange(begin, end) for _ in range(10)]
    places += [rng.randrange(last) for _ in range(20)]
    for at in places:
        kept, report = kept_of(flipped(content, at, rng.randrange(8)), tmp_path)
        assert kept >= 100, at
        lost = 120 - kept
        assert report.lost_messages == (lost if finished else 0), at
        if lost:
            assert report.losses, at
            assert 0.9 * min(lengths) < report.lost_bytes < 2 * max(lengths), at


def test_a_channel_of_the_summary_that_looks_like_a_message_is_none(tmp_path: Path) -> None:
    path = tmp_path / 'run.mcap'
    write_blocks(path, 60)
    content = path.read_bytes()
    at, channels = content.index(RECORD_HEAD.pack(Opcode.DATA_END, 4)) + 13, 0
    while content[at] != Opcode.FOOTER:
        if content[at] == Opcode.CHANNEL:
            kept, report = kept_of(flipped(content, at, 0), tmp_path)
            assert kept == 120
            assert any('a message in the summary' in loss for loss in report.losses)
            channels += 1
        at += 9 + RECORD_HEAD.unpack_from(content, at)[1]
    assert channels == 2


@pytest.mark.parametrize('finished', [True, False])
@pytest.mark.parametrize('length', [1, 8, 4096])
def test_a_damaged_head_costs_what_it_holds(
    tmp_path: Path, length: int, finished: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'run.mcap'
    write_blocks(path, 60)
    content, found = path.read_bytes(), chunks(path)
    content = bytes(length) + content[length : None if finished else found[-1][1]]
    kept, report = kept_of(content, tmp_path)
    assert kept == 20 * sum(begin >= length for begin, _, _ in found)
    assert kept
    assert 'it begins with zeros' in report.losses[0] or 'magic bytes' in report.losses[0]
    assert report.lost_bytes <= max(8, min(b for b, _, _ in found if b >= length))
    path.write_bytes(content)
    assert recording_info(path).count == kept
    assert sum(topic.count for topic in examine(path)[1].topics.values()) == kept
    assert main(['info', str(path)]) == 1
    with pytest.raises(BearingTwinError, match='recover'):
        list(read_messages(path))


class BadSector(io.BytesIO):
    """A file with a sector that the disk cannot read."""

    sector = 0

    def read(self, length: int | None = -1) -> bytes:
        assert length is not None
        if self.tell() < self.sector + 4096 and self.tell() + length > self.sector:
            raise OSError(errno.EIO, 'Input/output error')
        return super().read(length)


def test_a_bad_sector_costs_the_chunk_it_is_in(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'run.mcap', 60)
    found = chunks(tmp_path / 'run.mcap')
    file = BadSector((tmp_path / 'run.mcap').read_bytes())
    size = len(file.getvalue())
    for sector in (*range(0, size, 4096), size - 4096):
        file.sector = sector
        losses: list[BrokenRecording] = []
        kept = len(list(in_file_order(file, size, Selection(), losses.append)))
        assert kept == 20 * sum(end <= sector or begin >= sector + 4096 for begin, end, _ in found)
        lost = sum(loss.length for loss in losses)
        assert lost < 2 * max(end - begin for begin, end, _ in found) + 4096


def test_entries_of_a_bag_that_are_no_files_cost_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = tmp_path / 'bag'
    write_blocks(bag, 20)
    (bag / 'old.mcap').mkdir()
    (bag / 'away.mcap').symlink_to('nowhere')
    (bag / 'here.mcap').symlink_to('.')
    os.mkfifo(bag / 'pipe.mcap')
    report = recover(bag, tmp_path / 'saved')
    assert (report.kept, len(report.losses), report.lost_bytes) == (40, 4, 0)
    info = recording_info(bag)
    assert (info.count, len(info.problems)) == (40, 4)
    assert len(examine(bag)[1].problems) == 4
    problems: list[str] = []
    assert len(list(read_messages(bag, problems=problems))) == 40
    assert len(problems) == 4
    capsys.readouterr()
    assert main(['info', str(bag)]) == 1
    said = capsys.readouterr()
    for name in ('old.mcap', 'away.mcap', 'here.mcap', 'pipe.mcap'):
        assert name in said.out + said.err


def test_a_description_that_is_nowhere_else_is_found_in_the_summary(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As recorders write that describe each channel once.
    monkeypatch.setattr(outfile._RepeatingWriter, 'repeat', lambda self: None)
    path = tmp_path / 'old.mcap'
    write_blocks(path, 60)
    begin, end, _ = chunks(path)[0]
    kept, report = kept_of(flipped(path.read_bytes(), (begin + end) // 2), tmp_path)
    assert (kept, report.lost_messages) == (100, 20)


def test_messages_whose_description_is_lost_are_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(outfile._RepeatingWriter, 'repeat', lambda self: None)
    path = tmp_path / 'old.mcap'
    write_blocks(path, 60)
    begin, end, _ = chunks(path)[0]
    torn = flipped(path.read_bytes()[: chunks(path)[-1][1]], (begin + end) // 2)
    kept, report = kept_of(torn, tmp_path)
    assert kept == 0
    for channel in (1, 2):
        text = f'50 messages of channel {channel}, whose description is lost'
        assert any(text in loss for loss in report.losses)
    assert report.lost_bytes > 50 * 2 * 4 * 1024


@pytest.mark.parametrize('length', [0, 4096, *in_proofs(5, 8, 3_000_000)])
@pytest.mark.parametrize('place', [0, 1, 2])
def test_an_empty_or_zeroed_file_blocks_no_bag(
    tmp_path: Path, length: int, place: int, capsys: pytest.CaptureFixture[str]
) -> None:
    write_blocks(tmp_path / 'bag', 60, WriterOptions(split_size=300_000))
    files = sorted((tmp_path / 'bag').glob('*.mcap'))
    assert len(files) == 3 - (len(files) == 2)
    place = min(place, len(files) - 1)
    held = recording_info(files[place]).count
    files[place].write_bytes(bytes(length))
    bag = tmp_path / 'bag'
    info = recording_info(bag)
    assert info.count == 120 - held
    assert any(files[place].name in problem for problem in info.problems)
    assert any(files[place].name in problem for problem in examine(bag)[1].problems)
    problems: list[str] = []
    assert len(list(read_messages(bag, problems=problems))) == 120 - held
    assert len(problems) == 1
    assert files[place].name in problems[0]
    report = recover(bag, tmp_path / 'saved')
    assert (report.kept, report.lost_bytes) == (120 - held, length)
    assert any(files[place].name in loss for loss in report.losses)
    assert Player(bag).info.problems
    signal = read_signal(bag)
    assert files[place].name in signal.source
    assert main(['info', str(bag)]) == 1
    assert main(['report', str(bag), '-o', str(tmp_path / 'page.html')]) == 0
    assert files[place].name in (tmp_path / 'page.html').read_text()
    rrd = tmp_path / 'picture.rrd'
    assert main(['view', str(bag), '--save', str(rrd)]) == 0
    assert files[place].name in capsys.readouterr().err


def test_a_bag_without_a_sound_file_says_so(tmp_path: Path) -> None:
    (tmp_path / 'bag').mkdir()
    for name in 'ab':
        (tmp_path / 'bag' / f'{name}.mcap').write_bytes(bytes(100))
    for command in ('info', 'verify', 'report', 'recover'):
        assert main([command, str(tmp_path / 'bag')]) == 1
    assert not (tmp_path / 'bag_recovered').exists()


def test_a_tail_of_zeros_is_searched_in_no_time(tmp_path: Path) -> None:
    path = tmp_path / 'run.mcap'
    write_blocks(path, 20)
    end = chunks(path)[-1][1]
    with path.open('r+b') as file:
        file.truncate(end)
        file.truncate(end + 100_000_000)
    began = time.process_time()
    assert path.read_bytes().count(0) >= 100_000_000
    once = time.process_time() - began
    began = time.process_time()
    report = recover(path, tmp_path / 'saved.mcap')
    # Up to 1.1 times a count of the zeros.
    assert time.process_time() - began < 10.0 * once
    assert (report.kept, report.lost_bytes) == (40, 100_000_000)


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


def test_the_folder_in_which_one_stands_is_recovered(tmp_path: Path, monkeypatch) -> None:
    write_blocks(tmp_path / 'run', 4)
    monkeypatch.chdir(tmp_path / 'run')
    assert main(['recover', '.']) == 0
    assert (
        recording_info(tmp_path / 'run_recovered').count == recording_info(tmp_path / 'run').count
    )


def test_own_unfinished_files_are_found_and_live_ones_are_not(tmp_path: Path) -> None:
    write_blocks(tmp_path / 'sound', 10)
    shutil.copytree(tmp_path / 'sound', tmp_path / 'torn')
    file = tmp_path / 'torn' / 'sound_0.mcap'
    file.write_bytes(file.read_bytes()[:-100])
    (tmp_path / 'foreign.mcap').write_bytes(b'\x89MCAP0\r\n')
    (tmp_path / 'text.mcap').write_text('no MCAP')
    with (tmp_path / 'zeros.mcap').open('wb') as zeros:
        # It would take half a minute to read, and the recorder is starting.
        zeros.truncate(8_000_000_000)
    began = time.monotonic()
    assert find_unfinished(tmp_path) == [tmp_path / 'torn']
    assert time.monotonic() - began < 2.0
    with RecordingWriter(tmp_path / 'live') as writer:
        writer.write('/t', TEMPERATURE, temperature_cdr(START, 20.0), log_time=1)
        writer.flush()
        assert find_unfinished(tmp_path) == [tmp_path / 'torn']
        with pytest.raises(BearingTwinError, match='still being written'):
            recover(tmp_path / 'live', tmp_path / 'saved')
    with file.open('rb') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert find_unfinished(tmp_path) == []


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


@pytest.mark.parametrize(
    'kinds',
    [
        {0x80: b''},
        {0x0F: bytes(4)},
        {0x80: b'', 0x81: b''},
        {0x0F: bytes(4), 0x80: b'', 0x07: bytes(6)},
        {0x0C: bytes(8), 0x80: b''},
        {0x06: bytes(40), 0x09: bytes(36), 0x03: b'\x09' + bytes(13)},
    ],
)
def test_hundreds_of_thousands_of_empty_records_are_stepped_over_and_what_follows_is_read(
    tmp_path: Path, kinds: dict[int, bytes]
) -> None:
    sound = tmp_path / 'sound.mcap'
    written = write_blocks(sound, 20)
    whole = sound.read_bytes()
    # Behind the header: records with nothing in them, of kinds that nobody reads, in turn.
    begin = 8 + 9 + int.from_bytes(whole[9:17], 'little')
    empty = b''.join(
        bytes([kind]) + len(body).to_bytes(8, 'little') + body for kind, body in kinds.items()
    )
    empty *= 5_000_000 // len(empty)
    path = tmp_path / 'many.mcap'
    path.write_bytes(whole[:begin] + empty + whole[begin:])
    began = time.process_time()
    problems: list[str] = []
    found = read_messages(path, topics=['/vibration'], recover=True, problems=problems)
    assert [message.cdr for message in found] == written
    took = time.process_time() - began
    # Up to 4 times, on any machine.
    assert took < 10.0 * seconds_of_heads(empty)
    assert len(problems) < 5


@pytest.mark.parametrize('body', [b'', bytes(4), bytes(5000)])
def test_messages_without_chunks_are_read_alike_whatever_their_length(
    tmp_path: Path, body: bytes
) -> None:
    path, expected = tmp_path / 'plain.mcap', []
    with raw_recording(path, use_chunking=False) as writer:
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        channels = [writer.register_channel(f'/x{k}', 'cdr', schema) for k in range(3)]
        for k in range(3000):
            data = body[: len(body) - k % 3]
            writer.add_message(channels[k % 3], k, data, k)
            expected.append((f'/x{k % 3}', k, data))
            if k % 1000 == 500:
                # A run ends at whatever is no message.
                writer.add_metadata(f'm{k}', {})
    for recover_it in (False, True):
        found = read_messages(path, recover=recover_it)
        assert [(m.topic, m.log_time, m.cdr) for m in found] == expected
    # A message that claims to be longer than the rest of the file costs itself.
    whole = path.read_bytes()
    assert whole.count(b'\x05') > 3000
    torn = tmp_path / 'torn.mcap'
    torn.write_bytes(whole[: len(whole) // 2])
    kept = [(m.topic, m.log_time, m.cdr) for m in read_messages(torn, recover=True)]
    assert kept == expected[: len(kept)]
    assert len(kept) > 1400


def test_messages_of_another_encoding_cost_only_themselves(tmp_path: Path) -> None:
    path = tmp_path / 'a.mcap'
    with raw_recording(path) as writer:
        schema = writer.register_schema('std_msgs/msg/Float64', 'ros2msg', b'float64 data')
        ours = writer.register_channel('/t', 'cdr', schema)
        other = writer.register_channel('/status', 'json', 0)
        for k in range(5):
            writer.add_message(ours, k, b'\0\1\0\0' + bytes(8), k)
            writer.add_message(other, k, b'{}', k)
    report = recover(path, tmp_path / 'saved')
    assert report.topics == {'/t': 5}
    assert report.lost_messages == 5
    assert report.losses == ["a.mcap: /status: 5 messages are encoded as 'json', not as cdr"]


def write_topics(path: Path, count: int) -> None:
    """Write one message on each of ``count`` topics; the numbers of channels begin anew."""
    with path.open('wb') as file:
        writer = Writer(file)
        writer.start(profile='ros2')
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        for index in range(count):
            identity = index % MOST_CHANNELS
            channel = Channel(identity, f'/t{index}', 'cdr', {}, schema)
            writer._Writer__chunk_builder.add_channel(channel)
            writer.add_message(identity, index, b'\0\1\0\0', index)
        writer.flush()


@pytest.mark.parametrize('most', [500, *in_proofs(MOST_CHANNELS)])
def test_a_bag_of_more_topics_than_a_file_can_number_goes_on_in_a_further_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    monkeypatch.setattr(outfile, 'MOST_CHANNELS', most)
    path = tmp_path / 'torn.mcap'
    write_topics(path, most + 10)
    report = recover(path, tmp_path / 'bag')
    assert (report.kept, report.lost_messages) == (most + 10, 0)
    assert [recording_info(tmp_path / 'bag' / f'bag_{n}.mcap').count for n in range(2)] == [
        most, 10,
    ]  # fmt: skip
    # The list of topics would take more than a record may, and a reader minutes.
    assert (tmp_path / 'bag' / 'metadata.yaml').stat().st_size < 4 * 1024**2
    assert recording_info(tmp_path / 'bag').problems == []


def test_a_single_file_says_what_it_cannot_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'torn.mcap'
    write_topics(path, 7)
    monkeypatch.setattr(outfile, 'MOST_CHANNELS', 5)
    report = recover(path, tmp_path / 'saved.mcap')
    assert report.kept == 5
    assert [text for text in report.losses if 'no number is left' in text][1:] == [
        f'torn.mcap: /t6: {tmp_path / "saved.mcap"} has as many topics as MCAP can number: no '
        "number is left for '/t6'; give a folder name, which goes on in a further file"
    ]
    assert recording_info(tmp_path / 'saved.mcap').count == 5


def test_a_topic_of_several_types_has_one_channel_each(tmp_path: Path) -> None:
    """Each change of type took a new one; of two texts of one type, the first stood for both."""
    texts = {'a/msg/A': ('float32 x', 'float64 x'), 'a/msg/B': ('string y',)}
    schemas = [MessageSchema(name, text, '') for name in texts for text in texts[name]]
    with RecordingWriter(tmp_path / 'run') as writer:
        for index in range(30):
            schema = schemas[index % 3]
            writer.write(
                '/t', schema.type_name, bytes(8), log_time=index, publish_time=0, schema=schema
            )
    found = [message.channel for message in read_messages(tmp_path / 'run')]
    assert [channel.message_schema for channel in found] == schemas * 10
    with (tmp_path / 'run' / 'run_0.mcap').open('rb') as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert len(summary.channels) == 3


def test_channels_described_again_and_again_are_read_as_often_as_there_are_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'torn.mcap'
    write_topics(path, 50)
    monkeypatch.setattr(catalogue, 'MOST_DESCRIBED', 20)
    assert any('more than 20 schemas' in text for text in examine(path)[1].damage)
    # One schema, and a channel for each message.
    report = recover(path, tmp_path / 'saved.mcap')
    assert report.kept == 19
    assert report.lost_bytes > 0
