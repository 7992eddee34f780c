# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import math

from bearing_twin.bearing import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal import friction, gcr15, life, lubricant, rings
import pytest
from scipy.integrate import solve_ivp

RPM = 1524.0


def test_tables_at_and_between_their_nodes():
    assert gcr15.alpha(20.0) == pytest.approx(5e-5)
    assert gcr15.alpha(110.0, 1e-6) == pytest.approx(16e-6)
    assert gcr15.hardness(65.0) == pytest.approx(63.75)
    assert gcr15.friction(75.0) == pytest.approx(0.05375)


@pytest.mark.parametrize('temperature', [19.99, 110.01, math.nan, math.inf, -math.inf])
def test_outside_the_tables_is_refused(temperature):
    for law in (gcr15.alpha, gcr15.hardness, gcr15.friction, gcr15.Beta0().at):
        with pytest.raises(BearingTwinError, match=r'20\.\.110'):
            law(temperature)


def test_beta0():
    at = gcr15.Beta0().at
    got = [at(t) for t in (20.0, 40.0, 80.0, 100.0, 110.0)]
    assert got == pytest.approx([1.00550, 1.00233, 1.09484, 1.12221, 1.12985], abs=5e-6)


def test_beta0_terms_add_and_switch_off():
    only = {
        name: gcr15.Beta0(
            **{other: other == name for other in ('expansion', 'hardness', 'friction')}
        )
        for name in ('expansion', 'hardness', 'friction')
    }
    for temperature in (20.0, 55.0, 110.0):
        total = sum(term.at(temperature) - 1.0 for term in only.values())
        assert gcr15.Beta0().at(temperature) - 1.0 == pytest.approx(total, abs=1e-15)
    nothing = gcr15.Beta0(expansion=False, hardness=False, friction=False)
    assert nothing.at(87.0) == 1.0


@pytest.mark.parametrize('settings', [{'delta_mu': 0.1}, {'delta_h': -1.0}, {'alpha_unit': 1e-4}])
def test_beta0_outside_its_validity_is_refused(settings):
    with pytest.raises(BearingTwinError):
        gcr15.Beta0(**settings)


def test_viscosity_goes_through_both_given_points():
    oil = lubricant.Lubricant()
    assert oil.viscosity(40.0) == pytest.approx(68e-6, rel=1e-12)
    assert oil.viscosity(100.0) == pytest.approx(8.7e-6, rel=1e-12)


def test_kappa_of_vg68_on_the_6307():
    oil, pitch = lubricant.Lubricant(), find_bearing('6307').d_pitch
    kappa = [oil.viscosity(t) / lubricant.rated_viscosity(RPM, pitch) for t in (40.0, 80.0, 110.0)]
    assert kappa == pytest.approx([4.47, 0.97, 0.46], abs=0.01)
    assert lubricant.rated_viscosity(0.0, pitch) == math.inf


def test_rated_viscosity_joins_at_1000_rpm():
    below, above = (lubricant.rated_viscosity(n, 0.05) for n in (999.999, 1000.0))
    assert below == pytest.approx(above, rel=0.03)


def test_sliding_friction_goes_from_boundary_to_film():
    def slid(nu):
        return friction.sliding_friction(RPM, nu, 0.0575, 0.12, 0.05)

    assert slid(1e-9) == pytest.approx(0.12, rel=1e-3)
    assert slid(1e-3) == pytest.approx(0.05, rel=1e-3)
    assert slid(6.96e-6) == pytest.approx(0.087, abs=1e-3)


def test_friction_moment_of_the_6307():
    bearing = find_bearing('6307')
    nu = lubricant.Lubricant().viscosity(110.0)
    mu = friction.sliding_friction(RPM, nu, bearing.d_pitch, 0.12, 0.05)
    moment = friction.friction_moment(
        RPM, nu, 500.0, bearing.d_pitch, bearing.d_ball, *friction.SERIES['63'], 3e-8, mu
    )
    assert moment == pytest.approx(10e-3, rel=0.05)
    assert friction.power_loss(moment, RPM) == pytest.approx(
        1.05e-4 * moment * 1e3 * RPM, rel=0.01
    )


def test_clearance_closes_by_7_um_for_10_kelvin():
    change = rings.clearance_change(30.0, 20.0, 20.0, 0.0575, 0.014)
    assert 2.0 * change == pytest.approx(-6.9e-6, abs=1e-7)
    assert rings.clearance_change(80.0, 80.0, 20.0, 0.0575, 0.014) == pytest.approx(0.0, abs=1e-18)


def test_inner_ring_step_is_the_exact_solution():
    network, outer, power = rings.ThermalNetwork(), 60.0, 5.0
    target = rings.inner_ring_target(
        outer, network.shaft(outer), power, network.ring_to_ring, network.ring_to_shaft
    )
    got = rings.inner_ring_step(
        20.0, target, 7.0, network.inner_capacity, network.ring_to_ring, network.ring_to_shaft
    )

    def rate(_, t):
        flow = 0.5 * power - network.ring_to_ring * (t - outer)
        return (flow - network.ring_to_shaft * (t - network.shaft(outer))) / network.inner_capacity

    expected = solve_ivp(rate, (0.0, 7.0), [20.0], rtol=1e-10, atol=1e-10).y[0, -1]
    assert got == pytest.approx(expected, rel=1e-7)


def test_self_heating_needs_no_unexplained_heat():
    network = rings.ThermalNetwork(ambient=25.0)
    inner, outer = network.self_heated(6.0)
    assert inner > 25.0
    assert network.unexplained_heat(inner, outer, 0.0, 6.0) == pytest.approx(0.0, abs=1e-12)
    cold_shaft = rings.inner_ring_target(outer, 25.0, 6.0, network.ring_to_ring, 8.0)
    assert inner == pytest.approx(cold_shaft)


@pytest.mark.parametrize(
    ('name', 'dynamic', 'static'),
    [('6307-catalogue', 33.4e3, 19.2e3), ('6205', 14.0e3, 7.85e3), ('6203', 9.55e3, 4.8e3)],
)
def test_ratings_are_those_of_the_catalogues(name, dynamic, static):
    bearing = find_bearing(name)
    assert life.dynamic_rating(bearing) == pytest.approx(dynamic, rel=0.01)
    assert life.static_rating(bearing) == pytest.approx(static, rel=0.01)


def test_life_factor():
    load = 0.5 * 815.0 / 3000.0
    oil, pitch = lubricant.Lubricant(), find_bearing('6307').d_pitch
    rated = lubricant.rated_viscosity(RPM, pitch)
    assert life.life_factor(oil.viscosity(20.0) / rated, load) == pytest.approx(13.2, abs=0.1)
    assert life.life_factor(oil.viscosity(110.0) / rated, load) == pytest.approx(0.51, abs=0.01)
    assert life.life_factor(4.0, 100.0) == 50.0
    # The standard's three ranges meet.
    for limit in (0.4, 1.0):
        below, above = (life.life_factor(limit * f, load) for f in (1.0 - 1e-9, 1.0))
        assert below == pytest.approx(above, rel=0.01)
    assert life.life_hours(1.0, 1000.0, 0.0, 1e4) == math.inf
    assert life.life_hours(1.0, 1000.0, 1000.0 / 60.0, 1e4) == pytest.approx(1e6)
