# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Live diagnosis: blocks in, one diagnosis per update interval out, without clocks."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.chain import (
    analyse_window,
    conclude,
    highest_fault_order,
)
from bearing_twin.diagnosis.comb import OrderSpectra
from bearing_twin.diagnosis.gate import check_record
from bearing_twin.diagnosis.report import insufficient
from bearing_twin.diagnosis.settings import DiagnosisSettings
from bearing_twin.diagnosis.shaft import resample_to_angle
from bearing_twin.diagnosis.state import pack, unpack
from bearing_twin.diagnosis.trend import Trend
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Diagnosis
    from numpy.typing import ArrayLike, NDArray

__all__ = ['StreamingDiagnoser']

_VERSION = 2
_STEADY = 0.005


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
        self._earlier: deque[tuple[int, OrderSpectra]] = deque()
        self._trend = Trend()
        self._notes: list[str] = []
        self._rate = math.nan
        self._unit = ''
        self._temperature = math.nan
        self._speed_measured = False
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
        self._temperature, self._unit = temperature, unit
        self._speed_measured = speed_measured
        found = []
        interval = max(round(self._settings.update_interval * sample_rate), 1)
        while len(block):
            due = self._start + (self._updates + 1) * interval
            part, block = block[: due - self._next], block[due - self._next :]
            self._blocks.append((part, shaft_hz))
            self._next += len(part)
            if self._next == due:
                self._updates += 1
                found.append(self._diagnose())
        return found

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
            'next': self._next,
            'earlier': [(end, orders.step, orders.given) for end, orders in self._earlier],
        }
        return pack(_VERSION, values, arrays)

    def load(self, data: bytes) -> None:
        """
        Take up a saved state; the window itself starts anew.

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
            following = int(values['next'])
            trend = Trend.of(values['trend'])
            if rate is not None and not 0.0 < float(rate) < math.inf:
                raise ValueError(f'sample rate {rate}')
        except (KeyError, TypeError, ValueError) as error:
            msg = f'saved state lacks {error}; use what save() returned'
            raise BearingTwinError(msg) from error
        self._rate = math.nan if rate is None else float(rate)
        self._clear(following)
        self._earlier = earlier
        self._trend = trend

    def _restart(self, first_sample: int, note: str) -> None:
        self._notes.append(note)
        self._clear(first_sample)

    def _clear(self, first_sample: int) -> None:
        self._blocks: deque[tuple[NDArray[np.float64], float]] = deque()
        self._earlier.clear()
        self._start = self._next = first_sample
        self._updates = 0

    def _diagnose(self) -> Diagnosis:
        wanted = round(self._settings.window * self._rate)
        held = sum(len(part) for part, _ in self._blocks)
        while held - len(self._blocks[0][0]) >= wanted:
            held -= len(self._blocks.popleft()[0])
        x = np.concatenate([part for part, _ in self._blocks])[-wanted:]
        speeds = np.concatenate([np.full(len(part), hz) for part, hz in self._blocks])[-wanted:]
        mean_hz = float(speeds.mean())
        first = self._next - len(x)
        about: dict[str, Any] = {
            'first_sample': first,
            'sample_count': len(x),
            'sample_rate': self._rate,
            'temperature': self._temperature,
        }
        notes, self._notes = self._notes, []
        reasons = check_record(x, self._rate, mean_hz, highest_fault_order(self._bearing))
        if not reasons and float(speeds.min()) <= 0.0:
            reasons = ['the shaft stood still or turned backwards within the window']
        if reasons:
            return insufficient(
                [*notes, *reasons],
                self._bearing,
                shaft_hz=mean_hz,
                unit=self._unit,
                **about,
            )
        signal = x
        if float(np.ptp(speeds)) > _STEADY * mean_hz:
            signal, mean_hz = resample_to_angle(x, self._rate, speeds)
        settings = self._settings
        if self._speed_measured:
            settings = replace(settings, speed_tolerance=settings.measured_speed_tolerance)
        window = analyse_window(
            signal, self._rate, self._bearing, mean_hz, settings, unit=self._unit
        )
        # Only windows that do not overlap this one, nor one another, add evidence.
        oldest = self._next - round(self._settings.memory * self._rate)
        while self._earlier and self._earlier[0][0] - wanted < oldest:
            self._earlier.popleft()
        earlier, limit = [], first
        for end, orders in reversed(self._earlier):
            if end <= limit:
                earlier.append(orders)
                limit = end - wanted
        full = len(x) == wanted
        if full and self._settings.memory >= 2.0 * self._settings.window:
            self._earlier.append((self._next, window.orders))
        diagnosis = conclude(
            window,
            self._bearing,
            earlier=earlier[::-1],
            shaft_hz_given=mean_hz,
            notes=notes,
            **about,
        )
        return self._trend.update(
            diagnosis,
            wanted=self._settings.baseline_windows,
            hold=self._settings.hold_updates,
            full=full,
        )
