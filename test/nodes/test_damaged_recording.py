# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The replay node on a recording that cannot be read to its end."""

import random

from bearing_twin.recording.schedule import write_temperature_recording
from mcap.reader import make_reader
import numpy as np
import pytest


@pytest.mark.ros
def test_a_damaged_recording_ends_the_replay_with_an_error(nodes, tmp_path):
    recording = tmp_path / 'damaged.mcap'
    times = np.linspace(0.0, 2.0, 40_000)
    write_temperature_recording(recording, times, 20.0 + times, source='test')
    with recording.open('rb') as file:
        chunks = make_reader(file).get_summary().chunk_indexes
    chunk = chunks[len(chunks) // 2]
    middle = chunk.chunk_start_offset + chunk.chunk_length // 2
    data = bytearray(recording.read_bytes())
    data[middle : middle + 3000] = random.Random(1).randbytes(3000)
    recording.write_bytes(data)

    nodes.start('replay', {'recording': str(recording), 'wait_for_subscribers': 0.0})
    assert nodes.wait('replay', 120.0) == 1
    log = (tmp_path / 'logs' / 'replay.log').read_text()
    assert 'replaying' in log
    assert 'Traceback' not in log
    assert str(recording) in log.splitlines()[-1]
