# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The replay node on a recording that cannot be read to its end."""

import random

from bearing_twin.recording.temperature import write_temperature_recording
from copies import raw_recording
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

    nodes.start('replay', {'recording': str(recording), 'subscriber_timeout': 0.0})
    assert nodes.wait('replay', 120.0) == 1
    log = (tmp_path / 'logs' / 'replay.log').read_text()
    assert 'replaying' in log
    assert 'Traceback' not in log
    assert str(recording) in log.splitlines()[-1]


@pytest.mark.ros
def test_a_clock_that_was_set_is_told_and_names_are_not_obeyed(nodes, probe, tmp_path):
    recording = tmp_path / 'set.mcap'
    with raw_recording(recording) as writer:
        schema = writer.register_schema('std_msgs/msg/Empty', 'ros2msg', b'')
        for name in '/x', '/\x1b[31m':
            channel = writer.register_channel(name, 'cdr', schema)
            for second in 0, 5_000_000:
                writer.add_message(channel, second * 10**9, bytes(4), 0)
    nodes.start('replay', {'recording': str(recording), 'subscriber_timeout': 0.0})
    said = (tmp_path / 'logs' / 'replay.log').read_text
    probe.until(lambda: 'the next is due in 5000000 s' in said(), 'the wait')
    assert '/\\x1b[31m is left out' in said()
    assert '\x1b[31m' not in said()
