# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagnosis: the verdict as a card, a lane and a text; evidence and severity as trends."""

from __future__ import annotations

from functools import lru_cache
from textwrap import fill
from typing import Any, TYPE_CHECKING

from bearing_twin.recording.topics import LEVEL_FAULT, LEVEL_SUSPECT
from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.view.rerun.canvas import png
from bearing_twin.view.rerun.pictures.lanes import Lane
from bearing_twin.view.rerun.pictures.picture import Asset, Picture
from bearing_twin.view.style import ink, State, VERDICTS
from bearing_twin.view.trends import DIAGNOSIS, OVER_LIMITS
from bearing_twin.view.verdict import (
    facts,
    Headline,
    judged_by_velocity,
    only_held,
    reasons,
    title_of,
)
from PIL import Image, ImageDraw, ImageFont
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas


CARD = (640, 150)
"""Width and height of the card, pixels."""
MARGIN = 22
SHORT, NARROW = 52, 38
"""Longest text of a table cell that fits beside the bearing, and beside another recording."""
BELOW = 40
"""Height of a line below the verdict."""
LANE = (*VERDICTS, State('stale', 'No new verdict', VERDICTS[-1].colour))
"""States of the lane of verdicts: without vibration there is none."""


class VerdictPicture(Picture):
    """Draw the messages of one diagnosis topic."""

    kind = 'diagnosis'
    panels = (OVER_LIMITS, *DIAGNOSIS)

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._lane = Lane(canvas, 'verdict', LANE)
        self._headline = asset.headline = Headline()
        self._begin: int | None = None
        self._seen: tuple[str, int] | None = None
        self._lapsed: tuple[str, int] | None = None

    def draw(self, message: Any, time: int) -> bool:
        """Draw a diagnosis whose window begins at ``time`` in ns."""
        if self._begin is None:
            self._begin = time
        # The stamp is that of the window's first sample; the verdict is known at its end.
        if message.sample_rate > 0.0:
            time += samples_ns(message.sample_count, message.sample_rate)
        self.asset.diagnosis = message
        self.asset.over_temperature.diagnosis(message)
        self._headline.take((time - self._begin) / NANO, message)
        result = int(message.result)
        self.asset.judged = time
        self._seen, self._lapsed = self.asset.source.stale, None
        if judged_by_velocity(message):
            self.asset.panels.add('severity')
        self._lane.set(result, time)
        # Logged every time, not only on changes: a server forgets the oldest first.
        card = _card(result, title_of(message), only_held(message))
        self._put(time, card, self._words(message))
        self.trends.hold(message, time)
        return True

    def flush(self, *, slow: bool) -> None:
        """Send what is held, and say so if the latest verdict is no longer about the present."""
        if (stale := self.asset.source.stale) != self._seen:
            self._seen = stale
            # A status of before the verdict may be heard after it.
            if stale is not None and self._headline.count and stale[1] > self.asset.judged:
                self._lapse(*stale)
        super().flush(slow=slow)

    def _lapse(self, why: str, time: int) -> None:
        """Show from a time in ns on that there is no verdict any more, and why."""
        verdict, lack = self._headline.last, _lack(why)
        self._lapsed = why, time
        card = _card(int(verdict.result), title_of(verdict), f'{lack} since then')
        if verdict.level not in (LEVEL_SUSPECT, LEVEL_FAULT):
            # Only an alarm does not end because nobody measures.
            below = f'before: {title_of(verdict).lower()}'
            card = _card(len(VERDICTS) - 1, lack.capitalize(), below)
        self._lane.set(len(VERDICTS), time)
        self._put(time, card, f'**Not up to date:** {why}.\n\n{self._words(verdict)}')

    def finish(self) -> None:
        """Show the worst sustained verdict if the recording ends with another one or without."""
        end, time = self._headline.ending, self.asset.judged
        verdict, span, late = self._headline.last, '', ''
        if end:
            verdict, span = self._headline.worst.best, f' in {self._headline.span}'
        if self._lapsed is not None:
            why, time = self._lapsed
            end, late = end or _lack(why), f' **Not up to date:** {why}.'
        if end:
            card = _card(int(verdict.result), title_of(verdict), f'at the end: {end}')
            text = f'**{title_of(verdict)}**{span}.{late}\n\n{self._words(verdict, whole=True)}'
            self._put(time + 1, card, text)

    def _put(self, time: int, card: rr.EncodedImage, text: str) -> None:
        """Draw card and words at a time in ns."""
        self.canvas.put('card', time, card)
        words = rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN)
        self.canvas.put('words', time, words)

    def _words(self, diagnosis: Any, *, whole: bool = False) -> str:
        """Return a diagnosis as Markdown; ``whole`` with all sources of the vibration so far."""
        rows, source = facts(diagnosis), self.asset.source
        if self.asset.narrow:
            # One unit for both frequencies, so that the row stays in the table.
            rows = [(n, t.replace(' Hz (', ' (') if n == 'Found' else t) for n, t in rows]
        if source.text:
            rows.append(('Vibration', source.whole if whole else source.text))
        longest = NARROW if self.asset.narrow else SHORT
        for name, other in (('Level', 'Velocity'), ('Shaft', 'Temperature')):
            one, two = (next((r for r in rows if r[0] == n), None) for n in (name, other))
            if one and two and len(both := f'{one[1]}, {two[1]}') <= longest:
                # One row less leaves room for the reason why it is no other fault.
                rows[rows.index(one)] = name, both
                rows.remove(two)
        # The cells of a table do not wrap.
        short = [row for row in rows if len(row[1]) <= longest]
        lines = [f'| {name} | {text} |' for name, text in short]
        lines.insert(1, '|---|---|')
        for name, text in rows:
            lines += ['', f'**{name}:** {text}'] if len(text) > longest else []
        lines += ['', *(f'- {reason}' for reason in reasons(diagnosis))]
        return '\n'.join(lines)


def _lack(why: str) -> str:
    """Return in two or three words what is missing, given why there is no verdict."""
    return 'no vibration' if 'no vibration' in why else 'no new verdict'


@lru_cache(maxsize=32)
def _card(number: int, text: str, below: str = '') -> rr.EncodedImage:
    """
    Return a verdict as a coloured image, its letters as large as fit: legible across a room.

    Notes
    -----
    Headings in the viewer have one size, a few millimetres on a screen.

    """
    known = 0 <= number < len(VERDICTS)
    state = VERDICTS[number] if known else VERDICTS[-1]
    # Two lines of large letters rather than one of small.
    text = fill(text or f'verdict {number}', 20)
    image = Image.new('RGB', CARD, state.colour)
    draw = ImageDraw.Draw(image)
    size = 110
    while True:
        font = ImageFont.load_default(size)
        left, top, right, bottom = draw.textbbox((0, 0), text, font)
        room = CARD[1] - 2 * MARGIN - (BELOW if below else 0)
        fits = right - left <= CARD[0] - 2 * MARGIN and bottom - top <= room
        if fits or size <= 20:
            break
        size -= 4
    height = CARD[1] - (BELOW if below else 0)
    place = ((CARD[0] - left - right) / 2, (height - top - bottom) / 2)
    letters = ink(state.colour)
    draw.text(place, text, letters, font, align='center')
    if below:
        font = ImageFont.load_default(BELOW - 8)
        width = draw.textlength(below, font)
        draw.text(((CARD[0] - width) / 2, height - 14), below, letters, font)
    return png(image, 16)
