# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration: samples, their envelope, spectrogram, and the waterfall over temperature."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.view.spectrogram import Spectrogram
from bearing_twin.view.style import LINE
from bearing_twin.view.waterfall import Waterfall
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.canvas import Canvas
    from numpy.typing import NDArray

__all__ = ['Waveform', 'extremes']

FINE, COARSE = 16, 64
"""Samples behind one pair of the close look and of the envelope."""
BURST = 0.25
"""Part of each second that is drawn sample by sample, unless everything is, s."""
AXES = {'y': 'vertical', 'x': 'horizontal'}


class Waveform:
    """
    Draw the blocks of one vibration topic.

    Parameters
    ----------
    canvas
        Where.
    name
        Entity below which it lies.
    full
        Draw every sample. Else the close look has every sample of the first quarter of each
        second, and of the rest the lowest and highest of 16: a quarter of the size, and the same
        picture except at the closest look.

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
        unit = str(block.unit)
        axes = {axis: np.asarray(getattr(block, axis), dtype=np.float64) for axis in AXES}
        axes = {axis: samples for axis, samples in axes.items() if samples.size}
        for axis, samples in axes.items():
            self._envelope(axis, samples, time, rate, unit)
        if axes:
            axis, samples = next(iter(axes.items()))
            self._close_look(axis, samples, time, rate, unit)
            self._spectrogram.add(samples, time, rate, unit)
            self._waterfall.add(samples, time, rate, self.temperature, unit)

    def _close_look(
        self, axis: str, samples: NDArray[np.float64], time: int, rate: float, unit: str
    ) -> None:
        kept = np.arange(samples.size)
        if not (self._full or time % 1_000_000_000 < BURST * 1e9):
            kept = extremes(samples, FINE)
        self._canvas.line(
            f'{self._name}/samples/{axis}',
            _times(kept, time, rate),
            samples[kept],
            label=f'{AXES[axis]} [{unit}]',
            colour=LINE[AXES[axis]],
            width=1.0,
        )

    def _envelope(
        self, axis: str, samples: NDArray[np.float64], time: int, rate: float, unit: str
    ) -> None:
        name = f'{self._name}/envelope/{axis}'
        place, colour = AXES[axis], LINE[AXES[axis]]
        edges = np.arange(0, samples.size, COARSE)
        pairs = np.stack(
            [np.minimum.reduceat(samples, edges), np.maximum.reduceat(samples, edges)], axis=1
        )
        if self._canvas.is_new(name):
            self._canvas.once(
                name,
                rr.SeriesLines(
                    names=[f'{place} min [{unit}]', f'{place} max [{unit}]'],
                    colors=[colour, colour],
                    widths=[1.0, 1.0],
                ),
            )
        self._canvas.recording.send_columns(
            self._canvas.path(name),
            [self._canvas.timebase.column(_times(edges, time, rate))],
            rr.Scalars.columns(scalars=pairs.ravel()).partition(np.full(len(edges), 2)),
        )


def extremes(samples: NDArray[np.float64], group: int) -> NDArray[np.int64]:
    """Return the indices of the lowest and highest sample of each group, in their order."""
    whole = samples.size // group
    rows = samples[: whole * group].reshape(whole, group)
    first = np.arange(whole) * group
    rest = np.arange(whole * group, samples.size)
    found = np.concatenate([first + rows.argmin(axis=1), first + rows.argmax(axis=1), rest])
    return np.unique(found)


def _times(indices: NDArray[np.int64], time: int, rate: float) -> NDArray[np.int64]:
    return np.asarray(time + np.rint(indices * (1e9 / rate)).astype(np.int64))
