# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Long operation, faster than real time: memory flat, no drift, no block lost."""

from __future__ import annotations

from pathlib import Path

from bearing_twin.offline.run import run_offline
from bearing_twin.recording.health import examine
from bearing_twin.recording.temperature import write_temperature_recording
from cases import in_proofs
from commands import resident
import numpy as np
import pytest
from soaking import AHEAD, BLOCK, NODES, RATE, soak, summary

MOST_GROWTH = 20_000_000
"""Memory that the second half of a run may take beyond the first, bytes."""


@pytest.mark.parametrize('seconds', [30.0, *in_proofs(120.0)])
def test_minutes_offline(seconds: float, tmp_path: Path) -> None:
    source, target = tmp_path / 'inputs.mcap', tmp_path / 'run'
    times = np.arange(0.0, seconds + 1.0, 1.0)
    swing = 60.0 - 40.0 * np.cos(2.0 * np.pi * times / seconds)
    write_temperature_recording(source, times, swing, source='soak')
    memory: list[int] = []
    report = run_offline(
        source, target, twin={'defect': 'outer'}, progress=lambda _: memory.append(resident())
    )
    assert report.blocks == int(seconds * RATE) // 1024
    health = examine(target)[1]
    assert health.problems == []
    assert health.topics['/vibration'].blocks == report.blocks
    # Stamps are rounded to 1 ns each.
    assert health.topics['/vibration'].worst_stamp_error <= 2e-9
    middle = len(memory) // 2
    assert max(memory[middle:]) - max(memory[:middle]) < MOST_GROWTH


def operate(seconds: float, folder: Path, domain: int, most_growth: float) -> None:
    report = soak(seconds, 60.0, folder, domain=domain, show=seconds > 3600.0)
    print(summary(report))
    assert report.operated >= seconds
    # The clock stops when it is over, with the twin some blocks behind.
    assert 0.0 <= report.operated - report.published * BLOCK / RATE < AHEAD['twin'] + 1.0
    assert report.recorded == report.published
    assert (report.dropped, report.samples_missed) == (0, 0)
    # The first reading of /clock is one.
    assert report.clock_steps <= 1
    assert report.problems == []
    # Stamps are whole nanoseconds.
    assert report.drift <= 1e-9
    # Against the clock they neither run ahead nor fall behind.
    assert all(0.0 <= lag <= AHEAD['twin'] for lag in report.lag), report.lag
    assert report.verdicts.keys() == {'BEARING_OUTER_RACE'}
    for node in NODES:
        assert report.growth(node) * 1e6 < most_growth, node


@pytest.mark.ros
def test_five_minutes_of_the_nodes(ros_domain: int, tmp_path: Path) -> None:
    operate(300.0, tmp_path, ros_domain, MOST_GROWTH / 2)


@pytest.mark.ros
@pytest.mark.soak
def test_a_day_of_the_nodes(ros_domain: int, tmp_path: Path) -> None:
    operate(86400.0, tmp_path, ros_domain, MOST_GROWTH)
