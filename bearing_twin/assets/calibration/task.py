# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A record of a machine, fitted in a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.calibration import Calibration, fit
from bearing_twin.calibration.fit import decimated, fitted_vibration
from bearing_twin.calibration.joint import compared
from bearing_twin.calibration.residual import spectral_levels
from bearing_twin.dynamics.equations.sensor_path import band_levels
import numpy as np
import scipy

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.calibration.answer.impacts import Impacts
    from numpy.typing import NDArray


SHOWN_S = 2.0
"""Length of the fitted twin's vibration that is shown beside the machine's, s."""
PARTS = 16
"""Parts of a revolution of which the loudest is sought: impacts on a race are 3 to 12 parts apart,
and their ringing lasts about one."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """A record to be fitted; plain values that go to another process."""

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
    """What the fits before have seen of the impacts of a passage."""
    reference: dict[str, Any] | None
    """The calibration that the residual is taken from; None: the one that is found."""
    healthy: bool
    """Whether the diagnosis said so before the fit."""
    repairs: int
    """Before it."""
    stamp: int
    """ns."""
    frame_id: str
    first_sample: int


@dataclass(frozen=True, kw_only=True)
class Fit:
    """What became of a task."""

    found: dict[str, Any]
    """The calibration, as plain values."""
    bands: tuple[str, ...]
    measured: NDArray[np.float64]
    """Level of the machine in each band, dB, shape (m,)."""
    twin: NDArray[np.float64]
    """Level of the twin of the reference, dB, shape (m,)."""
    spectrum: NDArray[np.float64]
    """`band_levels` of the fitted twin, dB; those of the machine are in ``found``."""
    turns: NDArray[np.float64]
    """One revolution of machine and fitted twin, shape (2, n)."""


def work(task: Task) -> Fit:
    """Fit a record, and take the spectra of machine and twin; in a process of its own."""
    found = fit(
        task.samples, task.sample_rate, task.bearing, task.shaft_hz, load=task.load,
        temperature=task.temperature, unit=task.unit, place=task.place,
        candidates=task.candidates,
    )  # fmt: skip
    found = compared(found, task.others)
    reference = Calibration.from_dict(task.reference) if task.reference else found
    here = reference.at(shaft_hz=task.shaft_hz)
    if math.isfinite(task.temperature):
        here = here.at(temperature=task.temperature)
    seconds = len(task.samples) / task.sample_rate
    # The twin may run at a lower rate than the sensor; bands beyond it are not compared.
    bands, measured = spectral_levels(task.samples, task.sample_rate, task.shaft_hz)
    names, levels = spectral_levels(
        fitted_vibration(here, seconds), here.situation.sample_rate, task.shaft_hz
    )
    own = dict(zip(names, levels, strict=True))
    twin = np.array([own.get(band, math.nan) for band in bands])
    spectrum, turns = beside(found, task.samples, task.sample_rate)
    return Fit(
        found=found.to_dict(), bands=bands, measured=measured, twin=twin, spectrum=spectrum,
        turns=turns,
    )  # fmt: skip


def beside(
    found: Calibration, samples: NDArray[np.float64], sample_rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the twin's `band_levels`, dB, and a revolution of machine and twin, shape (2, m)."""
    rate, shaft_hz = found.situation.sample_rate, found.situation.shaft_hz
    shown = fitted_vibration(found, max(SHOWN_S, 2.0 / shaft_hz))
    slow = decimated(samples - samples.mean(), sample_rate)[0]
    return band_levels(shown, rate), revolutions(slow, shown, int(rate / shaft_hz))


def revolutions(
    machine: NDArray[np.float64], twin: NDArray[np.float64], length: int
) -> NDArray[np.float64]:
    """
    Return a revolution of machine and twin, shape (2, ``length``).

    The machine's has its loudest part in the middle: an impact where it wraps round would be torn
    in two, and neither part tells where the twin is alike. The twin turns at an angle of its own;
    it is shown where it is most like the machine.

    The vibration has at least three, and that of the twin two, at one rate; ``length`` is the
    samples of one.

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
    # From the second revolution on: the filter has settled.
    begin = length + int(np.argmax(loudness[length // 2 : length // 2 + length]))
    turn = machine[begin : begin + length]
    turn = turn - turn.mean()
    size = np.abs(turn)
    alike = scipy.signal.correlate(np.abs(twin), size - size.mean(), 'valid')
    first = int(np.argmax(alike))
    return np.array([turn, twin[first : first + length]])
