# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration of a machine beside its bearing: shaft, gears, mains, shocks, pulses, flow noise."""

from __future__ import annotations

import math

from bearing_twin.bearing import PLACES
import numpy as np
from numpy.typing import NDArray
from scipy import signal

CONDITIONS = ('none', *PLACES)
"""True conditions of the bearings of a study."""

_DECAY, _RING_S = 400.0, 0.02
"""Decay of a shock, 1/s, and its length, s."""

MACHINES = ('quiet', 'shaft', 'gear', 'mains', 'modulated', 'impulses')
"""Machines of :func:`disturbance`, besides ``'pulses'`` and ``'impacts'``."""


def disturbance(
    machine: str, turns: NDArray[np.float64], sample_rate: float, rng: np.random.Generator
) -> NDArray[np.float64]:
    """
    Return the vibration that a machine adds to that of its bearing, without a unit, shape (n,).

    ``turns`` are the turns of the shaft since the beginning, at each sample, shape (n,). A
    ``'quiet'`` machine adds zeros.
    """
    n = len(turns)
    t = np.arange(n) / sample_rate
    shaft = 2.0 * np.pi * turns
    mean_hz = float(turns[-1]) / (n - 1) * sample_rate

    def tone(angle: NDArray[np.float64], depth: float = 0.0) -> NDArray[np.float64]:
        swing = 1.0 + depth * np.cos(shaft + rng.uniform(0.0, 6.3))
        wave = np.sin(angle + rng.uniform(0.0, 6.3))
        return np.asarray(rng.exponential() * swing * wave)

    nyquist = 0.45 * sample_rate
    if machine == 'shaft':
        # Unbalance, misalignment and looseness: many harmonics, halves among them.
        step = shaft * float(rng.choice((0.5, 1.0)))
        return np.asarray(np.sum([tone(k * step) / np.sqrt(k) for k in range(1, 40)], axis=0))
    if machine == 'gear':
        # Two meshes, one of them on another shaft, whose speed is no multiple of this one's.
        meshes = (int(rng.integers(13, 60)), float(rng.uniform(13.0, 60.0)))
        orders = [k * mesh for mesh in meshes for k in (1, 2, 3)]
        return np.asarray(
            sum(
                (tone(order * shaft, 0.7) for order in orders if order * mean_hz < nyquist),
                start=np.zeros(n),
            )
        )
    if machine == 'mains':
        stray = rng.uniform(10.0, nyquist, 20)
        hum = float(rng.choice((50.0, 60.0)))
        lines = (*(hum * np.arange(1, 20)), *stray)
        return np.asarray(np.sum([tone(2.0 * np.pi * hertz * t) for hertz in lines], axis=0))
    if machine == 'modulated':
        # Noise of a flow or a seal, modulated once per turn.
        swell = 1.0 + 0.8 * np.cos(shaft + rng.uniform(0.0, 6.3))
        return np.asarray(swell * rng.standard_normal(n))
    if machine == 'impulses':
        # Single shocks at random times; each rings at a natural frequency.
        shocks = np.zeros(n)
        count = rng.poisson(4.0 * n / sample_rate) + 1
        shocks[rng.integers(0, n, count)] = rng.standard_normal(count)
        return _ringing(shocks, t, 0.15 * sample_rate)
    if machine == 'impacts':
        # A broken tooth, a joint of a belt, a blade that rubs: at any order, or once a turn.
        order = float(rng.choice((1.0, 10.0 ** rng.uniform(-0.7, 1.1))))
        shocks = np.zeros(n)
        at = np.searchsorted(turns, np.arange(rng.uniform() / order, turns[-1], 1.0 / order))
        shocks[at] = 1.0 + 0.3 * rng.standard_normal(len(at))
        return _ringing(shocks, t, float(rng.uniform(0.08, 0.4)) * sample_rate)
    if machine == 'pulses':
        # A converter: single spikes, and two pulses per period of the mains.
        spikes = np.zeros(n)
        count = rng.poisson(5.0 * n / sample_rate) + 1
        spikes[rng.integers(0, n, count)] = 20.0 * rng.standard_normal(count)
        if rng.random() < 0.5:
            hum = float(rng.choice((50.0, 60.0)))
            at = (np.arange(0.0, t[-1], 0.5 / hum) * sample_rate).astype(int)
            spikes[at] += 3.0 + rng.standard_normal(len(at))
        return spikes
    return np.zeros(n)


def _ringing(
    shocks: NDArray[np.float64], t: NDArray[np.float64], natural_hz: float
) -> NDArray[np.float64]:
    """Pass shocks through one resonance."""
    tail = t[t < _RING_S]
    ring = np.exp(-_DECAY * tail) * np.sin(2.0 * np.pi * natural_hz * tail)
    return np.asarray(signal.oaconvolve(shocks, ring)[: len(shocks)])


def with_memory(noise: NDArray[np.float64], memory: float) -> NDArray[np.float64]:
    """
    Correlate white noise over ``memory`` samples along its first axis; its scatter stays.

    The scatter is less at the beginning, for a few times ``memory`` samples.
    """
    keep = math.exp(-1.0 / memory)
    return np.asarray(signal.lfilter([math.sqrt(1.0 - keep**2)], [1.0, -keep], noise, axis=0))
