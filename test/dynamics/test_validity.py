# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What leaves the model's validity is refused at the door, or survived and said while running."""

import dataclasses
import math

from bearing_twin.bearing import contact_pressure, find_bearing
from bearing_twin.dynamics import Defect, preset, Simulator, TwinParameters
from bearing_twin.dynamics.limits import Limit
from bearing_twin.dynamics.reference import solve
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import Beta0
from bearing_twin.thermal.life import static_rating
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import clearance_limits, ThermalNetwork
from cases import in_proofs
import numpy as np
import pytest
from scipy.optimize import brentq

pytestmark = pytest.mark.usefixtures('reference')

RATE = 25600.0
B = find_bearing('6307')


def bearing(**changes):
    return dataclasses.replace(B, bore=None, outside=None, **changes)


def build(**changes):
    return TwinParameters(**({'bearing': B} | changes))


def spalls(*places, width=1e-3, **shape):
    """Defects at (place, angle) pairs."""
    return tuple(
        Defect(place=place, angle=angle, width=width, **({'depth': 20e-6} | shape))
        for place, angle in places
    )


def simulate(**options):
    return Simulator(build(), **options)


# What is built; the value, the limit and the remedy that the text has to name.
REFUSED = {
    'beta0 high': (lambda: Beta0(delta_mu=0.1), 'beta0=1.', '0.5..1.5', 'reduce delta_mu'),
    'beta0 low': (
        lambda: Beta0(reference_friction=0.2, delta_mu=1.0), 'beta0=0.', '0.5..1.5', 'reduce'),
    'weight': (lambda: Beta0(delta_h=-1.0), 'delta_h=-1.0', '0..2', 'choose'),
    'unit': (lambda: Beta0(alpha_unit=1e-4), 'alpha_unit=0.0001', '1e-5', 'choose'),
    'T0': (lambda: Beta0(reference_temperature=0.0), '=0.0', '20..110 degC', 'choose'),
    'H0': (lambda: Beta0(reference_hardness=-1.0), 'hardness=-1.0', '1..100 HRC', 'choose'),
    'text': (lambda: bearing(n_balls='9'), "n_balls='9'", 'whole number', 'give one without'),
    'part of a ball': (lambda: bearing(n_balls=8.5), '8.5', 'whole number', 'give one without'),
    'size': (lambda: bearing(d_ball=None), 'd_ball=None', 'real number', 'give one'),
    'text as bore': (
        lambda: dataclasses.replace(B, bore='35'), "bore='35'", 'real number', 'give one'),
    'name of a bearing': (
        lambda: build(bearing='6307'), "bearing='6307'", 'Bearing', 'use find_bearing'),
    'name of an oil': (
        lambda: build(lubricant='VG 68'), "lubricant='VG 68'", 'Lubricant', 'make one'),
    'name of a place': (
        lambda: build(defects='inner'), "defects[0]='i'", 'Defect', 'give a tuple'),
    'no defects': (
        lambda: build(defects=None), 'defects=None', 'Sequence', 'give a tuple of Defect'),
    'name of a preset': (
        lambda: Simulator('paper'), "parameters='paper'", 'TwinParameters', 'preset'),
    'few balls': (lambda: bearing(n_balls=2), 'n_balls=2', '3..100', 'give the number'),
    'crowded': (lambda: bearing(n_balls=13), '13 elements of 0.014', '0.0575 m', 'check n_balls'),
    'millimetres': (
        lambda: bearing(d_ball=14.0, d_pitch=57.5), '57500 mm', '20 m', 'is the unit right?'),
    'degrees': (lambda: bearing(contact_angle=15.0), '15.0 rad', '0..pi/2', 'in radians'),
    'bore': (
        lambda: dataclasses.replace(B, bore=50e-3), 'bore=0.05 m', '0.0435', 'check them'),
    'kind': (lambda: bearing(element='needle'), "'needle'", "'ball' or 'roller'", 'choose'),
    'rollers': (
        lambda: preset('incipient', bearing='ZA-2115'), '2 row(s) of rollers', 'one row of balls',
        'choose a ball bearing'),
    'two rows': (
        lambda: build(bearing=bearing(rows=2)), '2 row(s) of balls', 'one row of balls',
        'choose a ball bearing'),
    'thrust': (
        lambda: build(bearing=bearing(contact_angle=1.0)), 'contact_angle=1.0', '0..0.785',
        'choose'),
    'tiny': (
        lambda: build(bearing=bearing(d_ball=1e-7, d_pitch=1e-6)), 'balls of 0.0001 mm',
        '0.1 mm', 'is the unit right?'),
    'place': (lambda: spalls(('roof', 0.0)), "'roof'", 'inner, outer, ball, cage', 'choose'),
    'profile': (lambda: spalls(('inner', 0.0), profile='x'), "'x'", 'halfsine', 'choose'),
    'width': (lambda: spalls(('inner', 0.0), width=2e-2), 'width=0.02', '5e-05..0.01', 'choose'),
    'depth': (lambda: spalls(('inner', 0.0), depth=1e-3), 'depth=0.001', '0..0.0005', 'choose'),
    'half a ball': (
        lambda: build(defects=spalls(('inner', 0.0), width=8e-3)), '8 mm', '7 mm', 'no local'),
    'ball spacing': (
        lambda: build(
            bearing=bearing(n_balls=3, d_ball=42e-3, d_pitch=50e-3),
            defects=spalls(('outer', 0.0), width=9e-3)),
        '9 mm', '8.38 mm', 'no local'),
    'no such ball': (
        lambda: build(defects=spalls(('ball', 0.0), ball=8)), 'ball 8', '0..7', 'has balls'),
    'too many': (
        lambda: build(defects=spalls(*(('outer', 0.5 * k) for k in range(9)))), '9 defects', '8',
        'merge'),
    'same place': (
        lambda: preset('incipient', defect='inner+inner'), '0 mm apart', '0.8 mm', 'move one'),
    'overlap': (
        lambda: build(defects=spalls(('outer', 0.0), ('outer', 0.02))), '0.715 mm apart', '1 mm',
        'move one'),
    'overlap over 2 pi': (
        lambda: build(defects=spalls(('inner', math.pi), ('inner', -math.pi))), '0 mm apart',
        '1 mm', 'move one'),
    'load': (lambda: build(load=1.0), 'load=1.0', '10..50000 N', 'choose'),
    'clearance': (
        lambda: build(clearance=math.nan), 'clearance=nan', '-5e-05..0.0005 m', 'choose'),
    'resonance': (lambda: build(resonance_hz=20e3), '20000.0', '500..11000 Hz', '0: none'),
    'slip': (lambda: build(slip=0.05), '=0.34', '0..0.3', 'choose'),
    'eccentric': (lambda: build(unbalance=0.02), '=0.00319', '0..0.001 m', 'choose'),
    'mode': (lambda: build(thermal_mode='magic'), "'magic'", 'paper, physical', 'choose'),
    'slip model': (lambda: build(slip_model='some'), "'some'", 'none, constant', 'choose'),
    'series': (lambda: build(friction_series='99'), "'99'", '60, 62', 'choose'),
    'own series': (lambda: build(bearing=bearing(series='72')), "'72'", '60, 62', 'choose'),
    'seizing': (
        lambda: build(thermal_mode='physical', network=ThermalNetwork(shaft_ratio=1.5)),
        '-7.4 um', '-5..50 um', 'change clearance'),
    'hanging loose': (
        lambda: build(
            thermal_mode='physical', clearance=45e-6, network=ThermalNetwork(shaft_ratio=0.5)),
        '57.4 um', '-5..50 um', 'change clearance'),
    'oil': (lambda: Lubricant(viscosity_40=68.0), '68.0', '0.005 m^2/s', 'choose'),
    'network': (lambda: ThermalNetwork(ambient=200.0), 'ambient=200.0', '-40..110 degC', 'choose'),
    'stiff': (lambda: simulate(sample_rate=1e3), '1000.0', '2000..204800 Hz', 'outside'),
    'light': (
        lambda: Simulator(build(inner_mass=0.1, outer_mass=0.1)), 'Hz, and steps', 'up to',
        'use larger masses'),
    'temperature': (lambda: simulate(temperature=19.0), '19.0 degC', '20..110', 'clamp'),
    'speed': (lambda: simulate(shaft_hz=600.0), '600.0', '0..500 Hz', 'choose'),
}  # fmt: skip


@pytest.mark.parametrize('case', list(REFUSED))
def test_what_leaves_the_validity_is_refused_with_value_limit_and_remedy(case):
    make, *said = REFUSED[case]
    with pytest.raises(BearingTwinError) as refusal:
        make()
    for part in said:
        assert part in str(refusal.value)


@pytest.mark.parametrize(
    'defects',
    [
        spalls(('outer', 0.0), ('outer', 0.03)),
        spalls(('inner', 0.0), ('outer', 0.0), ('cage', 0.0)),
        spalls(('ball', 0.0), ('ball', math.pi)),
        spalls(('ball', 0.0)) + spalls(('ball', 0.0), ball=3),
    ],
    ids=['apart', 'other parts', 'far side of the ball', 'other balls'],
)
def test_defects_that_share_no_surface_are_no_overlap(defects):
    assert build(defects=defects).defects == defects


def test_touching_halves_are_one_defect():
    """Where spalls meet, the ball is in one of them: no depth is added up."""
    half = 0.5e-3 / (0.5 * (B.d_pitch + B.d_ball))  # rad, half of 1 mm on the outer race

    def shake(defects):
        parameters = build(defects=defects, jitter=0.0, noise=0.0, load=2000.0)
        return Simulator(parameters).advance(5120, 20.0, 25.4).y

    at = -0.5 * math.pi
    common = {'profile': 'rect', 'depth': 10e-6}
    one = shake(spalls(('outer', at), width=2e-3, **common))
    two = shake(spalls(('outer', at - half), ('outer', at + half * (1.0 + 1e-9)), **common))
    assert np.linalg.norm(two - one) < 0.02 * np.linalg.norm(one)


# --- ring temperatures beyond the clearance of the model ---------------------------------------


def test_a_bearing_that_would_seize_goes_on_and_says_so():
    parameters = preset('incipient', thermal_mode='physical', noise=0.0)
    simulator = Simulator(parameters, temperature=110.0)
    hot = simulator.condition()
    assert hot.thermal_clearance == hot.radial_clearance
    # The housing is quenched while the shaft is still hot.
    block = simulator.advance(int(0.5 * RATE), 20.0, 25.4)
    quenched = block.condition
    apart = quenched.inner_ring_temperature - 20.0
    assert quenched.thermal_clearance == pytest.approx(5e-6 - 0.345e-6 * apart, rel=1e-3)
    assert quenched.thermal_clearance < -20e-6
    assert quenched.radial_clearance == pytest.approx(clearance_limits(57.5e-3)[0], rel=1e-9)
    assert np.isfinite(block.y).all()
    assert np.abs(block.y).max() < 1000.0
    for _ in range(4):
        later = simulator.advance(int(10.0 * RATE), 20.0, 25.4).condition
    assert later.thermal_clearance == later.radial_clearance
    assert later.radial_clearance == pytest.approx(5e-6, abs=0.5e-6)
    assert (hot.limits_passed, later.limits_passed) == (Limit(0), Limit(0))
    assert quenched.limits_passed == Limit.CLEARANCE
    assert 'would seize' in quenched.warnings[0]


@pytest.mark.parametrize(
    ('case', 'expected'),
    [
        ({}, Limit(0)),
        ({'bearing': find_bearing('6203'), 'load': 3000.0}, Limit(0)),
        # C = 9.55 kN, C0 = 4.8 kN.
        ({'bearing': find_bearing('6203'), 'load': 4770.0}, Limit(0)),
        ({'bearing': find_bearing('6203'), 'load': 4790.0}, Limit.LIFE_LOAD),
        ({'bearing': find_bearing('6203'), 'load': 4810.0}, Limit.STATIC_LOAD | Limit.LIFE_LOAD),
        (
            {'bearing': find_bearing('6203'), 'load': 4810.0, 'dynamic_rating': 12e3},
            Limit.STATIC_LOAD,
        ),
    ],
)
def test_no_life_beyond_half_the_dynamic_or_the_static_rating(case, expected):
    condition = Simulator(build(clearance=0.0, **case), temperature=40.0).condition()
    # The pressure limit is near C0, and moves with the clearance.
    assert condition.limits_passed & ~Limit.PRESSURE == expected
    assert math.isnan(condition.life_hours) == bool(expected)
    assert len(condition.warnings) == len(condition.limits_passed)


@pytest.mark.parametrize('name', ['6203', '6205', '6307'])
def test_the_contact_pressure_is_that_of_stribeck_hertz_and_iso_76(name):
    bearing, no_play = find_bearing(name), 0.0
    rating = static_rating(bearing)
    low, high = (
        Simulator(build(bearing=bearing, load=share * rating, clearance=no_play)).condition()
        for share in (0.25, 1.0)
    )
    # Stribeck: without clearance a ball bears 4.37/Z of the load; ISO 76 takes 5/Z, and grooves
    # of conformity 0.52 where the twin has 0.515.
    expected = contact_pressure(bearing, 4.37 * rating / bearing.n_balls)
    assert high.contact_pressure == pytest.approx(expected, rel=0.01)
    of_standard = contact_pressure(bearing, 5.0 * rating / bearing.n_balls, conformity=0.52)
    assert of_standard == pytest.approx(4.2e9, rel=0.01)
    # Hertz: the cube root of the force, as the load spreads alike over the balls.
    assert high.contact_pressure / low.contact_pressure == pytest.approx(4.0 ** (1 / 3), rel=0.01)


def test_a_film_too_thin_for_the_standard_is_said_and_a_standing_shaft_needs_none():
    fast, slow, standing = (
        Simulator(build(), temperature=110.0, shaft_hz=hz).condition() for hz in (25.0, 1.0, 0.0)
    )
    assert not fast.limits_passed
    assert slow.limits_passed == Limit.FILM
    assert math.isnan(slow.life_hours)
    assert f'{slow.kappa:.2g}' in slow.warnings[0]
    assert not standing.limits_passed


def test_the_paper_s_mode_knows_no_thermal_clearance():
    for temperature in (20.0, 110.0):
        condition = Simulator(build(clearance=-5e-6), temperature=temperature).condition()
        assert condition.thermal_clearance == condition.radial_clearance == -5e-6


# --- contact angle and series ------------------------------------------------------------------


@pytest.mark.parametrize('places', [('inner', 'outer'), *in_proofs((('ball',),))])
def test_a_contact_angle_agrees_with_the_adaptive_solver(places):
    parameters = build(
        bearing=bearing(contact_angle=math.radians(40.0)),
        defects=spalls(*((place, -0.5 * math.pi) for place in places), depth=15e-6),
        jitter=0.0,
        noise=0.0,
    )
    reference = solve(parameters, 2560, shaft_hz=30.0)
    block = Simulator(parameters, shaft_hz=30.0).advance(2560, 20.0, 30.0)
    got, expected = np.array([block.x, block.y]), np.array([reference.x, reference.y])
    assert np.linalg.norm(got - expected) < 2e-3 * np.linalg.norm(expected)


def test_a_contact_angle_softens_the_bearing():
    straight, steep = (
        Simulator(build(bearing=bearing(contact_angle=math.radians(a)), load=2000.0)).condition()
        for a in (0.0, 40.0)
    )
    assert steep.k_b / straight.k_b == pytest.approx(math.cos(math.radians(40.0)) ** 2.5, rel=0.02)
    # delta ~ (W / K)^(2/3) below the clearance.
    sunk = [-(c.inner_y + 5e-6) for c in (straight, steep)]
    assert sunk[1] / sunk[0] == pytest.approx((straight.k_b / steep.k_b) ** (2 / 3), rel=0.05)


def test_friction_follows_the_series_of_the_bearing():
    def moment(**changes):
        return Simulator(build(**changes), temperature=60.0).condition().friction_moment

    assert moment() == moment(friction_series='63')
    assert moment() == moment(bearing=dataclasses.replace(B, series=''), friction_series='63')
    light, heavy = moment(friction_series='60'), moment(friction_series='64')
    assert light > moment(friction_series='62') > moment() > heavy
    unknown = dataclasses.replace(B, series='')
    assert moment(bearing=unknown) == moment(friction_series='62')


def test_bearings_of_the_thinnest_series_rub_as_skf_says():
    """SKF: R1 4.3e-7 and S1 4.75e-3 of the series 619, 3.9e-7 and 3.23e-3 of 62."""
    thin = find_bearing('6908')

    def moment(load, **changes):
        machine = build(bearing=thin, load=load, **changes)
        return Simulator(machine, temperature=90.0).condition().friction_moment

    for load in (500.0, 4000.0):
        more = moment(load) / moment(load, friction_series='62')
        assert 4.3 / 3.9 < more < 4.75 / 3.23
        assert moment(load) == moment(load, friction_series='619')


# --- preload and the ball loads ----------------------------------------------------------------


def cubic_mean_of_ball_loads(load, clearance, n, k_b):
    """Mean of Q^3 over ball positions, to the power 1/3, N; rigid rings that carry the load."""
    cosines = np.cos(2.0 * math.pi * (np.arange(32 * n) + 0.5) / (32 * n))

    def pressed(sink):
        return k_b * np.maximum(sink * cosines - clearance, 0.0) ** 1.5

    sink = brentq(lambda s: n * np.mean(pressed(s) * cosines) - load, 0.0, 1e-3, xtol=1e-15)
    return float(np.mean(pressed(sink) ** 3) ** (1.0 / 3.0))


@pytest.mark.parametrize('clearance', [-5e-6, 0.0, 5e-6, 20e-6, 40e-6])
@pytest.mark.parametrize(('name', 'load'), [('6307', 500.0), ('6307', 3200.0), ('6211', 200.0)])
def test_life_and_friction_know_how_hard_the_balls_are_pressed(name, load, clearance):
    bearing = find_bearing(name)

    def state(gap):
        condition = Simulator(build(bearing=bearing, load=load, clearance=gap)).condition()
        return condition, cubic_mean_of_ball_loads(load, gap, bearing.n_balls, condition.k_b)

    (free, usual), (pressed, harder) = state(0.0), state(clearance)
    ratio = harder / usual
    # With that oil a_ISO is 50, so the life goes with the cube of the load alone.
    if free.life_hours * pressed.life_hours < math.inf and load < 1000.0:
        assert pressed.life_hours / free.life_hours == pytest.approx(ratio**-3, rel=0.02)
    # SKF: a part of the moment goes with the power 0.54 of the load, another with 5/3.
    moved = pressed.friction_moment / free.friction_moment
    ratio = max(ratio, 1.0) if clearance < 0.0 else 1.0
    assert 0.999 * ratio**0.54 <= moved <= 1.001 * ratio ** (5.0 / 3.0)


def test_few_balls_that_bear_end_the_life_earlier():
    small = {'bearing': find_bearing('6001'), 'load': 2300.0}
    free, tight = (Simulator(build(clearance=gap, **small)).condition() for gap in (0.0, 17e-6))
    assert not free.limits_passed & (Limit.LIFE_LOAD | Limit.STATIC_LOAD)
    share = [
        cubic_mean_of_ball_loads(2300.0, gap, small['bearing'].n_balls, free.k_b)
        for gap in (0.0, 17e-6)
    ]
    assert 2300.0 * share[1] / share[0] > static_rating(small['bearing'])
    assert tight.limits_passed & Limit.STATIC_LOAD
    assert math.isnan(tight.life_hours)
    assert 'kN with this clearance)' in tight.warnings[0]


# --- size --------------------------------------------------------------------------------------


def test_ring_and_clearance_go_with_the_size_of_the_bearing():
    """A capacity grows with the volume, a conductance with the length: time with the area."""
    hot, start = 60.0, 20.0
    for name in ('6205', '6307', '6340'):
        bearing = find_bearing(name)
        size = bearing.d_pitch / 57.5e-3
        parameters = preset(
            'incipient', bearing=bearing, defect='none', thermal_mode='physical', load=100.0,
            clearance=5e-6 * size, noise=0.0,
        )  # fmt: skip
        simulator = Simulator(parameters, temperature=start, shaft_hz=1.0, sample_rate=5000.0)
        began = simulator.condition().inner_ring_temperature
        duration = 8.0 * size**2
        # At once to the outer temperature, then the time constant of 8 s of a 6307.
        simulator.advance(50, hot, 1.0)
        block = simulator.advance(round(5000.0 * duration), hot, 1.0)
        target = (2.0 * hot + 8.0 * (20.0 + 1.1 * (hot - 20.0))) / 10.0
        left = (block.condition.inner_ring_temperature - target) / (began - target)
        assert left == pytest.approx(math.exp(-1.0), abs=0.03)
    # What C3 of a bearing of 200 mm bore leaves is no clearance that hangs loose.
    assert build(bearing=find_bearing('6340'), clearance=60e-6).clearance == 60e-6
    with pytest.raises(BearingTwinError, match='clearance'):
        build(bearing=find_bearing('6001'), clearance=45e-6)


def test_which_race_is_pressed_harder_depends_on_the_bearing():
    for name in ('6820', '6307', '6001', '16020'):
        bearing = find_bearing(name)
        load = 0.05 * static_rating(bearing)
        condition = Simulator(build(bearing=bearing, load=load, clearance=0.0)).condition()
        # Stribeck: 4.37/Z of the load on the highest_ball_force ball.
        force = 4.37 * load / bearing.n_balls
        expected = max(contact_pressure(bearing, force, race) for race in ('inner', 'outer'))
        assert condition.contact_pressure == pytest.approx(expected, rel=0.01)
