# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Calibration: defect width and residual over time, spectra and a revolution, and a text."""

from __future__ import annotations

import math
from typing import Any

from bearing_twin.stamps import samples_ns
from bearing_twin.view.rerun.pictures.picture import Picture
from bearing_twin.view.style import LINE
from bearing_twin.view.trends import CALIBRATION
import numpy as np
from numpy.typing import NDArray
import rerun as rr

NAMES = 'machine', 'twin'
FIELDS = 'measured_turn', 'twin_turn'
ALIKE_DB = 10.0
"""Least range of the axis of the spectral difference, dB."""
BARS = 400
"""Largest number of bars of one revolution."""


class CalibrationPicture(Picture):
    """Draw the messages of one calibration topic."""

    kind = 'calibration'
    panels = CALIBRATION
    low = 0.5

    def draw(self, message: Any, time: int) -> bool:
        """Draw a calibration whose record begins at ``time`` in ns."""
        if message.sample_rate > 0.0:
            time += samples_ns(message.sample_count, message.sample_rate)
        self.trends.hold(message, time)
        words = rr.TextDocument(_words(message), media_type=rr.MediaType.MARKDOWN)
        self.canvas.put('words', time, words)
        self._draw_spectra(message, time)
        self._draw_turns(message, time)
        return True

    def _draw_spectra(self, message: Any, time: int) -> None:
        """Draw both spectra relative to their lowest level, since bars begin at zero."""
        both = [
            np.array(getattr(message, name), dtype=np.float32)[1:]
            for name in ('measured_spectrum', 'twin_spectrum')
        ]
        if not all(map(len, both)):
            return
        ground = min(float(levels.min()) for levels in both)
        for name, levels, width in zip(NAMES, both, (1.0, 0.4), strict=True):
            hertz = message.spectrum_step * np.arange(1, len(levels) + 1, dtype=np.float32)
            self._bars(f'spectrum/{name}', time, hertz, levels - ground, width)
        self._bars('difference/machine', time, hertz, both[0] - both[1], 1.0)
        # An axis takes no range: bars without width extend it, so that small differences look so.
        ends = np.array([-ALIKE_DB, ALIKE_DB], np.float32)
        self._bars('difference/axis', time, hertz[[0, 0]], ends, 0.0)
        self.asset.panels.add('fitted_spectrum')

    def _draw_turns(self, message: Any, time: int) -> None:
        """Draw a revolution of machine and twin; each bar is the largest of a group of samples."""
        for name, field, share in zip(NAMES, FIELDS, (1.0, 0.4), strict=True):
            turn = np.array(getattr(message, field), dtype=np.float32)
            if not len(turn):
                return
            group = -(-len(turn) // BARS)
            rows = turn[: len(turn) // group * group].reshape(-1, group)
            largest = rows[np.arange(len(rows)), np.abs(rows).argmax(axis=1)]
            step = 1e3 * group / message.turn_rate
            place = step * np.arange(len(rows), dtype=np.float32)
            self._bars(f'turn/{name}', time, place, largest, share)
        self.asset.panels.add('fitted_turn')

    def _bars(
        self,
        name: str,
        time: int,
        places: NDArray[np.float32],
        values: NDArray[np.float32],
        share: float,
    ) -> None:
        width = share * float(places[1] - places[0]) if len(places) > 1 else share
        colour = LINE['blue' if name.endswith('twin') else 'ground']
        widths = np.full(values.shape, np.float32(width))
        self.canvas.put(
            name, time, rr.BarChart(values, abscissa=places, widths=widths, color=colour)
        )


def _residual(message: Any) -> str:
    if math.isnan(message.residual):
        return f'no residual yet: {message.residual_reason}'
    size = f'{message.residual:.2g}{", an alarm" if message.residual_alarm else " of 1"}'
    return f'residual {size}: {message.residual_reason}'


def _words(message: Any) -> str:
    """Return statement, quantities and residual in Markdown."""
    rows = zip(
        message.quantity, message.q05, message.median, message.q95, message.quantity_unit,
        message.identifiable, message.why, strict=True,
    )  # fmt: skip
    lines = [
        f'**{message.statement}**',
        '',
        f'distance {message.distance_before:.1f} -> {message.distance:.1f} dB; '
        + _residual(message),
        '',
        '| quantity | 5 % | median | 95 % | | identifiable | why |',
        '|---|---|---|---|---|---|---|',
        *(
            f'| {name} | {low:.4g} | {mid:.4g} | {high:.4g} | {unit} '
            f'| {"yes" if identifiable else "no"} | {why} |'
            # Only the first rows are seen without scrolling.
            for name, low, mid, high, unit, identifiable, why in sorted(
                rows, key=lambda row: (not row[0].startswith('defect'), not row[5])
            )
        ),
    ]
    return '\n'.join(lines)
