# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""When messages of a replayed recording are due."""

from __future__ import annotations

from itertools import islice
import math
from pathlib import Path

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.player import Player
from bearing_twin.recording.writer import RecordingWriter
import pytest
from recording_samples import NANO, START, TEMPERATURE, temperature_cdr


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Topic /a each second 0..9 s, topic /b at 0.5 s."""
    path = tmp_path / 'run.mcap'
    with RecordingWriter(path) as writer:
        for k in range(20):
            time = START + k * NANO // 2
            if k % 2 == 0 or k == 1:
                topic, cdr = '/b' if k == 1 else '/a', temperature_cdr(time, float(k))
                writer.write(topic, TEMPERATURE, cdr, log_time=time)
    return path


def values(player: Player, now: float) -> list[float]:
    return [m.decode().temperature / 2 for m in player.due(now)]


def test_pace(recording: Path) -> None:
    player = Player(recording, rate=2.0)
    assert values(player, 100.0) == [0.0]
    assert player.wait(100.0) == pytest.approx(0.25)
    assert values(player, 100.2) == []
    assert values(player, 100.25) == [0.5]
    assert values(player, 101.6) == [1.0, 2.0, 3.0]
    player.rate = 0.5
    # At 103.2 - 0.5 * x the recorded time is 3.2 + 0.5 * 1.6 = 4.0.
    assert values(player, 103.19) == []
    assert values(player, 103.21) == [4.0]
    assert values(player, 200.0) == [5.0, 6.0, 7.0, 8.0, 9.0]
    assert player.finished
    assert player.fraction == 1.0
    assert player.wait(200.0) == math.inf


def test_section_and_topics(recording: Path) -> None:
    player = Player(recording, start_offset=2.5, duration=3.0, topics=['/a'])
    assert values(player, 0.0) == []
    assert values(player, 1e6) == [3.0, 4.0, 5.0]
    player = Player(recording, topics=['/b'])
    assert set(player.topics()) == {'/b'}
    assert values(player, 0.0) == []
    assert values(player, 1e6) == [0.5]


def test_loop(recording: Path) -> None:
    player = Player(recording, duration=2.0, topics=['/a'], loop=True)
    found = []
    for tick in range(80):
        found += values(player, tick * 0.1)
    assert found[:6] == [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]
    assert player.loops >= 2
    assert not player.finished


def test_pause_step_resume(recording: Path) -> None:
    player = Player(recording, paused=True)
    assert values(player, 0.0) == []
    assert player.wait(50.0) == math.inf
    step = player.step()
    assert step is not None and step.decode().temperature == 0.0
    step = player.step()
    assert step is not None and step.topic == '/b'
    assert values(player, 60.0) == []
    player.paused = False
    assert values(player, 60.5) == [1.0]
    player.resync(1000.0)
    assert values(player, 1000.9) == []
    assert values(player, 1001.1) == [2.0]


@pytest.mark.parametrize(
    ('section', 'text'),
    [
        ({'start_offset': 100.0}, 'is not inside the recording'),
        ({'topics': ['/no']}, 'has no topic /no; it has /a, /b'),
        ({'topics': ['/b'], 'start_offset': 5.0}, 'no messages of these topics'),
    ],
)
def test_refusals(recording: Path, section: dict[str, object], text: str) -> None:
    with pytest.raises(BearingTwinError, match=text):
        Player(recording, **section)


def test_a_recording_of_one_instant_loops_without_holding_the_caller(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        writer.write('/a', TEMPERATURE, temperature_cdr(0, 1.0), log_time=5)
    player = Player(tmp_path / 'run.mcap', loop=True)
    assert len(list(player.due(0.0))) == 1
    assert len(list(player.due(1.0))) == 1


def test_a_caller_may_stop_at_the_last_message_of_a_round(recording: Path) -> None:
    player = Player(recording, loop=True)
    player.resync(0.0)
    count = player.info.count
    assert len(list(islice(player.due(1e6), count))) == count
    assert not player.finished


def test_the_position_is_no_later_than_what_is_still_to_come(recording: Path) -> None:
    player = Player(recording)
    player.resync(100.0)
    given = [message.log_time for message in islice(player.due(150.0), 3)]
    assert len(given) == 3
    # The fourth is at 2 s, the last at 9 s.
    assert player.position == START + 2 * NANO
    assert player.fraction == pytest.approx(2.0 / 9.0)
