# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdict and evidence on one file, as ``bearing-twin diagnose`` gives them."""

from __future__ import annotations

from dataclasses import asdict
import math
from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import diagnosis_message
from bearing_twin.bearing import named_bearing
from bearing_twin.cli.diagnose.task import CARD, DRAWN
from bearing_twin.cli.diagnose.text import card
from bearing_twin.cli.signal_arguments import unread
from bearing_twin.cli.terminal import plain
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.view.verdict import confidence, next_step

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.cli.diagnose.task import Task
    from bearing_twin.diagnosis import Diagnosis


DIGITS = 7
"""Significant digits of the numbers in an answer."""


def diagnose_file(task: Task) -> dict[str, Any]:
    """
    Return the answer for one file; nothing in the file raises an error.

    A file that cannot be read has no verdict: its answer is ``file`` and ``error``. The answer has
    an ``error``, too, if the picture of a verdict cannot be written.
    """
    try:
        signal = read_signal(Path(task.path), channel=task.channel, sample_rate=task.sample_rate)
        bearing = task.bearing or signal.bearing or named_bearing(signal.bearing_name)
        shaft_hz = signal.speeds if len(signal.speeds) else signal.shaft_hz
        settings = task.settings
        if math.isfinite(task.shaft_hz):
            shaft_hz = task.shaft_hz
        elif signal.speed_measured and task.speed_tolerance is None:
            # As the node takes it.
            settings = settings.measured
        diagnosis = diagnose_record(
            signal.x,
            signal.sample_rate,
            bearing,
            shaft_hz,
            speed_tolerance=task.speed_tolerance,
            unit=task.unit or signal.unit,
            temperature=signal.temperature,
            settings=settings,
        )
    except (BearingTwinError, MemoryError) as error:
        reason = str(error) or 'not enough memory'
        if task.channel and task.path not in reason:
            reason = f'{task.path}, {task.channel}: {reason}'
        return unread(task.path, reason)
    drawn = not task.plot or diagnosis.spectrum.values.size > 0
    failed: dict[str, Any] = {}
    if task.plot and drawn:
        from bearing_twin.cli.plots import draw_diagnosis

        title = f'{Path(task.path).name}, {bearing.name}'
        try:
            draw_diagnosis(diagnosis, Path(task.plot), title=title)
        except (BearingTwinError, MemoryError) as error:
            failed = unread(task.path, str(error) or 'not enough memory')
    length = len(signal.x) / signal.sample_rate
    message = diagnosis_message(diagnosis, stamp=0, frame_id='', bearing=bearing.name)
    return {
        'file': task.path,
        'channel': task.channel or '',
        'source': f'{signal.source}: {length:.4g} s at {signal.sample_rate:g} Hz',
        'bearing': _described(bearing),
        'result': diagnosis.result,
        'faults': list(diagnosis.faults),
        'level': diagnosis.level,
        'confidence': round(diagnosis.confidence, 4),
        'claim': confidence(message)[1],
        'shaft_hz': plain(diagnosis.shaft_hz, DIGITS),
        'slip': plain(diagnosis.slip, DIGITS),
        'evidence': evidence(diagnosis),
        'reasons': list(diagnosis.reasons),
        'next_step': next_step(message),
        CARD: card(message),
        DRAWN: drawn,
        **failed,
    }


def evidence(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the evidence of a verdict as plain numbers; unknown ones are None."""
    found: dict[str, Any] = plain(
        {
            'fault_code': diagnosis.fault_code,
            'shaft_hz_given': diagnosis.shaft_hz_given,
            'fault_hz': diagnosis.fault_hz,
            'fault_hz_expected': diagnosis.fault_hz_expected,
            'expected_hz': diagnosis.expected._asdict(),
            'found_hz': diagnosis.found_hz,
            'score': diagnosis.score,
            'modulation_index': diagnosis.modulation_index,
            'band_hz': diagnosis.band,
            'line_hz': diagnosis.line_hz.tolist(),
            'line_level': diagnosis.line_level.tolist(),
            'smallest_detectable_mm': diagnosis.smallest_detectable,
            'severity': asdict(diagnosis.severity),
        },
        DIGITS,
    )
    return found


def _described(bearing: Bearing) -> str:
    """Return name and geometry of a bearing, and what they rest on, in words."""
    if bearing.basis == 'orders':
        return f'{bearing.name}: {bearing.n_balls} rolling elements, of size unknown'
    size = f'{1e3 * bearing.d_ball:.5g} mm on {1e3 * bearing.d_pitch:.5g} mm'
    return f'{bearing.name}: {bearing.n_balls} {bearing.element}s of {size}, {bearing.basis}'
