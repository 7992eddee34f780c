# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin fitted to its machine: width with its interval and residual over time, and in words."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.stamps import samples_ns
from bearing_twin.view.rerun.picture import Asset, Picture, Trends
from bearing_twin.view.trends import CALIBRATION
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas

__all__ = ['CalibrationPicture']


class CalibrationPicture(Picture):
    """Draw the messages of one calibration topic."""

    kind = 'calibration'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._trends = Trends(canvas, asset, CALIBRATION)

    def draw(self, message: Any, time: int) -> bool:
        """Draw a calibration whose record begins at ``time`` in ns."""
        if message.sample_rate > 0.0:
            time += samples_ns(message.sample_count, message.sample_rate)
        self._trends.hold(message, time)
        words = rr.TextDocument(_words(message), media_type=rr.MediaType.MARKDOWN)
        self.canvas.put('words', time, words)
        return True

    def flush(self, *, slow: bool) -> None:
        """Send the trends."""
        if slow:
            self._trends.flush()
        super().flush(slow=slow)


def _words(message: Any) -> str:
    """Return statement, quantities and residual in Markdown."""
    rows = zip(
        message.quantity, message.q05, message.median, message.q95, message.quantity_unit,
        message.identifiable, message.why, strict=True,
    )  # fmt: skip
    lines = [
        f'**{message.statement}**',
        '',
        f'distance {message.distance_before:.1f} -> {message.distance:.1f} dB; residual: '
        f'{message.residual_reason}',
        '',
        '| quantity | 5 % | median | 95 % | | told | why |',
        '|---|---|---|---|---|---|---|',
        *(
            f'| {name} | {low:.4g} | {mid:.4g} | {high:.4g} | {unit} | {"yes" if told else "no"} '
            f'| {why} |'
            for name, low, mid, high, unit, told, why in rows
        ),
    ]
    return '\n'.join(lines)
