# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Small files that unpack to very much: refused before memory is spent on them."""

from __future__ import annotations

from collections.abc import Callable
import itertools
from pathlib import Path
import struct
import time
import tracemalloc
from typing import Any
import zipfile
import zlib

from bearing_twin.cli import main
from bearing_twin.recording.health import examine
from bearing_twin.recording.mcap import chunks
from bearing_twin.recording.mcap.mcapfile import MAGIC, record_at
from bearing_twin.recording.mcap.summary import summary_place
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from commands import python
from copies import raw_recording
from mcap.opcode import Opcode
from mcap.writer import CompressionType, IndexType, Writer
import pytest
from recording_samples import (
    NANO,
    QOS,
    seconds_of_heads,
    START,
    TEMPERATURE,
    temperature_cdr,
    write_blocks,
)
from test_signal_files import npy
import zstandard

MIB = 2**20
ROOM = 512 * MIB
"""Address space that a reader gets beyond what it has when it begins, bytes."""

READER = """
import resource, sys
from pathlib import Path
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.recording.health import examine
from bearing_twin.recording.reader import read_messages
import scipy.io.wavfile
used = int(Path('/proc/self/statm').read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + int(sys.argv[2]), used + int(sys.argv[2])))
path = Path(sys.argv[1])
def messages():
    for message in read_messages(path):
        message.decode()
attempts = [lambda: read_signal(path, sample_rate=1000.0)]
if path.suffix == '.mcap':
    attempts += [lambda: examine(path)[1], messages]
for attempt in attempts:
    try:
        attempt()
    except BearingTwinError as error:
        print(error)
"""


def read(path: Path, room: int = ROOM) -> str:
    """Read a file in a process that has little memory; return the errors."""
    ran = python('-c', READER, path, room, cwd=Path(__file__).parents[2])
    assert ran.returncode == 0, ran.stderr[-2000:]
    return ran.stdout


def one_large(path: Path) -> None:
    """4 MB of zeros, 4 GB unpacked."""
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        archive.writestr('x.npy', npy('(500000000,)'))
    # Its directory says that the rest is there too.
    content = path.read_bytes()
    at = content.index(b'PK\x01\x02') + 24
    path.write_bytes(content[:at] + struct.pack('<I', 4_000_000_128) + content[at + 4 :])


def chunk(path: Path, compression: CompressionType) -> None:
    """Return a chunk of 400 MiB of zeros in some kB."""
    with raw_recording(path, compression=compression, chunk_size=2**31) as writer:
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channel = writer.register_channel('/t', 'cdr', schema)
        writer.add_message(channel, 5, bytes(400 * MIB), 5)


def modest(path: Path) -> None:
    """Return a chunk that states 1000 bytes, around a frame that states 400 MiB."""
    head = struct.pack('<QQQII', 0, 0, 1000, 0, 4)
    data = zstandard.compress(bytes(400 * MIB))
    content = head + b'zstd' + struct.pack('<Q', len(data)) + data
    records = ((Opcode.HEADER, bytes(8)), (Opcode.CHUNK, content), (Opcode.FOOTER, bytes(20)))
    path.write_bytes(MAGIC + b''.join(itertools.starmap(record, records)) + MAGIC)


def many_messages(path: Path) -> None:
    """400 000 messages of no content in one chunk of some kB."""
    with raw_recording(path, chunk_size=2**30, index_types=IndexType.CHUNK) as writer:
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        channel = writer.register_channel('/x', 'cdr', schema)
        for _ in range(400_000):
            writer.add_message(channel, 0, b'', 0)


def many_entries(path: Path) -> None:
    """Name one chunk in 20 000 entries of the index."""
    with raw_recording(path) as writer:
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        channel = writer.register_channel('/x', 'cdr', schema)
        for _ in range(10_000):
            writer.add_message(channel, 0, bytes(100), 0)
        writer.flush()
        writer._Writer__chunk_indices *= 20_000


def test_slow_topics_may_have_a_chunk_for_each_message(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the recorder writes them: one temperature a second."""
    path = tmp_path / 'slow.mcap'
    with RecordingWriter(path, WriterOptions(sync_period=0.0)) as writer:
        for second in range(400):
            at = START + second * NANO
            writer.write('/t', TEMPERATURE, temperature_cdr(at, 40.0), log_time=at, qos=QOS)
            writer.flush()
    # Only what the size of the file allows: nothing that any small file may cost.
    monkeypatch.setattr(chunks, 'MOST_WORK', 0)
    assert len(list(read_messages(path))) == 400
    assert examine(path)[1].damage == []


def test_messages_are_counted_and_not_only_their_bytes(tmp_path: Path) -> None:
    many_messages(tmp_path / 'many.mcap')
    assert (tmp_path / 'many.mcap').stat().st_size < 200_000
    read(tmp_path / 'many.mcap', 128 * MIB)


def test_a_chunk_is_named_once(tmp_path: Path) -> None:
    many_entries(tmp_path / 'index.mcap')
    assert 'does not fit between the others' in read(tmp_path / 'index.mcap')


def test_a_file_without_end_is_read_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'torn.mcap'
    with path.open('wb') as file:
        writer = Writer(file, use_chunking=False)
        writer.start(profile='ros2')
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        channels = [writer.register_channel(name, 'cdr', schema) for name in ('/x', '/y')]
        for index in range(60_000):
            writer.add_message(channels[index % 3 == 0], 1000 + index, bytes(4), 0)

    def read_so_far() -> int:
        return int(Path('/proc/self/io').read_text().split()[1])

    before = read_so_far()
    assert main(['info', str(path)]) == 1
    assert read_so_far() - before < 1.3 * path.stat().st_size
    said = capsys.readouterr().out
    said = [line.split() for line in said.splitlines()]
    assert ['messages', '60000'] in said
    for count, topic in (('40000', '/x'), ('20000', '/y')):
        assert [count, '0.000', 's', topic, 'std_msgs/msg/Empty'] in said


COMMANDS: dict[str, Callable[[str, str], list[str]]] = {
    'info': lambda path, _: ['info', path],
    'verify': lambda path, _: ['verify', path],
    'recover': lambda path, out: ['recover', path, '-o', f'{out}/saved.mcap'],
    'report': lambda path, out: ['report', path, '-o', f'{out}/page.html'],
    'view': lambda path, out: ['view', path, '--save', f'{out}/picture.rrd'],
    'diagnose': lambda path, _: ['diagnose', path],
    'fit': lambda path, _: ['fit', path],
    'replay': lambda path, out: ['replay', path, '--offline', '-o', f'{out}/made'],
}


def zeros(path: Path, lost: str) -> None:
    """Return 20 messages of 1 MiB of zeros, each in its chunk; something of the file is lost."""
    with raw_recording(path, chunk_size=MIB) as writer:
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channel = writer.register_channel('/t', 'cdr', schema)
        if lost == 'description':
            # It is looked for in the whole file.
            writer.add_message(7, START, bytes(8), START)
        for index in range(20):
            writer.add_message(channel, START + index, b'\0\1\0\0' + bytes(MIB), START)
    if lost:
        path.write_bytes(path.read_bytes()[:-40])


@pytest.fixture
def unpacked(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the chunks that are unpacked."""
    sizes: list[int] = []
    unpack = chunks._unpack

    def counted(*args: Any) -> bytes:
        sizes.append(len(data := unpack(*args)))
        return data

    monkeypatch.setattr(chunks, '_unpack', counted)
    return sizes


@pytest.mark.parametrize('lost', ['', 'end'])
@pytest.mark.parametrize('command', COMMANDS)
def test_each_command_unpacks_once_what_is_no_bearings(
    tmp_path: Path, unpacked: list[int], command: str, lost: str
) -> None:
    zeros(tmp_path / 'a.mcap', lost)
    main(COMMANDS[command](str(tmp_path / 'a.mcap'), str(tmp_path)))
    assert sum(unpacked) <= 21 * MIB


def test_looking_for_a_description_counts(
    tmp_path: Path, unpacked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    zeros(tmp_path / 'a.mcap', 'description')
    for name, value in (('MOST_UNPACKED', 30 * MIB), ('UNPACKED_PER_BYTE', 0)):
        monkeypatch.setattr(chunks, name, value)
    health = examine(tmp_path / 'a.mcap')[1]
    assert sum(unpacked) <= 30 * MIB
    assert any('unpack to too much' in text for text in health.damage)


def test_a_large_message_is_in_memory_twice_at_most(tmp_path: Path) -> None:
    """Unpacked, and as itself; three times, a file of 100 MB took 644 MB."""
    with raw_recording(tmp_path / 'a.mcap', chunk_size=MIB) as writer:
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channel = writer.register_channel('/t', 'cdr', schema)
        for index in range(4):
            writer.add_message(channel, START + index, bytes(16 * MIB), START)
    tracemalloc.start()
    try:
        examine(tmp_path / 'a.mcap')
        assert tracemalloc.get_traced_memory()[1] < 2.3 * 16 * MIB
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ('name', 'make', 'text'),
    [
        ('a.npz', one_large, 'would need 4000000000 bytes'),
        ('z.mcap', lambda p: chunk(p, CompressionType.ZSTD), 'limit 134217728'),
        ('l.mcap', lambda p: chunk(p, CompressionType.LZ4), 'limit 134217728'),
        ('m.mcap', modest, 'it states more than 1000 bytes'),
        ('a.csv', lambda p: p.write_text(','.join(['1'] * 1_000_000)), 'no line of numbers'),
        (
            'a.wav',
            lambda p: p.write_bytes(
                b'RIFF\xff\xff\xff\xffWAVEfmt '
                + struct.pack('<IHHIIHH', 16, 1, 65535, 8000, 16000, 2, 16)
                + b'data\xfe\xff\xff\x7f'
                + bytes(100)
            ),
            'cannot be read as .wav',
        ),
    ],
)
def test_refused(tmp_path: Path, name: str, make: Callable[[Path], None], text: str) -> None:
    path = tmp_path / name
    make(path)
    assert text in read(path)


def record(opcode: int, content: bytes) -> bytes:
    return bytes([opcode]) + len(content).to_bytes(8, 'little') + content


def packed(records: bytes) -> bytes:
    """Return a chunk of these records."""
    data = zstandard.compress(records)
    head = struct.pack('<QQQII', 0, 0, len(records), zlib.crc32(records), 4)
    return record(Opcode.CHUNK, head + b'zstd' + struct.pack('<Q', len(data)) + data)


def schema(number: int) -> bytes:
    """Return the record of a schema 1 with a name of its own."""
    name = str(number).encode()
    return record(Opcode.SCHEMA, struct.pack('<HI', 1, len(name)) + name + bytes(8))


@pytest.mark.parametrize(
    ('junk', 'reason'),
    [
        (lambda: [packed(record(0x80, b'') * 200_000)], 'besides messages'),
        (lambda: [packed(schema(1) * 200_000)], 'besides messages'),
        (lambda: [packed((schema(1) + schema(2)) * 10_000)], 'besides messages'),
        (lambda: [packed(b''.join(map(schema, range(10_000))))], 'besides messages'),
        (lambda: [packed(record(0x80, str(k).encode())) for k in range(3_000)], 'besides'),
        (lambda: [packed(record(Opcode.MESSAGE, bytes(22)) * 200_000)], 'more messages'),
        (lambda: [packed(record(0x80, bytes(40 * MIB)))] * 3, 'unpack to too much'),
    ],
)
def test_chunks_of_a_small_file_cost_what_its_size_allows(
    tmp_path: Path, junk: Callable[[], list[bytes]], reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'a.mcap'
    written = write_blocks(path, 5)
    content = path.read_bytes()
    # In place of its end: the summary and the footer.
    end = content.rindex(record(Opcode.DATA_END, b'')[:1] + (4).to_bytes(8, 'little'))
    path.write_bytes(content[:end] + b''.join(junk()))
    # A tenth of what is allowed, so that the test is quick.
    for name in ('MOST_WORK', 'MOST_MESSAGES', 'MOST_UNPACKED'):
        value = getattr(chunks, name)
        monkeypatch.setattr(chunks, name, value // (100 if name == 'MOST_UNPACKED' else 10))
    found = list(read_messages(path, topics=['/vibration'], recover=True))
    assert [message.cdr for message in found][: len(written)] == written
    health = examine(path)[1]
    assert len(health.damage) < 4
    assert any('nothing is read from' in text and reason in text for text in health.damage)


def test_what_takes_new_memory_counts_more(tmp_path: Path) -> None:
    """Chunks of 17 MiB took three times as long for each byte as chunks of 16 MiB."""
    told = {}
    for size in (16, 17):
        path = tmp_path / f'{size}.mcap'
        path.write_bytes(packed(record(Opcode.MESSAGE, bytes(size * MIB - 9))))
        with path.open('rb') as file:
            one = chunks.Chunks(file, path.stat().st_size)
            before = one._unpacked
            one.unpack(record_at(file, 0, path.stat().st_size))
            told[size] = (before - one._unpacked) / (size * MIB)
    assert told == {16: 1.0, 17: 4.0}


def test_many_arrays_that_are_large_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from bearing_twin.errors import BearingTwinError
    from bearing_twin.recording.signals import npz

    path = tmp_path / 'a.npz'
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED) as archive:
        for number in range(10):
            archive.writestr(f'x{number}.npy', npy('(1000,)', bytes(8000)))
    assert len(npz.read_npz(path)) == 10
    monkeypatch.setattr('bearing_twin.recording.signals.npz.MOST_UNPACKED', 75_000)
    with pytest.raises(BearingTwinError, match=r'x9 would need 8000 bytes; .* 3000 are left'):
        npz.read_npz(path)


def entry(fields: bytes, name: bytes) -> bytes:
    return fields + struct.pack('<I', len(name)) + name


SUMMARIES: dict[str, Callable[[int], bytes]] = {
    'too many records': lambda _: record(0x80, b''),
    'one record named again': lambda _: record(Opcode.METADATA_INDEX, entry(bytes(16), b'a')),
    'attachments': lambda index: record(
        Opcode.ATTACHMENT_INDEX, entry(bytes(40), str(index).encode()) + bytes(4)
    ),
    'statistics': lambda _: record(Opcode.STATISTICS, bytes(46)),
}


@pytest.mark.parametrize('kind', SUMMARIES)
def test_a_summary_of_small_records_costs_what_its_size_allows(tmp_path: Path, kind: str) -> None:
    path, sound = tmp_path / 'a.mcap', tmp_path / 'sound.mcap'
    written = write_blocks(sound, 5)
    content = sound.read_bytes()
    # The statistics stay the last ones.
    start, _ = summary_place(sound.open('rb'), len(content))
    one, size = SUMMARIES[kind], 5_000_000
    junk = b''.join(map(one, range(size // len(one(0)))))
    path.write_bytes(
        content[:start] + junk + content[start:-28] + struct.pack('<QQI', start, 0, 0) + MAGIC
    )
    # What a process does once is done.
    examine(sound)
    began = time.process_time()
    info, health = examine(path)
    took = time.process_time() - began
    # Up to 7 times, on any machine.
    assert took < 15.0 * seconds_of_heads(junk)
    assert info.count == 2 * len(written) == sum(t.count for t in health.topics.values())
    assert any(kind in text for text in info.problems) == (kind == 'too many records')
