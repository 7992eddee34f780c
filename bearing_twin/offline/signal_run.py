# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Convert a vibration file to a recording of its blocks and the verdicts on them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import floats, message_header
from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters.spec import read_values
from bearing_twin.bearing import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import output
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.temperature import START
from bearing_twin.recording.writer import whole_recording
from bearing_twin.stamps import samples_ns
from bearing_twin_msgs.msg import Vibration

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.recording.signals.signalfile import Signal


BLOCK = 1024


def record_signal(
    signal: Signal, target: Path, bearing: Bearing, shaft_hz: float, *, unit: str
) -> None:
    """
    Write a signal, and the messages of the diagnosis node on it, as a recording.

    ``shaft_hz`` (Hz; NaN: none) and ``unit`` ('': none) replace the speed and the unit of the
    signal.
    """
    length = len(signal.x) / signal.sample_rate
    run = DiagnosisRun(read_values(diagnosis_parameters.SPECS, _parameters(bearing, length)))
    qos = sensor_qos()
    with whole_recording(target) as writer:
        writer.metadata('bearing_twin.source', {'source': signal.source, 'mode': 'file'})
        for first in range(0, len(signal.x), BLOCK):
            samples = signal.x[first : first + BLOCK]
            speeds = signal.speeds[first : first + BLOCK]
            speed = float(speeds.mean()) if len(speeds) else signal.shaft_hz
            message = Vibration(
                header=message_header(START + samples_ns(first, signal.sample_rate), ''),
                sample_rate=signal.sample_rate,
                first_sample=first,
                source=Vibration.SOURCE_MEASURED,
                unit=unit or signal.unit,
                shaft_hz=shaft_hz if math.isfinite(shaft_hz) else speed,
                y=floats(samples),
            )
            now = START + samples_ns(first + len(samples), signal.sample_rate)
            made = run.push(message, temperature=signal.temperature)
            for each in (output('/vibration', message), *made):
                writer.write(each.topic, each.type_name, each.cdr, log_time=now, qos=qos)


def _parameters(bearing: Bearing, length: float) -> dict[str, Any]:
    """Return parameters of the diagnosis for a bearing and a signal of ``length`` s."""
    specs = {spec.name: spec for spec in diagnosis_parameters.SPECS}
    window, interval = specs['window'], specs['update_interval']
    values: dict[str, Any] = {
        'bearing': bearing.name,
        'window': max(min(window.default, length), window.low or 0.0),
        'update_interval': max(min(interval.default, 0.1 * length), interval.low or 0.0),
    }
    try:
        known = find_bearing(bearing.name) == bearing
    except BearingTwinError:
        known = False
    if not known:
        sizes = (1e3 * bearing.d_ball, 1e3 * bearing.d_pitch, math.degrees(bearing.contact_angle))
        values['bearing'] = ''
        values['geometry'] = ','.join([str(bearing.n_balls), *(f'{size:.9g}' for size in sizes)])
    return values
