# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The equations and the measures, against closed forms."""

from __future__ import annotations

import math

from bearing_twin.paper import equations, measures, settings
from bearing_twin.paper.equation_table import equation_table
from bearing_twin.paper.runs import RunSpec, simulate
import numpy as np
import pytest
from scipy.interpolate import CubicSpline


def test_fault_frequencies_of_the_paper():
    bearing, shaft = settings.BEARING, settings.SHAFT_HZ
    found = [
        equations.inner_frequency(bearing, shaft),
        equations.outer_frequency(bearing, shaft),
        equations.ball_frequency(bearing, shaft),
        equations.cage_frequency(bearing, shaft),
    ]
    assert found == pytest.approx([126.33739, 76.86261, 49.06854, 9.60783], abs=5e-6)
    assert found[0] + found[1] == pytest.approx(8 * 25.4)


def test_cage_speed_is_the_cage_frequency():
    omega = equations.cage_speed(2 * math.pi * 25.4, 14.0, 57.5)
    assert omega / (2 * math.pi) == pytest.approx(9.60783, abs=5e-6)


def test_strain_is_the_integral_of_a_linear_table():
    # By hand: trapezoids of 10 K over 5, 6, 7, 9, 9.5, 10, 12, 13, 15, 16.
    assert equations.alpha_strain(110.0) == pytest.approx(92.0 * 10 * 1e-5)
    assert equations.alpha_strain(25.0) == pytest.approx(5.0 * 5.25e-5)
    assert equations.expansion_term(110.0) == pytest.approx(0.0144)


def test_forces_are_the_gradient_of_the_contact_energy():
    theta = equations.ball_angles(8, 0.3)
    k_b, clearance, step = 1.2e10, 5e-6, 1e-9

    def energy(x, y):
        delta = np.maximum(equations.deformation_eq8(x, y, theta, clearance), 0.0)
        return 0.4 * k_b * (delta**2.5).sum()

    x, y = 4e-6, -20e-6
    force = equations.total_force(x, y, theta, clearance, k_b)
    gradient = (
        (energy(x + step, y) - energy(x - step, y)) / (2 * step),
        (energy(x, y + step) - energy(x, y - step)) / (2 * step),
    )
    assert force == pytest.approx(gradient, rel=1e-5)


def test_static_force_limits():
    assert equations.static_force(1.0, 1.0, 0.0) == 1.0
    assert equations.static_force(2.0, 1.0, 0.0) == 2.0
    assert equations.static_force(1.0, 1.0, 1.2) == 0.0
    assert equations.static_force(1.0, 2.0, 0.4) == pytest.approx(0.2**1.5)


def test_equation_table_is_complete():
    rows = equation_table()
    assert [row[0] for row in rows] == [str(number) for number in range(1, 26)]
    assert '126.33739 Hz' in rows[8][-1]
    forces = rows[6][-1]
    assert '3200.0 N' in forces.replace('-', ''), 'the balls carry the load of the preset'


def ringing(rate, seconds, impact_hz, shaft_hz):
    """Impulse responses at ``impact_hz``, modulated by the load zone."""
    time = np.arange(int(rate * seconds)) / rate
    signal = np.zeros_like(time)
    for k in range(int(seconds * impact_hz)):
        since = time - k / impact_hz
        height = max(math.cos(2 * math.pi * shaft_hz * k / impact_hz), 0.0)
        rows = (since >= 0) & (since < 0.02)
        signal[rows] += height * np.exp(-300 * since[rows]) * np.sin(5000 * since[rows])
    return time, signal


def test_line_frequency_of_a_known_signal():
    for impact_hz in (126.34, 126.58):
        _, signal = ringing(25600.0, 12.0, impact_hz, 25.4)
        found = measures.line_frequency(signal, 25600.0, 126.4)
        assert found == pytest.approx(impact_hz, abs=0.005)


def test_envelope_shows_the_impacts_not_the_carrier():
    _, signal = ringing(25600.0, 6.0, 126.34, 25.4)
    frequency, values = measures.envelope_spectrum(signal, 25600.0)
    line = measures.line_contrast(frequency, values, 126.34)
    assert line > 100.0
    assert line > 10.0 * measures.line_contrast(frequency, values, 76.9)


def test_spectrum_has_the_amplitude_of_a_sine():
    time = np.arange(10000) / 1000.0
    frequency, values = measures.spectrum(3.0 * np.sin(2 * np.pi * 50.0 * time) + 7.0, 1000.0)
    assert frequency[values.argmax()] == pytest.approx(50.0)
    assert values.max() == pytest.approx(3.0, rel=1e-3)


def test_peak_near():
    time = np.linspace(0.0, 1.0, 1001)
    signal = np.where(np.abs(time - 0.5) < 1e-6, -4.0, 0.0)
    instant, height = measures.peak_near(time, signal, 0.49, 0.02)
    assert instant == pytest.approx(0.5)
    assert height == pytest.approx(4.0, abs=0.01)


def test_record_starts_with_an_impact_under_the_load():
    record = simulate(RunSpec(preset='incipient', factor=None, temperature=20.0))
    assert 0.0 <= record.time[0] < 2.0 / record.rate
    assert record.time[-1] < settings.DURATION
    first, height = measures.peak_near(record.time, record.acceleration, 0.0, 0.5 / record.bpfi)
    assert first < 1.5e-3
    assert height > 0.8 * np.abs(record.acceleration).max()


def test_record_is_settled_from_its_first_sample():
    """D/d = 57.5/14, so 115 turns of the shaft are exactly 572 impacts, and the motion repeats."""
    period = 115 / settings.SHAFT_HZ
    record = simulate(RunSpec(preset='paper', factor=None, temperature=20.0, seconds=0.1 + period))
    assert record.bpfi * period == pytest.approx(572)
    n = int(0.09 * record.rate)
    late = CubicSpline(record.time, record.acceleration)(record.time[:n] + period)
    difference = np.linalg.norm(late - record.acceleration[:n])
    assert difference < 1e-3 * np.linalg.norm(record.acceleration[:n])
