# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration: samples, their envelope, spectrogram, and the waterfall over temperature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TYPE_CHECKING

from bearing_twin.stamps import NANO
from bearing_twin.view.over_temperature import NUMBERED, OverTemperature, STEP
from bearing_twin.view.rerun.pictures.picture import Asset, labelled_power, Picture
from bearing_twin.view.rerun.pictures.spectrogram import Spectrogram
from bearing_twin.view.rerun.pictures.waterfall import Waterfall
from bearing_twin.view.source import Source
from bearing_twin.view.spectrum import low_high
from bearing_twin.view.style import LINE
from bearing_twin.view.verdict import pretty
import numpy as np
from numpy.typing import NDArray
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas


FINE, COARSE = 16, 64
"""Samples per pair of lowest and highest, in the close view and in the envelope."""
BURST = 0.25
"""Part of each second that is drawn sample by sample, unless all of it is, s."""
LARGE = 0.6
"""Fraction of a power of ten up to which the viewer numbers each tenth on an axis of both signs,
half a laptop's screen high."""
AXES = {'y': ('vertical', 'blue'), 'x': ('horizontal', 'olive')}
"""Direction and colour by the field of the message."""


@dataclass
class _Piece:
    """Consecutive blocks without a gap."""

    time: int
    rate: float
    unit: str
    axes: dict[str, list[NDArray[np.float64]]] = field(default_factory=dict)

    def goes_on(
        self, axes: Mapping[str, NDArray[np.float64]], time: int, rate: float, unit: str
    ) -> bool:
        """Whether a block follows the piece, to within half a sample."""
        if (list(axes), rate, unit) != (list(self.axes), self.rate, self.unit):
            return False
        size = sum(part.size for part in next(iter(self.axes.values())))
        return abs(time - self.time - size * NANO / rate) < 0.5 * NANO / rate

    def add(self, axes: Mapping[str, NDArray[np.float64]]) -> None:
        """Take the samples of a block."""
        for axis, samples in axes.items():
            self.axes.setdefault(axis, []).append(samples)


class Waveform(Picture):
    """
    Draw the blocks of one vibration topic.

    The close view has every sample if the asset asks for it. Otherwise it has every sample of the
    first quarter of each second, and the lowest and highest of 16 in the rest: a quarter of the
    size, and the same picture except at the closest zoom.
    """

    kind = 'vibration'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._spectrogram = Spectrogram(canvas, 'spectrogram')
        self._waterfall = Waterfall(canvas, 'waterfall', asset.scales.vibration)
        self._new_strip = False
        self._pieces: list[_Piece] = []
        self._time = 0
        self._step: int | None = None
        self._source, self._over, self._apart = asset.source, asset.over_temperature, False

    def detach_from_verdict(self) -> None:
        """Become a sensor other than the verdict's, with a source and means of its own."""
        self._source, self._over, self._apart = Source(), OverTemperature(), True

    def draw(self, message: Any, time: int) -> bool:
        """Hold a block for the next flush; ``time`` of its first sample in ns."""
        rate = float(message.sample_rate)
        if not (np.isfinite(rate) and rate > 0.0):
            return False
        unit = str(message.unit)
        axes = {axis: np.asarray(getattr(message, axis), dtype=np.float64) for axis in AXES}
        axes = {axis: samples for axis, samples in axes.items() if samples.size}
        if not axes:
            return False
        if not (self._pieces and self._pieces[-1].goes_on(axes, time, rate, unit)):
            self._pieces.append(_Piece(time, rate, unit))
        self._pieces[-1].add(axes)
        self.asset.units[self.canvas.root] = pretty(unit)
        self.asset.unit = self.asset.unit if self._apart else pretty(unit)
        self.asset.panels.update(AXES[axis][0] for axis in axes)
        self._source.vibration(message)
        samples, temperature = next(iter(axes.values())), self.asset.temperature
        self._over.vibration(samples, unit, rate, temperature, float(message.shaft_hz))
        if np.isfinite(temperature):
            first = int(message.first_sample)
            self._new_strip |= self._over.take_strip(samples, first, rate, temperature)
        return True

    def flush(self, *, slow: bool) -> None:
        """Draw the held blocks; blocks without a gap are drawn as one."""
        pieces, self._pieces = self._pieces, []
        for piece in pieces:
            axes = {axis: np.concatenate(parts) for axis, parts in piece.axes.items()}
            for axis, samples in axes.items():
                self._envelope(axis, samples, piece)
            axis, samples = next(iter(axes.items()))
            self._close_look(axis, samples, piece)
            self._spectrogram.add(samples, piece.time, piece.rate, piece.unit)
        if self._new_strip and pieces:
            self._new_strip = False
            self._waterfall.draw(self._over.strips, pieces[-1].time, pieces[-1].unit)
        temperature = self.asset.temperature
        if pieces and slow and np.isfinite(temperature):
            step = round(temperature / STEP)
            if step != self._step:
                self._over_temperature(pieces[-1].time)
                self._step = step
        super().flush(slow=slow)

    def finish(self) -> None:
        """Draw the final means over temperature."""
        if self._time:
            self._over_temperature(self._time)

    def _over_temperature(self, time: int) -> None:
        """Draw how much each quantity changes with temperature, per cent."""
        self._time = time
        for curve in self._over.curves:
            temperatures, values = curve.temperatures, curve.values
            if np.isfinite(curve.base):
                values = 100.0 * (values / curve.base - 1.0)
            if self._over.is_wide:
                temperatures = np.append(temperatures, NUMBERED)
                values = np.append(values, np.zeros(len(NUMBERED)))
            bars = rr.BarChart(
                values,
                abscissa=temperatures,
                widths=np.full(values.size, 0.8 * STEP, dtype=np.float32),
                color=LINE['blue'],
            )
            key = f'over_temperature/{curve.key}'
            self.canvas.put(key, time, bars)
            self.asset.panels.add(self.canvas.path(key))

    def _close_look(self, axis: str, samples: NDArray[np.float64], piece: _Piece) -> None:
        place, colour = AXES[axis]
        kept = np.arange(samples.size)
        times = _times(kept, piece)
        if not self.asset.full:
            within = times % NANO < BURST * NANO
            within[extremes(samples, FINE)] = True
            kept = np.flatnonzero(within)
        self.canvas.line(
            f'samples/{axis}',
            times[kept],
            samples[kept],
            label=f'{place} [{pretty(piece.unit)}]',
            colour=LINE[colour],
            width=1.0,
            parted=True,
        )
        self._hold('samples', samples, piece)

    def _envelope(self, axis: str, samples: NDArray[np.float64], piece: _Piece) -> None:
        place, colour = AXES[axis]
        edges = np.arange(0, samples.size, COARSE)
        self.canvas.line(
            f'envelope/{axis}',
            _times(edges, piece),
            low_high(samples, edges),
            label=(f'{place} min', f'{place} max'),
            colour=LINE[colour],
            width=1.0,
            slow=True,
            parted=True,
        )
        self._hold('envelope', samples, piece, slow=True)

    def _hold(
        self, name: str, samples: NDArray[np.float64], piece: _Piece, *, slow: bool = False
    ) -> None:
        """Extend the axis to the next power of ten if 0 would be its only number."""
        # In eighths: the view may show less than a piece, or more.
        edges = np.arange(0, samples.size, max(1, samples.size // 8))
        peaks = np.maximum.reduceat(np.abs(samples), edges)
        ends = np.array([labelled_power(float(peak), LARGE) for peak in peaks])
        if ends.any():
            self.canvas.line(
                f'{name}/scale', _times(edges[ends > 0.0], piece),
                np.outer(ends[ends > 0.0], [-1.0, 1.0]), label=('axis', 'axis'),
                colour=LINE['back'], width=0.5, slow=slow,
            )  # fmt: skip


def extremes(samples: NDArray[np.float64], group: int) -> NDArray[np.int64]:
    """Return the indices of the lowest and highest sample of each group, in their order."""
    whole = samples.size // group
    rows = samples[: whole * group].reshape(whole, group)
    first = np.arange(whole) * group
    rest = np.arange(whole * group, samples.size)
    found = np.concatenate([first + rows.argmin(axis=1), first + rows.argmax(axis=1), rest])
    return np.unique(found)


def _times(indices: NDArray[np.int64], piece: _Piece) -> NDArray[np.int64]:
    return np.asarray(piece.time + np.rint(indices * (NANO / piece.rate)).astype(np.int64))
