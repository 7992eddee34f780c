# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Live diagnosis: blocks in, one diagnosis per update interval out, without clocks."""

from __future__ import annotations

from collections import deque
import math
from typing import TYPE_CHECKING

from bearing_twin.diagnosis.comb import OrderSpectra
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.state import pack, unpack
from bearing_twin.diagnosis.trend import Trend
from bearing_twin.diagnosis.update import Update
from bearing_twin.diagnosis.window import Window
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis
    from bearing_twin.diagnosis.update import Analysis
    from numpy.typing import ArrayLike, NDArray

__all__ = ['StreamingDiagnoser']

_VERSION = 2


class StreamingDiagnoser:
    """
    Sliding-window diagnosis of one axis of one sensor.

    The result depends on the pushed blocks alone, not on clocks: the same pushes give the same
    diagnoses to the bit. An update falls due each ``settings.update_interval`` of samples. A gap
    in ``first_sample``, an index that runs backwards (the source was restarted) or another sample
    rate starts a new window; the next diagnosis says so in its reasons. The ``level`` of the
    diagnoses is held: it follows the verdicts only after ``settings.hold_updates`` equal ones.

    Parameters
    ----------
    bearing
        Geometry.
    settings
        See :class:`DiagnosisSettings`.

    """

    def __init__(self, bearing: Bearing, settings: DiagnosisSettings | None = None) -> None:
        self._bearing = bearing
        self._settings = settings or DiagnosisSettings()
        self._earlier: deque[tuple[int, OrderSpectra]]
        self._trend = Trend()
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
    ) -> list[Diagnosis]:
        """
        Take a block and return the diagnoses that fall due within it, oldest first.

        The same as :meth:`take`, :meth:`Update.analyse` and :meth:`judge` after one another.
        """
        updates = self.take(
            first_sample,
            x,
            sample_rate,
            shaft_hz,
            speed_measured=speed_measured,
            temperature=temperature,
            unit=unit,
        )
        return [self.judge(update, update.analyse()) for update in updates]

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
    ) -> list[Update]:
        """
        Take a block and return the updates that fall due within it, oldest first.

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

        Raises
        ------
        BearingTwinError
            If x is not one-dimensional or the sample rate is not a positive number.

        """
        block = np.asarray(x, dtype=np.float64)
        if block.ndim != 1:
            msg = f'x has shape {block.shape}; push one axis as a 1-D array'
            raise BearingTwinError(msg)
        if not (math.isfinite(sample_rate) and sample_rate > 0.0):
            msg = f'sample_rate={sample_rate} Hz; a positive number is needed'
            raise BearingTwinError(msg)
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
        updates = []
        while len(block):
            due = self._start + (self._updates + 1) * self._interval
            part, block = block[: due - self._next], block[due - self._next :]
            self._blocks.append((part, shaft_hz))
            self._next += len(part)
            if self._next == due:
                self._updates += 1
                updates.append(self._update(speed_measured, temperature, unit))
        return updates

    def judge(self, update: Update, analysis: Analysis) -> Diagnosis:
        """Judge an update together with the windows and verdicts before it."""
        settings, answer = update.settings, analysis.answer
        wanted = round(settings.window * update.sample_rate)
        full = len(update.samples) == wanted
        if isinstance(answer, Window):
            earlier = _before(update, wanted)
            if full and settings.averages:
                update.earlier.append((update.end, answer.orders))
            answer = update.conclude(answer, analysis.shaft_hz, earlier)
        if analysis.refused:
            return answer
        return self._trend.update(
            answer,
            wanted=settings.baseline_windows,
            hold=settings.hold_updates,
            full=full,
        )

    def save(self) -> bytes:
        """State worth keeping over a restart: baseline, held level, windows that are averaged."""
        arrays = {}
        for number, (_, orders) in enumerate(self._earlier):
            arrays[f'logs{number}'] = orders.logs
            arrays[f'excess{number}'] = orders.excess
            arrays[f'carrier{number}'] = orders.carrier
        values = {
            'trend': self._trend.values(),
            'sample_rate': self._rate if math.isfinite(self._rate) else None,
            'start': self._start,
            'next': self._next,
            'earlier': [(end, orders.step, orders.given) for end, orders in self._earlier],
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
            trend = Trend.of(values['trend'])
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
        self._earlier = earlier
        self._trend = trend

    @property
    def _interval(self) -> int:
        """Return the samples from one update to the next."""
        return max(round(self._settings.update_interval * self._rate), 1)

    def _restart(self, first_sample: int, note: str) -> None:
        self._notes.append(note)
        self._clear(first_sample)

    def _clear(self, first_sample: int) -> None:
        self._blocks: deque[tuple[NDArray[np.float64], float]] = deque()
        # A new one: updates that are still to be judged keep theirs.
        self._earlier = deque()
        self._start = self._next = first_sample
        self._updates = 0

    def _update(self, speed_measured: bool, temperature: float, unit: str) -> Update:
        wanted = round(self._settings.window * self._rate)
        held = sum(len(part) for part, _ in self._blocks)
        while held - len(self._blocks[0][0]) >= wanted:
            held -= len(self._blocks.popleft()[0])
        lengths = np.array([len(part) for part, _ in self._blocks])
        lengths[0] -= max(held - wanted, 0)
        notes, self._notes = self._notes, []
        return Update(
            samples=np.concatenate([part for part, _ in self._blocks])[-wanted:],
            shaft_hz=np.array([hz for _, hz in self._blocks]),
            lengths=lengths,
            end=self._next,
            sample_rate=self._rate,
            bearing=self._bearing,
            settings=self._settings,
            speed_measured=speed_measured,
            temperature=temperature,
            unit=unit,
            notes=notes,
            earlier=self._earlier,
        )


def _before(update: Update, wanted: int) -> list[OrderSpectra]:
    """Windows to be averaged with that of an update, oldest first; those too old are dropped."""
    oldest = update.end - round(update.settings.memory * update.sample_rate)
    while update.earlier and update.earlier[0][0] - wanted < oldest:
        update.earlier.popleft()
    # Only windows that do not overlap this one, nor one another, add evidence.
    windows, limit = [], update.first_sample
    for end, orders in reversed(update.earlier):
        if end <= limit:
            windows.append(orders)
            limit = end - wanted
    return windows[::-1]
