# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Cage slip of the physical mode: limits, directions, and the makers' minimum load."""

from bearing_twin.bearing import find_bearing
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.dynamics.equations import coefficients
from bearing_twin.dynamics.limits import Limit
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.slip import HIGHEST_SLIP
import numpy as np
import pytest


def slip(load, rpm=1500.0, temperature=40.0, *, bearing='6307', **changes):
    """Cage slip with both rings at one temperature."""
    p = preset('paper', bearing=bearing, load=load, slip_model='traction', **changes)
    values = np.empty(coefficients.CONDITION_SIZE)
    constants = coefficients.constants_of(p)
    coefficients.evaluate(constants, temperature, temperature, rpm / 60.0, values)
    return float(values[coefficients.SLIP])


def minimum_load(bearing, k_r, rpm, temperature):
    """Against skidding, N: SKF, Rolling bearings (2013), 'Deep groove ball bearings'."""
    nu = Lubricant().viscosity(temperature) * 1e6
    size = find_bearing(bearing).mean_diameter / 0.1
    return 1e3 * k_r * (nu * rpm / 1000.0) ** (2.0 / 3.0) * size**2


def load_at(wanted, rpm, temperature):
    """Load at which the slip is what is wanted, N."""
    low, high = 10.0, 20e3
    for _ in range(50):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if slip(middle, rpm, temperature) > wanted else (low, middle)
    return low


@pytest.mark.parametrize(('bearing', 'k_r'), [('6203', 0.025), ('6205', 0.025), ('6307', 0.03)])
@pytest.mark.parametrize('rpm', [1500.0, 3000.0, 6000.0])
@pytest.mark.parametrize('temperature', [30.0, 50.0])
def test_balls_begin_to_skid_about_the_makers_minimum_load(bearing, k_r, rpm, temperature):
    """On a full film: between half and twice that load the slip goes through one per cent."""
    least = minimum_load(bearing, k_r, rpm, temperature)
    assert slip(0.5 * least, rpm, temperature, bearing=bearing) > 0.01
    assert slip(2.0 * least, rpm, temperature, bearing=bearing) < 0.01
    assert slip(4.0 * least, rpm, temperature, bearing=bearing) < 0.001


def test_a_loaded_bearing_hardly_slips():
    """Line frequencies of loaded bearings are those of pure rolling to some tenths of 1 %."""
    rated = 0.1 * 33e3
    found = [slip(rated, rpm, t) for rpm in (300.0, 1500.0, 3000.0) for t in (20.0, 60.0, 110.0)]
    assert 0.0 < min(found) < max(found) < 1e-4


def test_slip_falls_with_load_and_rises_with_speed():
    for temperature in (20.0, 60.0, 110.0):
        by_load = [slip(load, 1500.0, temperature) for load in np.geomspace(300.0, 10e3, 12)]
        assert (np.diff(by_load) < 0.0).all()
    by_speed = [slip(1000.0, rpm) for rpm in np.geomspace(100.0, 20e3, 12)]
    assert (np.diff(by_speed) > 0.0).all()


def test_a_thicker_oil_needs_more_load():
    loads = [load_at(0.99 * HIGHEST_SLIP, 6000.0, t) for t in (20.0, 30.0, 40.0, 50.0, 60.0)]
    assert (np.diff(loads) < 0.0).all()


def test_metallic_contact_holds_where_the_film_ends():
    assert slip(500.0, temperature=110.0) < 0.1 * slip(500.0, temperature=60.0)


def test_without_speed_there_is_no_slip_and_without_load_the_balls_skid():
    assert slip(500.0, rpm=0.0) == 0.0
    assert slip(500.0, rpm=1e-3) < 1e-6
    assert slip(10.0, rpm=3000.0, temperature=20.0) == HIGHEST_SLIP


def test_each_mode_has_a_law_of_its_own():
    assert preset('paper').slip_law == 'mu_proportional'
    physical = preset('paper', thermal_mode='physical')
    assert physical.slip_law == 'traction'
    hot = Simulator(physical, temperature=60.0).condition()
    assert hot.slip < 2e-4
    assert hot.limits_passed == Limit(0)
    asked = preset('paper', thermal_mode='physical', slip_model='mu_proportional')
    assert Simulator(asked, temperature=60.0).condition().slip == pytest.approx(0.00132, rel=0.01)


def test_skidding_is_said():
    light = preset('paper', thermal_mode='physical', load=50.0)
    said = Simulator(light, shaft_hz=50.0, temperature=20.0).condition()
    assert said.limits_passed == Limit.SKIDDING
    assert 'a load of 50 N is too small at 50 Hz' in said.warnings[0]
    assert said.ftf == pytest.approx(0.95 * 50.0 * 0.5 * (1.0 - 14.0 / 57.5))
