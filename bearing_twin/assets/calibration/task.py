# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fit the twin to a record of a machine in a separate process: task and result."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.calibration import Calibration, fit
from bearing_twin.calibration.fit import decimated, fitted_vibration
from bearing_twin.calibration.joint import corrected_by_speeds
from bearing_twin.calibration.residual import spectral_levels
from bearing_twin.dynamics.equations.sensor_path import band_levels
import numpy as np
from numpy.typing import NDArray
import scipy

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.calibration.answer.impacts import Impacts


SHOWN_S = 2.0
"""Length of the vibration of the fitted twin for display beside the machine, s."""
PARTS = 16
"""Number of parts of a revolution. The shown revolution has its loudest part in the middle.
Impacts on a race are 3 to 12 parts apart, and their ringing lasts about one part."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """A record to fit, as plain values that can be sent to another process."""

    samples: NDArray[np.float64]
    sample_rate: float
    bearing: Bearing
    shaft_hz: float
    temperature: float
    unit: str
    place: str | None
    load: tuple[float, float] | None
    candidates: int
    others: tuple[Impacts, ...]
    """Impacts that earlier fits found."""
    reference: dict[str, Any] | None
    """Healthy twin from which the residual is computed; None: the result of this fit."""
    healthy: bool
    """Whether the diagnosis found the machine healthy before the fit."""
    repairs: int
    """Number of repairs before the fit."""
    stamp: int
    """Time of the first sample, ns."""
    frame_id: str
    first_sample: int


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Result of a task."""

    found: dict[str, Any]
    """The calibration, as plain values."""
    bands: tuple[str, ...]
    measured: NDArray[np.float64]
    """Level of the machine in each band, dB, shape (m,)."""
    twin: NDArray[np.float64]
    """Level of the reference twin in each band, dB, shape (m,); NaN beyond its sample rate."""
    spectrum: NDArray[np.float64]
    """`band_levels` of the fitted twin, dB; ``found`` contains those of the machine."""
    turns: NDArray[np.float64]
    """One revolution of machine and fitted twin, shape (2, n)."""


def fit_record(task: Task) -> Fit:
    """Fit a record and compute spectra of machine and twin; runs in a separate process."""
    found = fit(
        task.samples, task.sample_rate, task.bearing, task.shaft_hz, load=task.load,
        temperature=task.temperature, unit=task.unit, place=task.place,
        candidates=task.candidates,
    )  # fmt: skip
    found = corrected_by_speeds(found, task.others)
    reference = Calibration.from_dict(task.reference) if task.reference else found
    here = reference.at(shaft_hz=task.shaft_hz)
    if math.isfinite(task.temperature):
        here = here.at(temperature=task.temperature)
    seconds = len(task.samples) / task.sample_rate
    # The twin may run at a lower rate than the sensor; then its higher bands are NaN.
    bands, measured = spectral_levels(task.samples, task.sample_rate, task.shaft_hz)
    names, levels = spectral_levels(
        fitted_vibration(here, seconds), here.situation.sample_rate, task.shaft_hz
    )
    own = dict(zip(names, levels, strict=True))
    twin = np.array([own.get(band, math.nan) for band in bands])
    spectrum, turns = comparison(found, task.samples, task.sample_rate)
    return Fit(
        found=found.to_dict(), bands=bands, measured=measured, twin=twin, spectrum=spectrum,
        turns=turns,
    )  # fmt: skip


def comparison(
    found: Calibration, samples: NDArray[np.float64], sample_rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return `band_levels` of the twin, dB, and a revolution of machine and twin, (2, m)."""
    rate, shaft_hz = found.situation.sample_rate, found.situation.shaft_hz
    shown = fitted_vibration(found, max(SHOWN_S, 2.0 / shaft_hz))
    slow = decimated(samples - samples.mean(), sample_rate)[0]
    return band_levels(shown, rate), revolutions(slow, shown, int(rate / shaft_hz))


def revolutions(
    machine: NDArray[np.float64], twin: NDArray[np.float64], length: int
) -> NDArray[np.float64]:
    """
    Return one revolution of machine and twin for display, shape (2, ``length``).

    The loudest part of the machine's revolution is in its middle, because an impact at the ends
    would be split in two. The rotation angle of the twin is arbitrary, so the revolution that
    correlates best with the machine is chosen.

    Both signals have the same sample rate, with ``length`` samples per revolution. ``machine``
    has at least three revolutions, ``twin`` at least two.

    Examples
    --------
    >>> impacts = np.zeros(400)
    >>> impacts[[0, 100, 200, 300]] = 1.0
    >>> turns = revolutions(impacts, np.roll(impacts, 30), 100)
    >>> turns.argmax(axis=1).tolist()
    [52, 52]

    """
    reach = max(length // PARTS, 1)
    loudness = np.convolve(np.abs(machine[length : 3 * length]), np.ones(reach), 'same')
    # Start at the second revolution, when the filter has settled.
    begin = length + int(np.argmax(loudness[length // 2 : length // 2 + length]))
    turn = machine[begin : begin + length]
    turn = turn - turn.mean()
    size = np.abs(turn)
    alike = scipy.signal.correlate(np.abs(twin), size - size.mean(), 'valid')
    first = int(np.argmax(alike))
    return np.array([turn, twin[first : first + length]])
