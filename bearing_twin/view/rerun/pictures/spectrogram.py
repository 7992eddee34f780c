# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectrogram of the last minute as a picture with axes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.view.style import LINE
from bearing_twin.view.verdict import pretty
import numpy as np
from numpy.typing import NDArray
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas


COLUMNS = 300
ROWS = 96
COLUMN_SECONDS = 0.2
DRAW_EVERY = 5
"""Columns between two pictures: one a second."""
GAP = NANO
"""Least time without samples that is left blank, ns. Stamps may be off by less."""
RANGE_DB = 60.0
"""Depth of the colour scale below its top, dB."""


class Spectrogram:
    """
    Keep one minute of spectra in steps of 0.2 s and draw it once a second.

    Below a rate of 960 Hz a step is one spectrum long, and the picture spans more than a minute.

    The scale runs 60 dB down from the highest value seen, in whole steps of 10 dB, so that
    colours keep their meaning. A gap of a second or more is as long as it was and has the darkest
    colour.
    """

    def __init__(self, canvas: Canvas, name: str) -> None:
        self._canvas = canvas
        self._name = name
        self.levels = np.full((ROWS, COLUMNS), -np.inf)
        """Levels, dB re 1 unit, lowest band first, oldest step first."""
        self._pending = np.empty(0)
        self._rate = 0.0
        self._end = 0
        self._new = DRAW_EVERY
        self._top = -np.inf
        self._labelled = (0.0, 0.0)

    def add(self, samples: NDArray[np.float64], time: int, rate: float, unit: str) -> None:
        """Add samples that begin at ``time`` in ns; another sample rate starts over."""
        if rate != self._rate:
            self._rate, self._pending = rate, np.empty(0)
            self.levels[:] = -np.inf
        size = max(2 * ROWS, round(COLUMN_SECONDS * rate))
        if self._end and time - self._end >= GAP:
            pause = time - self._end + samples_ns(self._pending.size, rate)
            begun = self._begun
            blank = round(pause / samples_ns(size, rate)) - begun.shape[1]
            self._append(begun, np.full((ROWS, max(0, min(COLUMNS, blank))), -np.inf))
            self._pending = np.empty(0)
        self._end = time + samples_ns(samples.size, rate)
        waiting = np.concatenate([self._pending, samples])
        whole, self._pending = np.split(waiting, [waiting.size // size * size])
        self._append(*(_column(part)[:, None] for part in whole.reshape(-1, size)))
        if self._new >= DRAW_EVERY:
            self._new = 0
            self._draw(time, rate, unit, COLUMNS * size / rate)

    def _append(self, *columns: NDArray[np.float64]) -> None:
        if columns:
            self.levels = np.hstack([self.levels, *columns])
            self._new += self.levels.shape[1] - COLUMNS
            self.levels = self.levels[:, -COLUMNS:]

    @property
    def _begun(self) -> NDArray[np.float64]:
        """Return the step that is not full yet as a column; none if too short for a spectrum."""
        enough = self._pending.size >= 2 * ROWS
        return _column(self._pending)[:, None] if enough else np.empty((ROWS, 0))

    def _draw(self, time: int, rate: float, unit: str, seconds: float) -> None:
        levels = np.hstack([self.levels, self._begun])[:, -COLUMNS:]
        finite = levels[np.isfinite(levels)]
        if not finite.size:
            return
        self._top = max(self._top, 10.0 * float(np.ceil(finite.max() / 10.0)))
        scaled = np.clip((levels - self._top) / RANGE_DB + 1.0, 0.0, 1.0)
        picture = np.rint(np.nan_to_num(scaled) * 255.0).astype(np.uint8)
        self._canvas.put(
            self._name,
            time,
            rr.DepthImage(picture[::-1], colormap='inferno', depth_range=(0, 255)),
        )
        if (rate, self._top) != self._labelled:
            self._labelled = rate, self._top
            self._axes(time, rate, unit, seconds)

    def _axes(self, time: int, rate: float, unit: str, seconds: float) -> None:
        nyquist = rate / 2.0
        step = 10.0 ** np.floor(np.log10(nyquist)) * 0.5
        ticks = np.arange(0.0, nyquist + 1e-9, step if nyquist / step < 8 else 2.0 * step)
        rows = ROWS * (1.0 - ticks / nyquist)
        labels = [f'{tick / 1e3:g} kHz' for tick in ticks]
        positions = [[-14.0, row + 3.0] for row in rows]
        for back in np.linspace(0.0, seconds, 5):
            positions.append([COLUMNS * (1.0 - back / seconds), ROWS + 14.0])
            labels.append(f'-{back:g} s' if back else 'now')
        positions.append([COLUMNS / 2.0, -4.0])
        labels.append(f'{self._top - RANGE_DB:g} to {self._top:g} dB re 1 {pretty(unit)}')
        self._canvas.put(
            f'{self._name}/axes',
            time,
            rr.Points2D(
                positions, labels=labels, radii=0.01, colors=LINE['ground'], show_labels=True
            ),
        )


def _column(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """
    Return the level in dB over ROWS equal bands up to half the sample rate.

    By Welch's method with a Hann window of 2 * ROWS samples. `scipy.signal` has it, and the tests
    compare with it, but its import takes longer than that of all else a recorder needs.
    """
    parts = np.lib.stride_tricks.sliding_window_view(samples - samples.mean(), 2 * ROWS)[::ROWS]
    window = 0.5 - 0.5 * np.cos(np.pi * np.arange(2 * ROWS) / ROWS)
    powers = np.abs(np.fft.rfft(window * parts)[:, 1:] / window.sum()) ** 2
    powers[:, :-1] *= 2.0
    return np.asarray(10.0 * np.log10(np.maximum(powers.mean(axis=0), 1e-30)))
