# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Random rigs whose bearings are trains of impacts; they share nothing with the twin.

Impacts with random slip (a random walk of their times), or noise modulated by them, pass through
random resonances (Antoni and Randall, J. Sound Vib. 2003, 265, 1059: fault signals of rolling
bearings have their cyclostationarity in common, not their shape).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
import math

from bearing_twin.bearing import Bearing, fault_orders
from bearing_twin.diagnosis.signal.demodulation import highest_fault_order
from bearing_twin.studies.disturbances import CONDITIONS, disturbance, MACHINES
import numpy as np
from numpy.typing import NDArray
from scipy import signal

SHAPES = ('point', 'double', 'extended')
"""One impact per pass; one at each edge of a spall; noise while the ball is on the spall."""


@dataclass(frozen=True)
class Rig:
    """Bearing, sampling and speed of a rig."""

    n_balls: int
    d_ball_mm: float
    d_pitch_mm: float
    contact_deg: float
    sample_rate: float
    """Hz."""
    shaft_hz: float
    seconds: float
    """Length of a record, s."""


SPEED_SHARE = 0.5
"""Share of the misled cases with a wrong speed; the others have a wrong bearing."""

ANOTHER = 0.012
"""Relative difference of a fault order from which on a bearing counts as another one."""

RIGS = {
    '6203 at 64 kHz, 15 Hz': Rig(8, 6.75, 28.55, 0.0, 64e3, 15.0, 4.0),
    '6203 at 64 kHz, 25 Hz': Rig(8, 6.75, 28.55, 0.0, 64e3, 25.0, 4.0),
    'UER204, 35 Hz, 1.28 s': Rig(8, 7.92, 34.55, 0.0, 25600.0, 35.0, 1.28),
    'UER204, 40 Hz, 1.28 s': Rig(8, 7.92, 34.55, 0.0, 25600.0, 40.0, 1.28),
    'ZA-2115, 1 s': Rig(16, 8.4074, 71.501, 15.17, 20480.0, 33.33, 1.0),
    'ER16K at 42 kHz': Rig(9, 7.94, 38.52, 0.0, 42e3, 24.0, 3.0),
    'ER16K at 200 kHz': Rig(9, 7.94, 38.52, 0.0, 200e3, 20.0, 3.0),
    '6205 at 5.12 kHz, 20 Hz': Rig(9, 7.94, 39.04, 0.0, 5120.0, 20.0, 8.0),
    '6205 at 5.12 kHz, 30 Hz': Rig(9, 7.94, 39.04, 0.0, 5120.0, 30.0, 4.0),
    '6205 at 48 kHz': Rig(9, 7.94, 39.04, 0.0, 48e3, 29.0, 4.0),
    '13 rollers at 50 kHz, 10 Hz': Rig(13, 6.5, 38.5, 0.0, 50e3, 10.0, 6.0),
    '13 rollers at 50 kHz, 17 Hz': Rig(13, 6.5, 38.5, 0.0, 50e3, 16.67, 6.0),
    '6309, 5 Hz, 12 s': Rig(9, 17.5, 78.5, 0.0, 12e3, 5.0, 12.0),
    '6309, 5 Hz, 6 s': Rig(9, 17.5, 78.5, 0.0, 25600.0, 5.0, 6.0),
    'spindle, 100 Hz': Rig(10, 9.0, 40.5, 0.0, 51200.0, 100.0, 4.0),
    'spindle, 300 Hz': Rig(10, 9.0, 40.5, 0.0, 51200.0, 300.0, 2.0),
    '6206 at 51.2 kHz': Rig(9, 9.525, 46.0, 0.0, 51200.0, 27.0, 4.0),
    'NICE at 97.656 kHz': Rig(8, 5.969, 31.623, 0.0, 97656.0, 25.0, 3.0),
    '6307 at 8 kHz': Rig(8, 13.494, 58.5, 0.0, 8e3, 15.0, 6.0),
    '6307 at 10 kHz': Rig(8, 13.494, 58.5, 0.0, 10e3, 20.0, 4.0),
    'tapered, 17 rollers': Rig(17, 12.0, 80.0, 12.0, 25600.0, 12.0, 6.0),
    'spherical, 20 rollers': Rig(20, 23.9, 180.0, 16.0, 20e3, 8.0, 10.0),
    '7206, 40 degrees': Rig(13, 9.5, 46.0, 40.0, 25600.0, 30.0, 3.0),
}


@dataclass(frozen=True, kw_only=True)
class Case:
    """One record of one rig."""

    rig: str
    condition: str
    machine: str
    shape: str
    shaft_hz: float
    given_hz: float
    """Speed given to the diagnosis, Hz, off by up to 2 %."""
    wander: float
    """Relative amplitude of a slow change of the speed."""
    slip: float
    jitter: float
    """Relative spread of the gaps between impacts."""
    depth: float
    """Depth of the modulation of the impacts by the load zone."""
    strength: float
    """RMS of the impacts over that of the noise."""
    disturbance: float
    """RMS of the machine's own vibration over that of the bearing."""
    counts: bool
    """Whether the samples are whole numbers, as of a 16 bit converter."""
    ripple: float
    """Relative amplitude by which sound parts of the bearing modulate its rolling noise."""
    axis_wander: float
    """Share of a damaged ball's impacts that are lost because its axis of spin wanders."""
    given_rig: str
    """Rig whose geometry is given to the diagnosis."""
    spalls: int
    """Spalls of the damaged part: one, or several if it is worn."""
    waves: float
    """RMS of the vibration by surface waviness, over that of the noise."""
    seed: int

    @property
    def sample_rate(self) -> float:
        """Sample rate, Hz."""
        return RIGS[self.rig].sample_rate

    @property
    def geometry(self) -> Bearing:
        """Geometry that is given to the diagnosis."""
        return _geometry(self.given_rig)


def is_another(bearing: Bearing, own: Bearing) -> bool:
    """Whether a fault order of a bearing differs by more than :data:`ANOTHER` from its own."""
    ratio = np.array(fault_orders(bearing)) / np.array(fault_orders(own))
    return bool(np.abs(ratio - 1.0).max() > ANOTHER)


def _geometry(name: str) -> Bearing:
    """Geometry of the bearing of a rig."""
    rig = RIGS[name]
    return Bearing(
        name=name,
        n_balls=rig.n_balls,
        d_ball=rig.d_ball_mm / 1e3,
        d_pitch=rig.d_pitch_mm / 1e3,
        contact_angle=math.radians(rig.contact_deg),
    )


def draw(number: int, *, misled: bool = False) -> Case:
    """
    Draw a case; a number is always the same case.

    If ``misled``, the diagnosis is given another bearing, or a speed that is 3 to 5 % off.
    """
    rng = np.random.default_rng([2027, number])
    name = list(RIGS)[number % len(RIGS)]
    condition = CONDITIONS[number // len(RIGS) % len(CONDITIONS)]
    shaft_hz = RIGS[name].shaft_hz * float(rng.uniform(0.97, 1.03))
    # An inner race and a ball pass through the load zone; an outer race stays where it is.
    depths = {'inner': (0.5, 1.5), 'ball': (0.3, 1.2)}
    case = Case(
        rig=name,
        condition=condition,
        machine=str(rng.choice((*MACHINES, 'pulses', 'impacts'))),
        shape=str(rng.choice(SHAPES)),
        shaft_hz=shaft_hz,
        given_hz=shaft_hz * float(rng.choice((1.0, rng.uniform(0.98, 1.02)))),
        wander=float(rng.choice((0.0, 0.0, 0.001, 0.003))),
        slip=float(rng.uniform(0.0, 0.025)),
        jitter=float(rng.choice((0.003, 0.008, 0.015))),
        depth=float(rng.uniform(*depths.get(condition, (0.0, 0.3)))),
        strength=float(10.0 ** rng.uniform(-0.9, 0.3)),
        disturbance=float(10.0 ** rng.uniform(-1.0, 0.3)),
        counts=bool(rng.integers(2)),
        seed=number,
        ripple=float(10.0 ** rng.uniform(-2.3, -0.8)),
        axis_wander=float(rng.choice((0.0, rng.uniform(0.3, 1.0)))),
        given_rig=name,
        spalls=int(rng.choice((1, 1, 1, 1, int(rng.integers(2, 9))))),
        waves=float(rng.choice((0.0, 10.0 ** rng.uniform(-1.5, 0.3)))),
    )
    if not misled:
        return case
    if rng.random() < SPEED_SHARE:
        off = float(rng.choice((-1.0, 1.0)) * rng.uniform(0.03, 0.05))
        return replace(case, given_hz=case.shaft_hz * (1.0 + off))
    others = [
        rig
        for rig in RIGS
        if is_another(_geometry(rig), case.geometry)
        and 8.0 * highest_fault_order(_geometry(rig)) * shaft_hz < case.sample_rate
    ]
    return replace(case, given_rig=str(rng.choice(others))) if others else case


def _resonate(
    x: NDArray[np.float64], sample_rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Pass a signal through two to four random resonances."""
    out = np.zeros(len(x))
    for _ in range(rng.integers(2, 5)):
        omega = 2.0 * np.pi * rng.uniform(0.06, 0.42)
        decay = rng.uniform(0.01, 0.06) * omega
        t = np.arange(int(min(6.0 / decay, 0.05 * sample_rate)) + 2)
        ring = np.exp(-decay * t) * np.sin(omega * t + rng.uniform(0.0, 6.3))
        gain = rng.uniform(0.3, 1.0) / np.sqrt((ring * ring).sum())
        out += gain * signal.oaconvolve(x, ring)[: len(x)]
    return out


def _impacts(
    case: Case, turns: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return impacts or modulated noise of the fault before any resonance, shape of ``turns``."""
    orders = fault_orders(_geometry(case.rig), case.slip)
    order = orders.impacts(case.condition)
    gaps = (1.0 + case.jitter * rng.standard_normal(int(1.2 * order * turns[-1]) + 10)) / order
    if case.condition == 'ball':
        # The faster the axis moves, the more irregular are the times of the impacts.
        gaps *= 1.0 + 0.05 * case.axis_wander * rng.standard_normal(len(gaps))
    places = np.cumsum(gaps) + rng.uniform()
    if case.spalls > 1:
        places = np.sort(np.add.outer(places, rng.uniform(0.0, 1.0 / order, case.spalls)).ravel())
    places = places[places < turns[-1] - 1.0 / order]
    swing = 2.0 * np.pi * (orders.ftf if case.condition == 'ball' else 1.0)
    phase = rng.uniform(0.0, 6.3)
    x = np.zeros(len(turns))
    if case.shape == 'extended':
        since = turns - np.concatenate(([np.inf], places))[np.searchsorted(places, turns)]
        on_spall = (since >= 0.0) & (since * order < rng.uniform(0.1, 0.35))
        height = np.maximum(1.0 + case.depth * np.cos(swing * turns + phase), 0.0)
        return np.asarray(on_spall * height * rng.standard_normal(len(turns)))
    height = np.maximum(1.0 + case.depth * np.cos(swing * places + phase), 0.0)
    height *= 1.0 + 0.25 * rng.standard_normal(len(places))
    if case.condition == 'ball':
        # Inner and outer race in turn; one of them may be farther from the sensor.
        height[::2] *= rng.uniform(0.5, 1.0)
        height *= 1.0 - case.axis_wander * _hidden(places * orders.ftf, rng)
    at = np.searchsorted(turns, places)
    x[at] += height
    if case.shape == 'double':
        leaving = np.searchsorted(turns, places + rng.uniform(0.03, 0.12) / order)
        x[leaving] -= rng.uniform(0.5, 1.5) * height
    return x


def _hidden(cage_turns: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """
    Return the share of a ball's spall that lies beside the races at each impact.

    The axis of spin wanders within some turns of the cage, so that the spall leaves the races and
    returns (Smith and Randall, Mech. Syst. Signal Process. 2015, 64, 100: therefore ball faults
    are the hardest to detect).
    """
    knots = np.arange(0.0, cage_turns[-1] + 12.0, 3.0)
    slow = np.interp(cage_turns, knots, rng.uniform(-0.5, 1.5, len(knots)))
    return np.asarray(np.clip(slow, 0.0, 1.0))


def _ripple(
    case: Case, turns: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """
    Return the modulation of the rolling noise by sound parts, shape of ``turns``.

    The load on a contact varies as balls pass it, as the waves of the races pass the balls, with
    the unbalance, and with the largest ball (Harris and Kotzalas, Advanced Concepts of Bearing
    Technology, 2007, chapter 8). Noise follows the load smoothly: one harmonic each, or two.
    """
    orders = fault_orders(_geometry(case.rig), case.slip)
    smooth = np.array([orders.bpfo, 2.0 * orders.bpfo, orders.bpfi, orders.impacts('ball'),
                       orders.ftf, 1.0, 2.0])  # fmt: skip
    heights = case.ripple * rng.uniform(0.0, 1.0, len(smooth))
    phases = rng.uniform(0.0, 2.0 * np.pi, len(smooth))
    ripple = np.zeros(len(turns))
    for order, height, phase in zip(smooth, heights, phases, strict=True):
        ripple += height * np.cos(2.0 * np.pi * order * turns + phase)
    return ripple


def _waves(
    case: Case, turns: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """
    Return the force by waviness of both races and a ball: lines at the multiples of their orders.

    The profiles are random (Wensing, On the dynamics of ball bearings, Twente 1998), so that their
    lines have random phases. Lines of parts that turn through the load zone have sidebands.
    """
    orders = fault_orders(_geometry(case.rig), case.slip)
    force = np.zeros(len(turns))
    parts = ((orders.bpfo, 0.0), (orders.bpfi, 1.0), (orders.impacts('ball'), orders.ftf))
    for order, through in parts:
        lines = np.arange(1, 257) ** -0.5 * np.exp(2j * np.pi * rng.uniform(size=256))
        profile = np.fft.irfft(np.concatenate(([0.0], lines)), 2048)
        passed = np.interp(order * turns % 1.0 * 2048.0, np.arange(2048), profile, period=2048.0)
        load = 1.0 + 0.7 * bool(through) * np.cos(2.0 * np.pi * through * turns)
        force += rng.uniform(0.3, 1.0) * load * passed / profile.std()
    return force


def record(case: Case) -> NDArray[np.float64]:
    """Return the samples of a case, in an unknown unit, with an offset."""
    rng = np.random.default_rng([case.seed, 3])
    rate = case.sample_rate
    n = int(rate * RIGS[case.rig].seconds)
    slow = 2.0 * np.pi * rng.uniform(0.1, 0.5) * np.arange(n) / rate
    speed = case.shaft_hz * (1.0 + case.wander * np.sin(slow + rng.uniform(0.0, 6.3)))
    turns = np.cumsum(speed) / rate
    x = rng.standard_normal(n)
    if rng.random() < 0.6:
        x += rng.uniform(0.3, 3.0) * _resonate(rng.standard_normal(n), rate, rng)
    x *= 1.0 + _ripple(case, turns, rng)
    x /= x.std()
    if case.waves:
        waves = _resonate(_waves(case, turns, rng), rate, rng)
        x += case.waves * waves / waves.std()
    if case.condition != 'none':
        impacts = _resonate(_impacts(case, turns, rng), rate, rng)
        x += case.strength * impacts / impacts.std()
    if case.machine != 'quiet':
        other = disturbance(case.machine, turns, rate, rng)
        x += case.disturbance * x.std() / other.std() * other
    x += rng.uniform(-5.0, 5.0) * x.std()
    if case.counts:
        x = np.round(x * (rng.uniform(300.0, 32_000.0) / np.abs(x).max()))
    return x
