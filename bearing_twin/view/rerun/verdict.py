# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis: the verdict as a card, a lane and in words; evidence and severity as trends."""

from __future__ import annotations

from functools import lru_cache
import io
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.view.rerun.lanes import Lane
from bearing_twin.view.style import FAMILIES, LINE, VERDICTS
from PIL import Image, ImageDraw, ImageFont
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas

__all__ = ['VerdictPicture']

CARD = (640, 280)
"""Width and height of the card, pixels."""
MARGIN = 28


class VerdictPicture:
    """Draw the messages of one diagnosis topic."""

    def __init__(self, canvas: Canvas, name: str) -> None:
        self._canvas = canvas
        self._name = name
        self._lane = Lane(canvas, f'{name}/verdict', VERDICTS)

    def draw(self, diagnosis: Any, time: int) -> None:
        """Draw a diagnosis at ``time`` in ns."""
        number = int(diagnosis.result)
        self._lane.set(number, time)
        # Every time, not only when it changes: a server forgets the oldest first.
        self._canvas.put(
            f'{self._name}/card',
            time,
            rr.EncodedImage(contents=_card(number), media_type='image/png'),
        )
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


@lru_cache(maxsize=len(VERDICTS) + 1)
def _card(number: int) -> bytes:
    """
    Return a verdict as a coloured PNG with letters as large as fit: read from across a room.

    The headings of a viewer's text are of one size, a few millimetres on a screen.
    """
    known = 0 <= number < len(VERDICTS)
    state = VERDICTS[number] if known else VERDICTS[-1]
    text = _two_lines(state.label) if known else f'VERDICT {number}'
    image = Image.new('RGB', CARD, state.colour)
    draw = ImageDraw.Draw(image)
    size = 160
    while True:
        font = ImageFont.load_default(size)
        left, top, right, bottom = draw.multiline_textbbox((0, 0), text, font, spacing=0.2 * size)
        fits = right - left <= CARD[0] - 2 * MARGIN and bottom - top <= CARD[1] - 2 * MARGIN
        if fits or size <= 20:
            break
        size -= 4
    place = ((CARD[0] - left - right) / 2, (CARD[1] - top - bottom) / 2)
    luminance = sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), state.colour, strict=True))
    ink = 'black' if luminance > 140.0 else 'white'
    draw.multiline_text(place, text, ink, font, spacing=0.2 * size, align='center')
    buffer = io.BytesIO()
    image.quantize(16).save(buffer, 'PNG', optimize=True)
    return buffer.getvalue()


def _two_lines(text: str) -> str:
    """Return a text broken at the space that leaves the shortest lines."""
    breaks = [k for k, letter in enumerate(text) if letter == ' ']
    if not breaks:
        return text
    best = min(breaks, key=lambda k: max(k, len(text) - k - 1))
    return f'{text[:best]}\n{text[best + 1 :]}'


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
