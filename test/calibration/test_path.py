# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The path from the bearing to the sensor: resonances, floor, filter."""

import json
import math

from bearing_twin.calibration.measured.path import identify, noise_floor, resonances
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.dynamics.equations.sensor_path import band_levels, distance, SensorPath
from impact_trains import BEARING, impact_train, RATE, ring
import numpy as np
import pytest


def twin(**options):
    """Vibration of a twin that the fit is not told."""
    parameters = preset('incipient', bearing=BEARING, **options)
    simulator = Simulator(parameters, sample_rate=RATE, seed=3, shaft_hz=20.0)
    simulator.advance(int(0.3 * RATE), 30.0, 20.0)
    return simulator.advance(int(2.0 * RATE), 30.0, 20.0).y.astype(float)


def test_twin_through_its_path_passes_for_the_machine():
    machine = impact_train(1e-3, 'outer', 20.0, seed=5)
    model = twin(defect='outer', noise=0.0, resonance_hz=0.0)
    path = identify(machine, RATE, model, 0.05)
    fitted = path.filter().apply(model)[2560:]
    assert distance(band_levels(machine, RATE), band_levels(fitted, RATE)) < 2.0
    assert 20.0 * math.log10(fitted.std() / machine.std()) == pytest.approx(0.0, abs=0.5)


def test_a_path_in_blocks_is_the_path_in_one():
    path = identify(impact_train(1e-3, 'outer', 20.0), RATE, twin(noise=0.0), 0.05)
    again = SensorPath.from_dict(json.loads(json.dumps(path.to_dict())))
    x = np.random.default_rng(2).standard_normal(3000)
    whole = path.filter(seed=4).apply(x)
    running = again.filter(seed=4)
    parts = np.concatenate([running.apply(part) for part in np.split(x, [1000, 1700])])
    assert np.array_equal(whole, parts)


def test_resonances_are_found():
    found = resonances(ring(np.random.default_rng(1).standard_normal(102400)), RATE)
    near = {round(mode.hz, -2): mode for mode in found[:2]}
    for hz, damping in ((3000.0, 0.03), (7000.0, 0.02)):
        assert near[hz].damping == pytest.approx(damping, rel=0.15)


def test_the_floor_of_a_sensor_is_found():
    """The quietest frequencies of the same samples would be the luckiest."""
    held, medians = 0, []
    for seed in range(60):
        noise = np.random.default_rng(seed).standard_normal(51200)
        low, median, high = noise_floor(noise, RATE)
        held += low < math.sqrt(2.0 / RATE) < high
        medians.append(median)
    assert held >= 48
    assert np.mean(medians) == pytest.approx(math.sqrt(2.0 / RATE), rel=1e-2)
