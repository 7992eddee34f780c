# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Machines that share nothing with the twin: impacts that ring, their truth known."""

from bearing_twin.bearing import fault_frequencies, find_bearing
from bearing_twin.calibration.candidates.passage import contact_speed
import numpy as np
from scipy import signal

BEARING = find_bearing('6205')
RATE = 25600.0


def ring(x):
    """Let resonances at 3 and 7 kHz ring."""
    out = np.zeros_like(x)
    for hz, damping in ((3000.0, 0.03), (7000.0, 0.02)):
        pole = np.exp(2.0 * np.pi * hz / RATE * (-damping + 1j))
        out += signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)
    return out


def impact_train(width, place, shaft_hz, seed=0, noise=0.02, heights=(0.6, -1.0)):
    """
    Machine that shares nothing with the twin: two impacts a passage that ring at 3 and 7 kHz.

    They are as far apart as the slot is wide, m. The record has 4 s.
    """
    seconds, rng = 4.0, np.random.default_rng(seed)
    rate = fault_frequencies(BEARING, shaft_hz).impacts(place)
    gaps = (1.0 + 0.004 * rng.standard_normal(int(1.2 * rate * seconds))) / rate
    entries = np.cumsum(gaps)
    apart = width / contact_speed(BEARING, place, shaft_hz)
    x = np.zeros(int(seconds * RATE))
    for times, height in zip((entries, entries + apart), heights, strict=True):
        at = np.round(times[times < seconds - 1.0 / RATE] * RATE).astype(int)
        np.add.at(x, at, height * (1.0 + 0.2 * rng.standard_normal(len(at))))
    ringing = ring(x)
    return ringing + noise * ringing.std() * rng.standard_normal(len(x))
