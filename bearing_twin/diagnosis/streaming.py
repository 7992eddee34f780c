# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Live diagnosis: blocks in, one diagnosis per update interval out, without clocks."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.comb import OrderSpectra
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.state import pack, unpack
from bearing_twin.diagnosis.trend import Source, Trend
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.chain import Analysis
    from bearing_twin.diagnosis.result import Diagnosis
    from numpy.typing import ArrayLike, NDArray

__all__ = ['StreamingDiagnoser', 'checked_block']

_VERSION = 5


def checked_block(x: ArrayLike, sample_rate: float) -> NDArray[np.float64]:
    """
    Return the samples of one axis.

    Raises
    ------
    BearingTwinError
        If x is not one-dimensional or the sample rate is not a positive number.

    Examples
    --------
    >>> import numpy as np
    >>> checked_block([1, 2], 25600.0)
    array([1., 2.])

    """
    block = np.asarray(x, dtype=np.float64)
    if block.ndim != 1:
        msg = f'x has shape {block.shape}; push one axis as a 1-D array'
        raise BearingTwinError(msg)
    if not (math.isfinite(sample_rate) and sample_rate > 0.0):
        msg = f'sample_rate={sample_rate} Hz; a positive number is needed'
        raise BearingTwinError(msg)
    return block


class StreamingDiagnoser:
    """
    Sliding-window diagnosis of one axis of one sensor.

    The result depends on the pushed blocks alone, not on clocks: the same pushes give the same
    diagnoses to the bit. An update falls due each ``settings.update_interval`` of samples. A gap
    in ``first_sample``, an index that runs backwards (the source was restarted) or another sample
    rate starts a new window; the next diagnosis says so in its reasons. The ``level`` of the
    diagnoses is held: it follows the verdicts only after ``settings.hold_updates`` equal ones.

    Baseline and trend belong to the source that they were learnt from: sensor, bearing, unit and
    sample rate. Windows of another source have a baseline of their own and say so; the first is
    kept for when its source comes back.

    Parameters
    ----------
    bearing
        Geometry.
    settings
        See :class:`DiagnosisSettings`.

    >>> import numpy as np
    >>> from bearing_twin.bearing import find_bearing
    >>> diagnoser = StreamingDiagnoser(find_bearing('6307'))
    >>> noise = np.random.default_rng(0).standard_normal(3 * 25600)
    >>> [verdict.result for verdict in diagnoser.push(0, noise, 25600.0, 25.0)]
    ['insufficient', 'healthy', 'healthy']

    """

    def __init__(self, bearing: Bearing, settings: DiagnosisSettings | None = None) -> None:
        self._bearing = bearing
        self._settings = settings or DiagnosisSettings()
        self._earlier: deque[tuple[int, OrderSpectra]] = deque()
        self._judged = self._run = 0
        self.other_source = ''
        """Why the last window is not of the source of baseline and trend; '' if it is."""
        self._trend, self._guest = Trend(), Trend()
        self._notes: list[str] = []
        self._rate = math.nan
        self._clear(0)

    @property
    def bearing(self) -> Bearing:
        """Geometry in use."""
        return self._bearing

    @property
    def settings(self) -> DiagnosisSettings:
        """Return the settings in use."""
        return self._settings

    def reconfigure(
        self, bearing: Bearing | None = None, settings: DiagnosisSettings | None = None
    ) -> None:
        """Change geometry or settings; the window starts anew, the baseline stays."""
        self._bearing = bearing or self._bearing
        self._settings = settings or self._settings
        self._restart(self._next, 'window restarted: bearing or settings were changed')

    def push(
        self,
        first_sample: int,
        x: ArrayLike,
        sample_rate: float,
        shaft_hz: float,
        *,
        speed_measured: bool = False,
        temperature: float = math.nan,
        unit: str = '',
        sensor: str = '',
    ) -> list[Diagnosis]:
        """
        Take a block and return the diagnoses that fall due within it, oldest first.

        The same as :meth:`take`, :meth:`Excerpt.analyse` and :meth:`judge` after one another.
        """
        excerpts = self.take(
            first_sample,
            x,
            sample_rate,
            shaft_hz,
            speed_measured=speed_measured,
            temperature=temperature,
            unit=unit,
            sensor=sensor,
        )
        return [self.judge(excerpt.analyse()) for excerpt in excerpts]

    def take(
        self,
        first_sample: int,
        x: ArrayLike,
        sample_rate: float,
        shaft_hz: float,
        *,
        speed_measured: bool = False,
        temperature: float = math.nan,
        unit: str = '',
        sensor: str = '',
    ) -> list[Excerpt]:
        """
        Take a block and return the windows that fall due within it, oldest first.

        They may be analysed in any order and thread while further blocks are taken, and are then
        to be judged in their own order. A state is complete, and another bearing or setting may be
        chosen, once all have been judged.

        Parameters
        ----------
        first_sample
            Running index of the block's first sample.
        x
            Samples, shape (n,).
        sample_rate
            Hz.
        shaft_hz
            Shaft speed during the block, Hz; NaN if unknown.
        speed_measured
            Whether that speed was measured along with the samples; the search around it is then
            as narrow as ``measured_speed_tolerance``.
        temperature
            Bearing temperature, degC; NaN if unknown.
        unit
            Unit of x.
        sensor
            Whose samples they are, e.g. frame and axis.

        Raises
        ------
        BearingTwinError
            If x is not one-dimensional or the sample rate is not a positive number.

        """
        block = checked_block(x, sample_rate)
        if sample_rate != self._rate:
            if math.isfinite(self._rate):
                self._notes.append(
                    f'window restarted: sample rate went from {self._rate:g} to {sample_rate:g} Hz'
                )
            self._rate = sample_rate
            self._clear(first_sample)
        elif first_sample != self._next:
            if first_sample > self._next:
                text = f'window restarted: {first_sample - self._next} samples are missing'
            else:
                text = f'window restarted: index went back from {self._next} to {first_sample}'
            self._restart(first_sample, f'{text} before sample {first_sample}')
        due_now = []
        while len(block):
            due = self._start + (self._updates + 1) * self._interval
            part, block = block[: due - self._next], block[due - self._next :]
            self._blocks.append((part, shaft_hz))
            self._next += len(part)
            if self._next == due:
                self._updates += 1
                due_now.append(self._excerpt(speed_measured, temperature, unit, sensor))
        return due_now

    def judge(self, analysis: Analysis) -> Diagnosis:
        """Judge an analysed window together with the windows and verdicts before it."""
        excerpt = analysis.excerpt
        settings = excerpt.settings
        wanted = round(settings.window * excerpt.sample_rate)
        full = len(excerpt.samples) == wanted
        if excerpt.run != self._judged:
            self._judged = excerpt.run
            self._earlier.clear()
        source = Source(excerpt.sensor, excerpt.bearing.name, excerpt.unit, excerpt.sample_rate)
        self.other_source = ''
        if not self._trend.takes(source):
            self.other_source = f'baseline and trend are of {self._trend.source}, this is {source}'
        if analysis.window is None:
            return analysis.conclude()
        earlier = self._before(excerpt, wanted)
        if full and settings.averages:
            self._earlier.append((excerpt.end, analysis.window.orders))
        found, trend = analysis.conclude(earlier), self._trend
        if self.other_source:
            found = replace(found, reasons=(*found.reasons, self.other_source))
            if not self._guest.takes(source):
                self._guest = Trend()
            trend = self._guest
        return trend.update(
            found,
            source,
            wanted=settings.baseline_windows,
            hold=settings.hold_updates,
            full=full,
            minute=max(round(60.0 / settings.update_interval), 1),
        )

    def save(self) -> bytes:
        """State worth keeping over a restart: baseline, held level, windows that are averaged."""
        arrays = {}
        earlier = self._earlier if self._judged == self._run else ()
        for number, (_, orders) in enumerate(earlier):
            arrays[f'logs{number}'] = orders.logs
            arrays[f'excess{number}'] = orders.excess
            arrays[f'carrier{number}'] = orders.carrier
        values = {
            'trend': self._trend.values(),
            'guest': self._guest.values(),
            'sample_rate': self._rate if math.isfinite(self._rate) else None,
            'start': self._start,
            'next': self._next,
            'earlier': [(end, orders.step, orders.given) for end, orders in earlier],
        }
        return pack(_VERSION, values, arrays)

    def load(self, data: bytes) -> None:
        """
        Take up a saved state.

        The window, which no state holds, starts anew; but if the samples before that state have
        just been taken, they are its window, and updates fall due as they would have then.

        Raises
        ------
        BearingTwinError
            If the bytes are not such a state; the present state is then unchanged.

        """
        values, arrays = unpack(data, _VERSION)
        try:
            rate = values['sample_rate']
            earlier = deque(
                (
                    int(end),
                    OrderSpectra(
                        float(step),
                        arrays[f'logs{n}'],
                        arrays[f'excess{n}'],
                        arrays[f'carrier{n}'],
                        float(given),
                    ),
                )
                for n, (end, step, given) in enumerate(values['earlier'])
            )
            start, following = int(values['start']), int(values['next'])
            trend, guest = Trend.of(values['trend']), Trend.of(values['guest'])
            if rate is not None and not 0.0 < float(rate) < math.inf:
                raise ValueError(f'sample rate {rate}')
        except (KeyError, TypeError, ValueError) as error:
            msg = f'saved state lacks {error}; use what save() returned'
            raise BearingTwinError(msg) from error
        if rate == self._rate and following == self._next:
            self._start = start
            self._updates = (following - start) // self._interval
        else:
            self._rate = math.nan if rate is None else float(rate)
            self._clear(following)
        self._judged, self._earlier = self._run, earlier
        self._trend, self._guest = trend, guest

    @property
    def _interval(self) -> int:
        """Return the samples from one update to the next."""
        return max(round(self._settings.update_interval * self._rate), 1)

    def _restart(self, first_sample: int, note: str) -> None:
        self._notes.append(note)
        self._clear(first_sample)

    def _clear(self, first_sample: int) -> None:
        self._blocks: deque[tuple[NDArray[np.float64], float]] = deque()
        self._run += 1
        self._start = self._next = first_sample
        self._updates = 0

    def _excerpt(
        self, speed_measured: bool, temperature: float, unit: str, sensor: str
    ) -> Excerpt:
        settings = self._settings
        if speed_measured:
            settings = replace(settings, speed_tolerance=settings.measured_speed_tolerance)
        wanted = round(settings.window * self._rate)
        held = sum(len(part) for part, _ in self._blocks)
        while held - len(self._blocks[0][0]) >= wanted:
            held -= len(self._blocks.popleft()[0])
        lengths = np.array([len(part) for part, _ in self._blocks])
        lengths[0] -= max(held - wanted, 0)
        samples = np.concatenate([part for part, _ in self._blocks])[-wanted:]
        notes, self._notes = tuple(self._notes), []
        return Excerpt(
            samples=samples,
            shaft_hz=np.array([hz for _, hz in self._blocks]),
            lengths=lengths,
            sample_rate=self._rate,
            bearing=self._bearing,
            settings=settings,
            first_sample=self._next - len(samples),
            temperature=temperature,
            unit=unit,
            sensor=sensor,
            notes=notes,
            run=self._run,
        )

    def _before(self, excerpt: Excerpt, wanted: int) -> list[OrderSpectra]:
        """Windows to be averaged with an excerpt, oldest first; those too old are dropped."""
        oldest = excerpt.end - round(excerpt.settings.memory * excerpt.sample_rate)
        while self._earlier and self._earlier[0][0] - wanted < oldest:
            self._earlier.popleft()
        # Only windows that do not overlap this one, nor one another, add evidence.
        windows, limit = [], excerpt.first_sample
        for end, orders in reversed(self._earlier):
            if end <= limit:
                windows.append(orders)
                limit = end - wanted
        return windows[::-1]
