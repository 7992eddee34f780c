# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Long operation at the pace of the machine: memory flat, no drift, no block lost."""

from __future__ import annotations

import os
from pathlib import Path
import time

from bearing_twin.nodes.offline_run import run_offline
from bearing_twin.recording.health import recording_health
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.schedule import write_temperature_recording
from bearing_twin.recording.writer import WriterOptions
import numpy as np
import pytest

RATE = 25600.0
GIB = 1024**3


def resident() -> int:
    """Memory of this process, bytes."""
    pages = Path('/proc/self/statm').read_text().split()[1]
    return int(pages) * os.sysconf('SC_PAGE_SIZE')


def soak(seconds: float, folder: Path) -> tuple[float, int]:
    """Operate for ``seconds``; return the pace and the growth of memory in the later half."""
    source, target = folder / 'day.mcap', folder / 'run'
    times = np.arange(0.0, seconds + 1.0, 1.0)
    # Up to 100 degC and back twice a day, faster in a short run.
    swing = 60.0 - 40.0 * np.cos(2.0 * np.pi * times / min(43200.0, seconds))
    write_temperature_recording(source, times, swing, source='soak')
    memory: list[int] = []
    began = time.perf_counter()
    report = run_offline(
        source,
        target,
        twin={'defect': 'outer'},
        options=WriterOptions(split_size=GIB // 8, storage_limit=GIB, delete_oldest=True),
        progress=lambda _: memory.append(resident()),
    )
    pace = seconds / (time.perf_counter() - began)
    assert report.blocks == int(seconds * RATE) // 1024
    health = recording_health(target)
    assert health.problems == []
    vibration = health.topics['/vibration']
    # A day makes some 40 GB, of which the last is kept.
    assert vibration.blocks == report.blocks or vibration.blocks > 20_000
    # Stamps are rounded to 1 ns each.
    assert vibration.worst_stamp_error <= 2e-9
    last = None
    for message in read_messages(target, topics=['/vibration']):
        last = message
    assert last is not None
    block = last.decode()
    assert block.first_sample == (report.blocks - 1) * 1024
    elapsed = block.header.stamp.sec + block.header.stamp.nanosec * 1e-9 - 1577836800.0
    assert abs(elapsed - block.first_sample / RATE) < 1e-6
    middle = len(memory) // 2
    return pace, max(memory[middle:]) - max(memory[:middle])


def test_two_minutes(tmp_path: Path) -> None:
    _, growth = soak(120.0, tmp_path)
    assert growth < 20_000_000


@pytest.mark.soak
def test_a_day(tmp_path: Path) -> None:
    pace, growth = soak(86400.0, tmp_path)
    print(f'24 h at {pace:.0f} times real time, memory grew by {growth / 1e6:.1f} MB')
    assert growth < 20_000_000
