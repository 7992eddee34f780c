# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What the diagnosis node says of its input and of the bearing on /diagnostics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.ros.health import Level, Status

if TYPE_CHECKING:
    from bearing_twin.diagnosis import Diagnosis
    from bearing_twin.streams.vibration_input import GapCounter

__all__ = ['input_status', 'verdict_status']

SILENT_AFTER = 2.0

LEVELS = {'ok': Level.OK, 'suspect': Level.WARN, 'fault': Level.ERROR, 'none': Level.WARN}


def input_status(
    *,
    age: float,
    blocks: int,
    refused: int,
    problem: str,
    ignored: int,
    contested: bool,
    gaps: GapCounter,
    shaft_problem: str,
) -> Status:
    """
    Status of the vibration stream.

    Parameters
    ----------
    age
        Time since the last block, used or refused, s; NaN before the first.
    blocks, refused
        Blocks used and refused.
    problem
        Why the last refused block was refused; '' if the last block was used.
    ignored
        Blocks of a second source on the same topic.
    contested
        Whether one of them came just now.
    gaps
        Samples lost and restarts of the source.
    shaft_problem
        What is wrong with the shaft speed; '' if nothing.

    """
    if not blocks and not problem:
        level, message = Level.STALE, 'no vibration yet'
    elif age > SILENT_AFTER:
        level, message = Level.STALE, f'no vibration for {age:.1f} s'
    elif problem:
        level, message = Level.ERROR, f'block refused: {problem}'
    elif contested:
        level, message = Level.ERROR, 'several sources on one topic: only the first is used'
    elif shaft_problem:
        level, message = Level.WARN, shaft_problem
    else:
        level, message = Level.OK, 'vibration is fresh'
    return Status(
        level,
        message,
        {
            'age [s]': age,
            'blocks used': blocks,
            'blocks refused': refused,
            'blocks of other sources': ignored,
            'samples lost': gaps.lost,
            'restarts of the source': gaps.restarts,
        },
    )


def verdict_status(result: Diagnosis | None, bearing: str) -> Status:
    """Status of the bearing."""
    if result is None:
        return Status(Level.STALE, 'no verdict yet', {'bearing': bearing})
    values: dict[str, object] = {
        'fault_code': result.fault_code,
        'bearing': bearing,
        'result': result.result,
        'faults': ', '.join(result.faults),
        'confidence': result.confidence,
        'shaft speed [Hz]': result.shaft_hz,
        'fault frequency [Hz]': result.fault_hz,
        'expected [Hz]': result.fault_hz_expected,
        'slip': result.slip,
        f'rms [{result.severity.unit or "unit unknown"}]': result.severity.rms,
        'level over baseline [dB]': result.severity.level_over_baseline,
        'reasons': '; '.join(result.reasons),
    }
    return Status(LEVELS[result.level], result.result, values)
