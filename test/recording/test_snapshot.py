# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recording on demand."""

from __future__ import annotations

from pathlib import Path

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.outfile import OVERHEAD
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.snapshot import SnapshotWriter
import pytest
from recording_samples import NANO, START, TEMPERATURE, temperature_cdr


def put(writer: SnapshotWriter, second: int) -> None:
    time = START + second * NANO
    cdr = temperature_cdr(time, float(second))
    writer.write('/t', TEMPERATURE, cdr, log_time=time)


def seconds(path: Path, *, recover: bool = False) -> list[int]:
    return [int(m.decode().temperature) for m in read_messages(path, recover=recover)]


def test_the_seconds_before_and_after_are_written(tmp_path: Path) -> None:
    writer = SnapshotWriter(tmp_path / 'run', before=5.0, after=3.0, memory=10**6)
    writer.attach('a.txt', b'abc', 'text/plain')
    for second in range(20):
        put(writer, second)
    assert not (tmp_path / 'run').exists()
    writer.trigger(START + 19 * NANO)
    # They are with the operating system at once: a crash from here on does not cost them.
    assert seconds(tmp_path / 'run', recover=True) == list(range(14, 20))
    for second in range(20, 50):
        put(writer, second)
    writer.trigger(START + 49 * NANO)
    for second in range(50, 60):
        put(writer, second)
    writer.close()
    first, second_file = (tmp_path / 'run' / f'run_{k}.mcap' for k in (0, 1))
    assert seconds(first) == list(range(14, 23))
    assert seconds(second_file) == list(range(44, 53))
    assert recording_info(second_file).attachments == {'a.txt': 3}
    assert writer.snapshots == 2


def test_a_trigger_during_a_snapshot_prolongs_it(tmp_path: Path) -> None:
    writer = SnapshotWriter(tmp_path / 'run', before=2.0, after=4.0, memory=10**6)
    for second in range(20):
        put(writer, second)
        if second in (10, 13):
            writer.trigger(START + second * NANO)
    writer.close()
    assert seconds(tmp_path / 'run') == list(range(8, 18))


def test_memory_is_bounded(tmp_path: Path) -> None:
    size = OVERHEAD + len(temperature_cdr(0, 0.0))
    writer = SnapshotWriter(tmp_path / 'run', before=1e6, after=0.0, memory=10 * size)
    for second in range(1000):
        put(writer, second)
    writer.trigger(START + 999 * NANO)
    writer.close()
    assert seconds(tmp_path / 'run') == list(range(990, 1000))


def test_nothing_happens_without_a_trigger(tmp_path: Path) -> None:
    writer = SnapshotWriter(tmp_path / 'run', before=1.0, after=1.0, memory=1000)
    put(writer, 1)
    writer.flush()
    writer.close()
    assert not (tmp_path / 'run').exists()
    (tmp_path / 'taken').mkdir()
    with pytest.raises(BearingTwinError, match='does not exist yet'):
        SnapshotWriter(tmp_path / 'taken', before=1.0, after=1.0, memory=1000)


def test_a_name_that_another_recorder_took_meanwhile_costs_no_snapshot(tmp_path: Path) -> None:
    writers = [
        SnapshotWriter(tmp_path / 'run', before=2.0, after=0.0, memory=10**6) for _ in range(2)
    ]
    for second, writer in enumerate(writers, start=10):
        put(writer, second)
        writer.trigger(START + second * NANO)
        writer.close()
    assert [writer.path.name for writer in writers] == ['run', 'run_2']
    assert [seconds(writer.path) for writer in writers] == [[10], [11]]
    assert sorted(path.name for path in writers[1].path.iterdir()) == [
        'metadata.yaml', 'run_2_0.mcap',
    ]  # fmt: skip
