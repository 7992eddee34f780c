# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Cost of viewing: everything that one bearing publishes, drawn to a file and to a server."""

from __future__ import annotations

from pathlib import Path
import tempfile
import time
from typing import TYPE_CHECKING

from bearing_twin.offline.run import run_offline
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.viewer import LOOPBACK

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage


RUNS = 2
AT_ONCE = 500
"""Messages drawn between two waits for the server: far fewer marks than its queue holds."""


def measure() -> dict[str, float]:
    """
    Draw a recording of twin and diagnosis at 25.6 kHz as the recorder does.

    Each load is the lower of two runs, after a first one that loads everything.

    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = folder / 'schedule.mcap'
        write_temperature_recording(source, *paper_schedule(), source='bench')
        report = run_offline(source, folder / 'run', twin={'defect': 'inner'})
        messages = list(read_messages(folder / 'run'))
        files = [_draw(messages, folder / f'{run}.rrd') for run in range(RUNS + 1)]
        served = [_draw(messages, None) for _ in range(RUNS + 1)]
        size = (folder / '0.rrd').stat().st_size
    return {
        'view_load': min(load for load, _ in served[1:]) / report.duration,
        'view_file_load': min(load for load, _ in files[1:]) / report.duration,
        'view_bytes_per_second': size / report.duration,
        'view_longest_ms': 1e3 * min(longest for _, longest in served[1:]),
    }


def _draw(messages: list[RecordedMessage], rrd: Path | None) -> tuple[float, float]:
    """Return processor time and longest call, s; without ``rrd`` it draws for live viewers."""
    longest = 0.0
    began = time.process_time()
    serve = None if rrd else (LOOPBACK, 0)
    with RerunLogger(recording_id='bench', rrd=rrd, serve=serve) as logger:
        for count, message in enumerate(messages):
            if count % AT_ONCE == 0:
                logger.drain(60.0)
            before = time.perf_counter()
            logger.log(message.topic, message.type_name, message.decode(), message.log_time)
            longest = max(longest, time.perf_counter() - before)
    return time.process_time() - began, longest
