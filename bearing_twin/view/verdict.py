# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis: the verdict as a lane and in words, its evidence and the severity as trends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import rerun as rr

from bearing_twin.view.lanes import Lane
from bearing_twin.view.style import FAMILIES, LINE, VERDICTS

if TYPE_CHECKING:
    from bearing_twin.view.canvas import Canvas

__all__ = ['VerdictPicture']


class VerdictPicture:
    """Draw the messages of one diagnosis topic."""

    def __init__(self, canvas: Canvas, name: str) -> None:
        self._canvas = canvas
        self._name = name
        self._lane = Lane(canvas, f'{name}/verdict', VERDICTS)

    def draw(self, diagnosis: Any, time: int) -> None:
        """Draw a diagnosis at ``time`` in ns."""
        self._lane.set(int(diagnosis.result), time)
        self._canvas.put(
            f'{self._name}/words',
            time,
            rr.TextDocument(words(diagnosis), media_type=rr.MediaType.MARKDOWN),
        )
        unit = str(diagnosis.unit)
        severity = {
            'rms': (diagnosis.rms, f'rms [{unit}]', LINE['first']),
            'velocity_rms': (diagnosis.velocity_rms, 'velocity rms [mm/s]', LINE['second']),
            'kurtosis': (diagnosis.kurtosis, 'kurtosis [1]', LINE['fourth']),
            'baseline': (diagnosis.level_over_baseline, 'over baseline [dB]', LINE['third']),
        }
        self._canvas.points(
            time, {f'{self._name}/severity/{key}': entry for key, entry in severity.items()}
        )
        self._canvas.points(
            time,
            {
                f'{self._name}/evidence/{family.key}': (
                    float(score),
                    f'{family.label} [sd]',
                    family.colour,
                )
                for family, score in zip(FAMILIES, diagnosis.score, strict=False)
            },
        )


def words(diagnosis: Any) -> str:
    """Return a diagnosis as Markdown."""
    number = int(diagnosis.result)
    label = VERDICTS[number].label if 0 <= number < len(VERDICTS) else diagnosis.result_name
    lines = [f'# {label}', '']
    faults = ', '.join(diagnosis.faults)
    lines.append(
        f'confidence **{diagnosis.confidence:.0%}**' + (f', found: {faults}' if faults else '')
    )
    if math.isfinite(diagnosis.fault_hz):
        off = diagnosis.fault_hz / diagnosis.fault_hz_expected - 1.0
        lines.append(
            f'\n**{diagnosis.fault_hz:.2f} Hz** against {diagnosis.fault_hz_expected:.2f} Hz '
            f'expected ({off:+.2%})'
        )
    lines += ['', *(f'- {reason}' for reason in diagnosis.reasons), '']
    facts = [
        f'{diagnosis.bearing} at {diagnosis.shaft_hz:.2f} Hz'
        if math.isfinite(diagnosis.shaft_hz)
        else str(diagnosis.bearing),
        f'{diagnosis.temperature:.1f} °C' if math.isfinite(diagnosis.temperature) else '',
        f'ISO 20816-3 zone {diagnosis.iso_zone}' if diagnosis.iso_zone else '',
    ]
    lines.append(', '.join(filter(None, facts)))
    return '\n'.join(lines)
