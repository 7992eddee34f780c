# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Candidate machines: draw the unknown quantities at random and simulate the vibration."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
import functools
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, find_bearing, radial_factor
from bearing_twin.calibration.candidates.passage import contact_speed, load_range
from bearing_twin.calibration.measured.summaries import summarise, Summary
from bearing_twin.dynamics import Defect, Fleet, TwinParameters
from bearing_twin.dynamics.parameters import widest
from bearing_twin.thermal.gcr15 import TABLE_HIGH, TABLE_LOW
from bearing_twin.thermal.network import clearance_limits
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


FloatArray = npt.NDArray[np.float64]

LEAST_RATE, FASTEST_HZ = 2000.0, 500.0
"""Lowest sample rate and highest shaft speed of a record, Hz; the diagnosis has its own limits."""
MOST_SLIP = 0.05
"""Largest slip that is accepted from the diagnosis."""
HIGHEST_RATE = 52e3
"""Highest sample rate at which candidates are simulated, Hz; faster records are decimated."""
IMPACTS, FEWEST = 24.0, 12.0
"""Passages simulated of each candidate, and the fewest if 24 last longer than a second. A fit then
takes up to ten seconds of a core. Chance moves the spacing of 12 passages by a fifth of its unit
in `posterior.features`."""
MOST_S, LEAST_CANDIDATES = 384.0, 96
"""Longest vibration simulated in a round over all candidates, s, and the fewest candidates. Two
rounds take 8 s of a core at 51.2 kHz. With 96 candidates instead of 384 the 90 % intervals of 20
trains of impacts and bilinear contacts are as wide and hold as often; medians move by 2 %."""
SETTLE_S = 0.1
TEMPERATURE = 30.0
"""Temperature of the outer ring if none is given, degC."""
LONGEST_BLOCK = 1 << 20
"""Most samples that a fleet simulates in one call."""
_BATCH = 128
"""Candidates simulated together: 100 MB at 52 kHz and 1 s."""


@dataclass(frozen=True, kw_only=True)
class Situation:
    """Known conditions of a machine during a measurement."""

    bearing: Bearing
    place: str
    """Part of the bearing with the defect, or 'none'."""
    shaft_hz: float
    sample_rate: float
    temperature: float = TEMPERATURE
    load: tuple[float, float] | None = None
    """Range of the radial load, N; None: see `passage.load_range`."""
    slip: float = 0.0

    @functools.cached_property
    def stiffness(self) -> float:
        """Hertz stiffness of the bearing, which all candidates share, N/m^1.5."""
        return radial_factor(self.bearing)

    @property
    def speed(self) -> float:
        """Speed of the contact along the damaged race, m/s."""
        return contact_speed(self.bearing, self.place, self.shaft_hz, self.slip)

    @property
    def impact_rate(self) -> float:
        """Balls that pass the defect per second."""
        return fault_frequencies(self.bearing, self.shaft_hz, self.slip).impacts(self.place)

    @property
    def ball_spacing_mm(self) -> float:
        """
        Distance of two balls on the damaged race, mm.

        >>> round(example().ball_spacing_mm, 1)
        16.4

        """
        return 1e3 * self.speed / self.impact_rate

    @property
    def longest_spacing(self) -> float:
        """Longest time between two impacts of a passage, s."""
        return 1.1 * widest(self.bearing) / self.speed


def example(place: str = 'outer') -> Situation:
    """
    Return the machine of the examples: a 6205 at 25 Hz, sampled at 12.8 kHz.

    >>> round(example('outer').impact_rate, 1)
    89.6

    """
    return Situation(bearing=find_bearing('6205'), place=place, shaft_hz=25.0, sample_rate=12800.0)


@dataclass(frozen=True)
class Unknown:
    """Prior of an unknown quantity: uniform over its range or over its logarithm."""

    low: float
    high: float
    unit: str
    logarithmic: bool = False

    def place(self, share: npt.ArrayLike) -> FloatArray:
        """Return the values at shares of the range, linear or logarithmic."""
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** np.asarray(share))
        return np.asarray(self.low + (self.high - self.low) * np.asarray(share))

    def share(self, value: npt.ArrayLike) -> FloatArray:
        """Inverse of :meth:`place`."""
        if self.logarithmic:
            span = math.log(self.high / self.low) or 1.0
            return np.asarray(np.log(np.asarray(value) / self.low) / span)
        return np.asarray((np.asarray(value) - self.low) / ((self.high - self.low) or 1.0))


def unknowns(situation: Situation) -> dict[str, Unknown]:
    """
    Return the unknown quantities of a machine with a defect, with their ranges.

    Examples
    --------
    >>> machine = example()
    >>> unknowns(machine)['defect_depth_um']
    Unknown(low=5.0, high=500.0, unit='um', logarithmic=True)

    """
    low, high = load_range(situation.bearing, situation.load)
    # The model allows a small bearing less. Heat does not close any bearing beyond its limits.
    loosest = min(12.0, 1e6 * clearance_limits(situation.bearing.d_pitch)[1])
    ranges = {
        'defect_width_mm': Unknown(0.1, 1e3 * widest(situation.bearing), 'mm'),
        'load': Unknown(low, high, 'N', logarithmic=True),
        'defect_depth_um': Unknown(5.0, 500.0, 'um', logarithmic=True),
        'clearance_um': Unknown(0.0, loosest, 'um'),
        'contact_damping': Unknown(50.0, 1500.0, 'N s/m', logarithmic=True),
        'inner_mass': Unknown(1.5, 20.0, 'kg', logarithmic=True),
        'jitter': Unknown(0.001, 0.02, '', logarithmic=True),
        'noise_ratio': Unknown(1e-3, 0.3, '', logarithmic=True),
    }
    if situation.place == 'outer':
        ranges['defect_angle'] = Unknown(-0.7, 0.7, 'rad')
    return ranges


def parameters(situation: Situation, values: dict[str, float]) -> TwinParameters:
    """
    Return the twin of one candidate, without noise and resonance of the sensor's path.

    Its surfaces have no waviness: vibration from waviness counts as noise, `noise_ratio`.

    Examples
    --------
    >>> machine = example()
    >>> middle = {name: float(u.place(0.5)) for name, u in unknowns(machine).items()}
    >>> twin = parameters(machine, middle)
    >>> twin.defects[0].place, round(1e3 * twin.defects[0].width, 2)
    ('outer', 2.04)

    """
    defects: tuple[Defect, ...] = ()
    place: Any = situation.place
    if place != 'none':
        angle = values.get('defect_angle', 0.0)
        defects = (
            Defect(
                place=place,
                width=1e-3 * values['defect_width_mm'],
                depth=1e-6 * values['defect_depth_um'],
                angle=angle - 0.5 * math.pi if place == 'outer' else angle,
            ),
        )
    return TwinParameters(
        bearing=situation.bearing,
        thermal_mode='physical',
        defects=defects,
        load=values['load'],
        clearance=1e-6 * values['clearance_um'],
        hertz_stiffness=situation.stiffness,
        contact_damping=values['contact_damping'],
        inner_mass=values['inner_mass'],
        slip_model='constant',
        slip=max(situation.slip, 0.0),
        jitter=values['jitter'],
        noise=0.0,
        resonance_hz=0.0,
        waviness=0.0,
    )


def vibrations(
    situation: Situation, values: dict[str, FloatArray], seconds: float, seed: int
) -> Iterator[FloatArray]:
    """
    Yield the housing's acceleration of the candidates in batches, m/s^2, shape (batch, n).

    It contains sensor noise of `noise_ratio` times each candidate's own RMS.

    >>> machine = example()
    >>> drawn = {name: u.place([0.4, 0.6]) for name, u in unknowns(machine).items()}
    >>> [batch.shape for batch in vibrations(machine, drawn, 0.1, 0)]
    [(2, 1280)]

    """
    count = len(values['load'])
    rng = np.random.default_rng([seed, 1])
    rate, hz = situation.sample_rate, situation.shaft_hz
    # Clip to the range of the steel's tables, as the twin's gate does.
    temperature = float(np.clip(situation.temperature, TABLE_LOW, TABLE_HIGH))
    n = int(seconds * rate)
    size = max(1, min(_BATCH, int(_BATCH * HIGHEST_RATE / n)))
    for first in range(0, count, size):
        batch = range(first, min(first + size, count))
        fleet = Fleet(
            [parameters(situation, {k: float(v[i]) for k, v in values.items()}) for i in batch],
            sample_rate=rate,
            seeds=[int(s) for s in rng.integers(1 << 31, size=len(batch))],
            temperatures=temperature,
            shaft_hz=hz,
        )
        fleet.advance(int(SETTLE_S * rate), temperature, hz)
        parts = [min(LONGEST_BLOCK, n - done) for done in range(0, n, LONGEST_BLOCK)]
        x = np.concatenate(
            [fleet.advance(part, temperature, hz).y.astype(np.float64) for part in parts], axis=1
        )
        x -= x.mean(axis=1, keepdims=True)
        level = x.std(axis=1) * values['noise_ratio'][batch.start : batch.stop]
        yield x + level[:, None] * rng.standard_normal(x.shape)


def _seconds(situation: Situation) -> float:
    """Return the length of the vibration of each candidate, s."""
    return max(FEWEST, min(IMPACTS, situation.impact_rate)) / situation.impact_rate


def affordable(situation: Situation, candidates: int) -> int:
    """
    Return how many of the requested candidates are simulated: fewer at a slow shaft.

    Examples
    --------
    >>> machine = example()
    >>> from dataclasses import replace
    >>> [affordable(replace(machine, shaft_hz=hz), 384) for hz in (25.0, 2.0, 1.0, 0.5)]
    [384, 229, 114, 96]

    """
    most = max(LEAST_CANDIDATES, int(MOST_S / _seconds(situation)))
    return min(candidates, most)


def simulate(situation: Situation, values: dict[str, FloatArray], seed: int) -> list[Summary]:
    """
    Simulate candidates and summarise the vibration of each.

    ``values`` has one value per candidate for each of `unknowns`.

    Examples
    --------
    >>> machine = example()
    >>> drawn = {name: u.place([0.4, 0.6]) for name, u in unknowns(machine).items()}
    >>> len(simulate(machine, drawn, 0))
    2

    """
    return [
        summarise(x, situation.sample_rate, situation.longest_spacing)
        for batch in vibrations(situation, values, _seconds(situation), seed)
        for x in batch
    ]
