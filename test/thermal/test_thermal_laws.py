# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace
import math

from bearing_twin.bearing import Bearing, find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal import friction, gcr15, life, lubricant, network
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

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
        metallic = friction.metallic_share(RPM, nu, 0.0575)
        return friction.sliding_friction(metallic, 0.12, 0.05)

    assert slid(1e-9) == pytest.approx(0.12, rel=1e-3)
    assert slid(1e-3) == pytest.approx(0.05, rel=1e-3)
    assert slid(6.96e-6) == pytest.approx(0.087, abs=1e-3)


def test_friction_moment_of_the_6307():
    bearing = find_bearing('6307')
    nu = lubricant.Lubricant().viscosity(110.0)
    metallic = friction.metallic_share(RPM, nu, bearing.d_pitch)
    mu = friction.sliding_friction(metallic, 0.12, 0.05)
    moment = friction.friction_moment(
        RPM, nu, 500.0, bearing.mean_diameter, friction.section_height(bearing),
        *friction.SERIES[bearing.series], 3e-8, mu,
    )  # fmt: skip
    assert moment == pytest.approx(10e-3, rel=0.05)
    assert friction.power_loss(moment, RPM) == pytest.approx(
        1.05e-4 * moment * 1e3 * RPM, rel=0.01
    )


@pytest.mark.parametrize(('inner', 'outer'), [(95.0, 80.0), (25.0, 60.0)])
def test_clearance_is_what_the_expanded_parts_leave(inner, outer):
    """Each part grown by itself: bore of the outer race, inner race, two balls."""

    def gap(inner, outer):
        def grown(size, temperature):
            return size * (1.0 + 12e-6 * (temperature - 20.0))

        return (
            grown(0.0715, outer) - grown(0.0435, inner) - grown(2 * 0.014, 0.5 * (inner + outer))
        )

    expected = 0.5 * (gap(inner, outer) - gap(20.0, 20.0))
    assert network.clearance_change(inner, outer, 0.0575) == pytest.approx(expected, rel=1e-6)


def test_inner_ring_step_is_the_exact_solution():
    paths, outer, power = network.ThermalNetwork().scaled(57.5e-3), 60.0, 5.0
    target = network.inner_ring_target(
        outer, paths.shaft(outer), power, paths.ring_to_ring, paths.ring_to_shaft
    )
    got = network.inner_ring_step(
        20.0, target, 7.0, paths.inner_capacity, paths.ring_to_ring, paths.ring_to_shaft
    )

    def rate(_, t):
        flow = 0.5 * power - paths.ring_to_ring * (t - outer)
        return (flow - paths.ring_to_shaft * (t - paths.shaft(outer))) / paths.inner_capacity

    expected = solve_ivp(rate, (0.0, 7.0), [20.0], rtol=1e-10, atol=1e-10).y[0, -1]
    assert got == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize(
    ('name', 'dynamic', 'static'),
    [('6307-catalogue', 33.4e3, 19.2e3), ('6205', 14.0e3, 7.85e3), ('6203', 9.55e3, 4.8e3)],
)
def test_ratings_are_those_of_the_catalogues(name, dynamic, static):
    bearing = find_bearing(name)
    computed = replace(bearing, dynamic_rating=None, static_rating=None)
    assert life.dynamic_rating(computed) == pytest.approx(dynamic, rel=0.01)
    assert life.static_rating(computed) == pytest.approx(static, rel=0.01)
    assert life.dynamic_rating(bearing) == bearing.dynamic_rating
    assert life.static_rating(bearing) == bearing.static_rating


@pytest.mark.parametrize('g', [0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4])
def test_dynamic_rating_against_the_formula_behind_its_table(g):
    """Palmgren and Lundberg, as in ISO/TR 1281-1: grooves of 0.52, factor 0.95 in 39.9."""
    bearing = Bearing(name='x', n_balls=3, d_ball=0.1 * g, d_pitch=0.1)
    both = (1.0 + (1.04 * ((1.0 - g) / (1.0 + g)) ** 1.72) ** (10 / 3)) ** -0.3
    f_c = 0.95 * 39.9 * both * g**0.3 * (1.0 - g) ** 1.39 / (1.0 + g) ** (1 / 3) * 26.0**0.41
    expected = 1.3 * f_c * 3.0 ** (2 / 3) * (100.0 * g) ** (1.8 if g < 0.254 else 1.4)
    expected *= 1.0 if g < 0.254 else 3.647
    assert life.dynamic_rating(bearing) == pytest.approx(expected, rel=0.015)


def peak_pressure(bearing, race, conformity, load):
    """Hertz pressure, Pa, of a ball on a race, from the roots of the curvature equation."""
    sign = 1.0 if race == 'inner' else -1.0
    rolling = 2.0 / bearing.d_ball + 2.0 * sign / (bearing.d_pitch - sign * bearing.d_ball)
    groove = 2.0 / bearing.d_ball - 1.0 / (conformity * bearing.d_ball)

    def excess(e2):
        k, e = ellipk(e2), ellipe(e2)
        return (e / (1.0 - e2) - k) / (k - e) - rolling / groove

    e2 = brentq(excess, 1e-6, 1.0 - 1e-9)
    ratio = math.sqrt(1.0 - e2)
    reduced = 1.0 / (2.0 * (1.0 - 0.3**2) / 207e9)
    # Johnson, Contact Mechanics, 4.2: sum of the curvatures against the long semi-axis.
    total = rolling + groove
    long = (3.0 * load * ellipe(e2) / (math.pi * ratio**2 * reduced * total)) ** (1 / 3)
    return 1.5 * load / (math.pi * ratio * long**2)


@pytest.mark.parametrize('g', [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4])
def test_static_rating_presses_the_hottest_contact_with_4200_mpa(g):
    """The definition of ISO 76, 3.1: the most loaded ball carries 5/Z of the load."""
    bearing = Bearing(name='x', n_balls=7, d_ball=0.05 * g, d_pitch=0.05)
    load = 5.0 / 7.0 * life.static_rating(bearing)
    pressed = [peak_pressure(bearing, *race, load) for race in (('inner', 0.52), ('outer', 0.53))]
    assert max(pressed) == pytest.approx(4200e6, rel=0.01)


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
    assert life.life_hours(1.0, 1000.0, 0.0, 1e4, 1e4) == math.inf
    assert life.life_hours(1.0, 1000.0, 1000.0 / 60.0, 1e4, 1e4) == pytest.approx(1e6)
