# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration: samples, their envelope, spectrogram, and the waterfall over temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr

from bearing_twin.view.spectrogram import Spectrogram
from bearing_twin.view.style import LINE
from bearing_twin.view.waterfall import Waterfall

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from bearing_twin.view.canvas import Canvas

__all__ = ['Waveform']

GROUP = 16
"""Samples behind one pair of the envelope."""
BURST = 0.25
"""Part of each second that is drawn sample by sample, unless everything is, s."""
AXES = {'x': ('horizontal', 'x'), 'y': ('vertical', 'y')}


class Waveform:
    """Draw the blocks of one vibration topic.

    Parameters
    ----------
    canvas
        Where.
    name
        Entity below which it lies.
    full
        Draw every sample; else every sample of the first quarter of each second, and the envelope
        (lowest and highest of 16 samples) always: a tenth of the size, and the same picture
        except at the closest look.
    """

    def __init__(self, canvas: Canvas, name: str, *, full: bool) -> None:
        self._canvas = canvas
        self._name = name
        self._full = full
        self._spectrogram = Spectrogram(canvas, f'{name}/spectrogram')
        self._waterfall = Waterfall(canvas, f'{name}/waterfall')
        self.temperature = float('nan')
        """Latest temperature, degC, for the waterfall."""

    def draw(self, block: Any, time: int) -> None:
        """Draw one block; ``time`` of its first sample in ns."""
        rate = float(block.sample_rate)
        if not (np.isfinite(rate) and rate > 0.0):
            return
        drawn = None
        for axis in ('y', 'x'):
            samples = np.asarray(getattr(block, axis), dtype=np.float64)
            if samples.size:
                self._draw_axis(axis, samples, time, rate, str(block.unit))
                if drawn is None:
                    drawn = samples
        if drawn is not None:
            self._spectrogram.add(drawn, time, rate, str(block.unit))
            self._waterfall.add(drawn, time, rate, self.temperature, str(block.unit))

    def _draw_axis(
        self, axis: str, samples: NDArray[np.float64], time: int, rate: float, unit: str
    ) -> None:
        place, _ = AXES[axis]
        times = time + np.rint(np.arange(samples.size) * (1e9 / rate)).astype(np.int64)
        if axis == 'y' and (self._full or time % 1_000_000_000 < BURST * 1e9):
            self._canvas.line(
                f'{self._name}/samples/{axis}',
                times,
                samples,
                label=f'{place} [{unit}]',
                colour=LINE[place],
                width=1.0,
            )
        groups = max(1, samples.size // GROUP)
        edges = np.arange(groups) * GROUP
        self._envelope(axis, place, unit, times[edges], samples, edges)

    def _envelope(
        self,
        axis: str,
        place: str,
        unit: str,
        times: NDArray[np.int64],
        samples: NDArray[np.float64],
        edges: NDArray[np.int64],
    ) -> None:
        name = f'{self._name}/envelope/{axis}'
        pairs = np.stack(
            [np.minimum.reduceat(samples, edges), np.maximum.reduceat(samples, edges)], axis=1
        )
        self._canvas.once(
            name,
            rr.SeriesLines(
                names=[f'{place} lowest [{unit}]', f'{place} highest [{unit}]'],
                colors=[LINE[place], LINE[place]],
                widths=[1.0, 1.0],
            ),
        )
        self._canvas.recording.send_columns(
            self._canvas.path(name),
            [self._canvas.timebase.column(times)],
            rr.Scalars.columns(scalars=pairs.ravel()).partition(np.full(len(edges), 2)),
        )
