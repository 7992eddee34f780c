# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutated files: a clear error, never a traceback, a hang, a crash or memory without bound."""

from __future__ import annotations

import math
from pathlib import Path
import random
import time

from absurd import absurd, ROOM
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.health import examine
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.recording.writer import WriterOptions
from cases import in_proofs
from copies import raw_recording
from forked import run_command
from fuzzing import at_most, clean, fuzz, KINDS, LONGEST, mutate, SECONDS, seeds, until
from mcap.opcode import Opcode
import pytest
from recording_samples import write_blocks

MOST_MEMORY = 512 * 1024 * 1024
"""Memory that reading a damaged file of a few kB may take beyond that of a sound one, bytes."""


def check(kind: str, count: int, seed: int, folder: Path, seconds: float = math.inf) -> None:
    result = fuzz(kind, count, seed, folder, seconds)
    assert not result['failures'], '\n'.join(result['failures'])
    assert result['memory'] < MOST_MEMORY
    print(
        f'{kind}: {result["count"]} files of seed {seed}, longest {result["longest"]:.2f} s, '
        f'{result["memory"]} bytes more than sound ones'
    )
    # Nothing was written but the seeds, the file itself and what recover was told to write.
    allowed = {f'a.{kind}', 'out', 'zstd.mcap', 'lz4.mcap', 'none.mcap'}
    assert set(result['files']) <= allowed | {'openTrue.mcap', 'openFalse.mcap'}


@pytest.mark.parametrize('kind', KINDS)
def test_mutated_files(kind: str, tmp_path: Path) -> None:
    check(kind, 150, 1, tmp_path)


@pytest.mark.parametrize('part', ['(', '[g', ' ', '1,', '12:', '1.1.', 'fs=', '"'])
def test_a_long_line_before_a_table_is_looked_through_once(part: str, tmp_path: Path) -> None:
    path = tmp_path / 'a.csv'
    rows = '\n'.join(f'{k % 7};{k % 5}' for k in range(100))
    path.write_text(part * (900_000 // len(part)) + '\n' + rows)
    with at_most(LONGEST):
        assert read_signal(path, sample_rate=1000.0).x.size == 100


@pytest.mark.fuzz
@pytest.mark.parametrize('kind', KINDS)
def test_ten_thousand_mutated_files(kind: str, tmp_path: Path) -> None:
    check(kind, 10_000, random.SystemRandom().randrange(2**32), tmp_path, SECONDS)


@pytest.mark.parametrize('offset', [10_000_000, 2**63 - 1, 2**63, 2**64 - 1])
def test_an_index_that_points_behind_the_file_costs_only_itself(
    offset: int, tmp_path: Path
) -> None:
    content = bytearray(seeds('mcap', tmp_path)[-1])
    head = Opcode.METADATA_INDEX.to_bytes(1, 'little') + (21).to_bytes(8, 'little')
    at = content.index(head) + len(head)
    content[at : at + 8] = offset.to_bytes(8, 'little')
    path = tmp_path / 'a.mcap'
    path.write_bytes(content)
    info = recording_info(path)
    assert info.count == len(list(read_messages(path, problems=[]))) == 3
    assert info.problems == [f'a.mcap: byte {offset} is behind the end of the file']


@pytest.mark.parametrize('count', [3, *in_proofs(8)])
def test_absurd_recordings_end_no_command(count: int, tmp_path: Path) -> None:
    found = absurd(count, 1, tmp_path, math.inf)
    assert found['failures'] == []


@pytest.mark.fuzz
def test_absurd_recordings_at_length(tmp_path: Path) -> None:
    seed = random.SystemRandom().randrange(10**6)
    found = absurd(500, seed, tmp_path, SECONDS)
    assert found['failures'] == [], f'seed {seed}'
    print(
        f'{found["count"]} recordings of seed {seed}: longest {found["longest"]}, '
        f'memory +{found["memory"] / 1e6:.0f} MB'
    )
    assert found['memory'] < ROOM


def damage_bags(count: int, seed: int, folder: Path, seconds: float = math.inf) -> int:
    """
    Damage some files of a bag, in each of its copies; the others must be saved whole.

    Returns how many copies were made in the time.
    """
    write_blocks(folder / 'bag', 60, WriterOptions(split_size=120_000, compression='none'))
    sound = {path.name: path.read_bytes() for path in sorted((folder / 'bag').glob('*.mcap'))}
    held = {name: recording_info(folder / 'bag' / name).count for name in sound}
    bag, out = folder / 'damaged', folder / 'out'
    for case in until(time.monotonic() + seconds, count):
        rng = random.Random(seed * 1_000_003 + case)
        for path in (bag, out):
            path.mkdir(exist_ok=True)
            clean(path)
        bad = rng.sample(sorted(sound), rng.randrange(len(sound)))
        for name, content in sound.items():
            kinds = [
                b'', bytes(rng.randrange(100_000)), content[: rng.randrange(len(content))],
                content[: rng.randrange(len(content))] + bytes(rng.randrange(100_000)),
                mutate(content, rng), rng.randbytes(1000),
            ]  # fmt: skip
            (bag / name).write_bytes(rng.choice(kinds) if name in bad else content)
        untouched = sum(number for name, number in held.items() if name not in bad)
        assert recording_info(bag).count >= untouched, case
        assert bool(examine(bag)[1].topics), case
        report = recover(bag, out / 'saved')
        assert report.kept >= untouched, case
        assert len(list(read_messages(out / 'saved'))) == report.kept
        try:
            assert len(list(read_messages(bag, problems=[]))) >= untouched, case
        except BearingTwinError:
            assert len(bad) == len(sound), case
    return case + 1


def test_damaged_bags(tmp_path: Path) -> None:
    damage_bags(15, 1, tmp_path)


@pytest.mark.fuzz
def test_a_thousand_damaged_bags(tmp_path: Path) -> None:
    seed = random.SystemRandom().randrange(10**6)
    print(f'seed {seed}')
    print(f'{damage_bags(1000, seed, tmp_path, SECONDS)} bags')


def test_a_type_that_holds_itself_is_not_given_to_rerun(tmp_path: Path) -> None:
    path, picture = tmp_path / 'a.mcap', tmp_path / 'a.rrd'
    itself = ('a/msg/B', b'a/B b\n' + b'=' * 80 + b'\nMSG: a/B\na/B b\n')
    number = ('std_msgs/msg/Float64', b'float64 data')
    with raw_recording(path) as writer:
        for topic, (name, text) in (
            ('/itself', itself),
            ('/t', number),
            ('/twice', number),
            ('/twice', itself),
        ):
            schema = writer.register_schema(name, 'ros2msg', text)
            channel = writer.register_channel(topic, 'cdr', schema)
            for k in range(5):
                writer.add_message(channel, k, b'\0\1\0\0' + bytes(8), k)
    # In a process of its own: it ended in a stack overflow of Rerun's.
    ran = run_command('view', path, '--save', picture)
    assert ran.returncode == 0, ran.stderr
    for topic in ('/itself', '/twice'):
        assert f'{topic} is not drawn: the schema of a/msg/B cannot be read' in ran.stderr
    assert picture.stat().st_size > 0
