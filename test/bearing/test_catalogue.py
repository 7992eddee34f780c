# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import csv
import dataclasses
from importlib import resources
import math
import re

from bearing_twin.bearing import (
    Bearing,
    catalogue,
    contact_stiffness,
    fault_frequencies,
    fault_orders,
    find_bearing,
    load_deflection_factor,
    own_bearing,
    radial_factor,
)
from bearing_twin.bearing.hertz import elliptic_integrals
from bearing_twin.errors import BearingTwinError
from inferring import infer_balls, infer_roller_counts, roller_static_rating, rounds_to
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk


def test_paper_frequencies():
    got = fault_frequencies(find_bearing('6307'), 25.4)
    assert got == pytest.approx((76.86261, 126.33739, 49.06854, 9.60783), abs=1e-5)


@pytest.mark.parametrize('slip', [0.0, 0.001, 0.02])
@pytest.mark.parametrize('name', list(catalogue()))
def test_outer_and_inner_pass_add_up(name, slip):
    bearing = find_bearing(name)
    orders = fault_orders(bearing, slip)
    assert orders.bpfo + orders.bpfi == pytest.approx(bearing.n_balls, abs=1e-12)
    assert orders.ftf * bearing.n_balls == pytest.approx(orders.bpfo, abs=1e-12)


@pytest.mark.parametrize(
    ('name', 'bpfo', 'bpfi'),
    [
        ('6205', 3.5848, 5.4152),  # Case Western Reserve University, published multiples
        ('6203', 3.0530, 4.9469),
        ('NICE', 3.245, 4.755),  # stored in the MFPT files
    ],
)
def test_published_multiples(name, bpfo, bpfi):
    orders = fault_orders(find_bearing(name))
    assert (orders.bpfo, orders.bpfi) == pytest.approx((bpfo, bpfi), abs=2e-4)


def rows():
    text = resources.files('bearing_twin.bearing').joinpath('catalogue.csv').read_text('utf-8')
    return list(csv.DictReader(text.splitlines()))


def test_every_row_has_a_source_and_is_found_in_any_case():
    assert len(catalogue()) == len(rows()) >= 200
    for name, bearing in catalogue().items():
        assert bearing.source
        assert bearing.basis in ('published', 'inferred', 'estimated')
        assert find_bearing(name.lower()) is bearing
        assert bearing.element == ('roller' if 'roller' in bearing.kind else 'ball')
        assert bearing.rows == (2 if name in ('ZA-2115', '22317') else 1)


def test_the_common_series_are_complete_from_10_to_100_mm_bore():
    for series in ('60', '62', '63'):
        for code in range(21):
            assert series + f'{code:02d}' in catalogue()
    assert all(f'160{code:02d}' in catalogue() for code in range(1, 21))


@pytest.mark.parametrize('row', [row for row in rows() if 'balls by ISO' in row['source']],
                         ids=lambda row: row['name'])  # fmt: skip
def test_inferred_balls_are_what_the_ratings_give(row):
    bearing = find_bearing(row['name'])
    # ISO 15: bore code of the designation.
    name, _, code = row['name'].rpartition('/')
    if not name:
        code = code[-1] if len(code) == 3 else code[-2:]
        special = {'00': 10, '01': 12, '02': 15, '03': 17}
        code = special.get(code, int(code) * (1 if len(code) == 1 else 5))
    assert bearing.bore == pytest.approx(float(code) / 1e3)
    balls = infer_balls(
        bearing.bore, bearing.outside, bearing.dynamic_rating, bearing.static_rating,
        float(row['f_0']),
    )  # fmt: skip
    assert balls[:3] == pytest.approx((bearing.n_balls, bearing.d_ball, bearing.d_pitch))
    assert bearing.basis == ('inferred' if balls.unique else 'estimated')


@pytest.mark.parametrize(
    ('known', 'like'),
    [
        ((8, 6.7462, 28.4988), '6203'),  # CWRU
        ((9, 7.94004, 39.0398), '6205'),  # CWRU
        ((8, 7.92, 34.55), '6204'),  # XJTU-SY UER204
        ((9, 12.7, 65.0), '6209'),  # Harris, Rolling Bearing Analysis, the 209 ball bearing
    ],
)
def test_inferred_balls_of_bearings_whose_balls_are_known(known, like):
    (row,) = [row for row in rows() if row['name'] == like]
    balls = infer_balls(
        float(row['bore_mm']) / 1e3, float(row['outside_mm']) / 1e3,
        float(row['dynamic_rating_kN']) * 1e3, float(row['static_rating_kN']) * 1e3,
        float(row['f_0']),
    )  # fmt: skip
    assert balls.n_balls == known[0]
    assert balls.d_ball * 1e3 == pytest.approx(known[1], rel=0.003)
    inferred, true = (
        fault_orders(Bearing(name=like, n_balls=z, d_ball=d, d_pitch=p))
        for z, d, p in ((balls[:3]), (known[0], known[1] / 1e3, known[2] / 1e3))
    )
    # The bounds that the docstring of infer_balls states.
    assert balls.d_pitch * 1e3 == pytest.approx(known[2], rel=0.019)
    assert inferred.bpfo == pytest.approx(true.bpfo, rel=0.006)
    assert inferred.bpfi == pytest.approx(true.bpfi, rel=0.006)
    assert inferred.bsf == pytest.approx(true.bsf, rel=0.022)


@pytest.mark.parametrize('name', [name for name in catalogue() if re.fullmatch(r'NU\d+E', name)])
def test_inferred_rollers_are_what_the_static_rating_gives(name):
    bearing = find_bearing(name)
    size = bearing.bore, bearing.d_ball, bearing.d_pitch
    printed = [
        (other.width * 1e3, other.static_rating / 1e3)
        for other in catalogue().values()
        if other.width and (other.bore, other.d_ball, other.d_pitch) == size
    ]
    counts = infer_roller_counts(bearing.d_ball * 1e3, bearing.d_pitch * 1e3, printed)
    assert counts == [bearing.n_balls]
    assert bearing.basis == 'inferred'


_SQUARE = {
    'NU204': (27, 40, 12.7), 'NU205': (32, 45, 15.7), 'NU206': (38.5, 53.5, 21.5),
    'NU207': (43.8, 61.8, 31.5), 'NU208': (50, 70, 42.9), 'NU209': (55, 75, 46.9),
    'NU210': (60.4, 80.4, 51), 'NU211': (66.5, 88.5, 62.3), 'NU212': (73.5, 97.5, 79.9),
    'NU213': (79.6, 105.6, 94.4), 'NU214': (84.5, 110.5, 95.2), 'NU215': (88.5, 116.5, 118),
    'NU216': (95.3, 125.3, 122), 'NU217': (101.8, 133.8, 140), 'NU218': (107, 143, 178),
    'NU219': (113.5, 151.5, 195), 'NU220': (120, 160, 217), 'NU221': (126.8, 168.8, 241),
    'NU222': (132.5, 178.5, 290), 'NU224': (143.5, 191.5, 318), 'NU226': (156, 204, 362),
    'NU228': (169, 221, 421), 'NU230': (182, 238, 492), 'NU232': (195, 255, 568),
    'NU234': (208, 272, 637), 'NU236': (218, 282, 677), 'NU238': (231, 299, 768),
    'NU240': (244, 316, 865), 'NU304': (28.5, 44.5, 19.2), 'NU305': (35, 53, 25.2),
    'NU306': (42, 62, 35.2), 'NU307': (46.2, 68.2, 46.9), 'NU308': (53.5, 77.5, 56.9),
    'NU309': (58.5, 86.5, 77.5), 'NU310': (65, 95, 93.4), 'NU311': (70.5, 104.5, 111),
    'NU312': (77, 113, 126), 'NU313': (83.5, 121.5, 139), 'NU314': (90, 130, 168),
    'NU315': (95.5, 139.5, 205), 'NU316': (103, 147, 207), 'NU317': (108, 156, 247),
    'NU318': (115, 165, 265), 'NU319': (121.5, 173.5, 311), 'NU320': (129.5, 185.5, 337),
    'NU321': (135, 195, 417), 'NU322': (143, 207, 467), 'NU324': (154, 226, 551),
    'NU326': (167, 243, 667), 'NU328': (180, 260, 746),
}  # fmt: skip
"""
F, E, mm, and C_0r, kN, of bearings whose rollers are as long as thick (JTEKT Koyo, Ball and roller
bearings, cat. B2001).
"""


@pytest.mark.parametrize('name', list(_SQUARE))
def test_static_ratings_of_square_rollers_stand_for_a_whole_number(name):
    inner, outer, printed = _SQUARE[name]
    roller, pitch = 0.5 * (outer - inner), 0.5 * (outer + inner)
    counts = [
        count
        for count in range(8, 20)
        if rounds_to(roller_static_rating(count, roller, roller, pitch), printed)
    ]
    assert len(counts) == 1
    if name in catalogue():  # Harris, Rolling Bearing Analysis, the 209 cylindrical roller bearing
        assert counts == [find_bearing(name).n_balls]


@pytest.mark.parametrize(
    ('said', 'name'),
    [('SKF NJ 216 ECP', 'NU216E'), ('NUP 311-E-XL-TVP2/C3', 'NU311E'), ('nu2212 ecml', 'NU2212E'),
     ('NSK NU 216 EM', 'NU216E'), ('N205EW', 'NU205E'), ('Koyo NJ308R', 'NU308E'),
     ('NU 209', 'NU209')],
)  # fmt: skip
def test_flanges_and_cages_of_rollers_do_not_matter(said, name):
    assert find_bearing(said).name == name


@pytest.mark.parametrize(
    ('name', 'close'),
    [('NU216', 'NU216E'), ('SKF NJ 311', 'NU311E'), ('NU210 ECP', 'NU211E'), ('NNU216E', 'NU'),
     ('NCF 2216 ECJB', 'NU')],
)  # fmt: skip
def test_rollers_that_may_have_another_number_are_refused(name, close):
    with pytest.raises(BearingTwinError, match=f'the closest names: .*{close}'):
        find_bearing(name)


@pytest.mark.parametrize(
    ('said', 'name'),
    [('SKF 6205-2RS JEM', '6205'), ('6306-2Z/C3', '6306'), ('nsk 6308ZZ', '6308'),
     ('6204 DDU', '6204'), ('61806', '6806'), ('6009-2RS1', '6009')],
)  # fmt: skip
def test_makers_and_seals_do_not_matter(said, name):
    assert find_bearing(said).name == name


def test_orders_of_two_decimals_give_every_bearing():
    for bearing in catalogue().values():
        orders = fault_orders(bearing)
        text = ','.join(f'{name}={order:.2f}' for name, order in orders._asdict().items())
        found = own_bearing(text)
        assert found.n_balls == bearing.n_balls
        assert fault_orders(found) == pytest.approx(orders, rel=0.01)


def test_mean_diameter():
    assert find_bearing('6307-catalogue').mean_diameter == pytest.approx(57.5e-3)
    assert find_bearing('NICE').mean_diameter == find_bearing('NICE').d_pitch


@pytest.mark.parametrize(
    'name', ['63o8', '6399', '6205R', 'X6205', '6205 special', '6205 ETN9', '']
)
def test_unknown_name_is_refused_with_close_ones(name):
    with pytest.raises(
        BearingTwinError, match=r'no bearing .* the closest names: [^,]+,'
    ) as error:
        find_bearing(name)
    assert name != '63o8' or '6308' in str(error.value)


@pytest.mark.parametrize('suffixes', ['z' * 80 + '!', 'rsz' * 40 + '!', 'x' * 1_000_000])
def test_a_name_from_outside_is_refused_at_once_and_not_repeated(suffixes):
    # The first two took longer than anybody waits, the last one 40 s.
    with pytest.raises(BearingTwinError, match='no bearing') as error:
        find_bearing('6205' + suffixes)
    assert len(str(error.value)) < 500


@pytest.mark.parametrize('m', [0.0, 0.3, 0.9, 0.999999])
def test_elliptic_integrals(m):
    assert elliptic_integrals(m) == pytest.approx((ellipk(m), ellipe(m)), rel=1e-12)


@pytest.mark.parametrize('angle', [0.0, 40.0])
@pytest.mark.parametrize('race', ['inner', 'outer'])
def test_hertz_against_contact_areas(race, angle):
    """The semi-axes from a root of the curvature equation (Johnson, Contact Mechanics, 4.2)."""
    bearing = dataclasses.replace(find_bearing('6205'), contact_angle=math.radians(angle))
    conformity = 0.52
    sign = 1.0 if race == 'inner' else -1.0
    # Of the cone that touches the race where the ball does.
    radius = 0.5 * (bearing.d_pitch / math.cos(bearing.contact_angle) - sign * bearing.d_ball)
    r1 = 1.0 / (2.0 / bearing.d_ball + sign / radius)
    r2 = 1.0 / (2.0 / bearing.d_ball - 1.0 / (conformity * bearing.d_ball))

    def ratio(e2):  # (R''/R')-equation for the eccentricity squared
        k, e = ellipk(e2), ellipe(e2)
        return (e / (1.0 - e2) - k) / (k - e) - r2 / r1

    e2 = brentq(ratio, 1e-6, 1.0 - 1e-9)
    k, e = ellipk(e2), ellipe(e2)
    equivalent, b_over_a = math.sqrt(r1 * r2), math.sqrt(1.0 - e2)
    f1 = (
        (4.0 / (math.pi * e2)) ** (1 / 3)
        * b_over_a**0.5
        * (((1.0 / b_over_a**2) * e - k) * (k - e)) ** (1 / 6)
    )
    f2 = 2.0 / math.pi * b_over_a**0.5 / f1 * k
    reduced = 208e9 / (2.0 * (1.0 - 0.3**2))
    stiffness = (9.0 / (16.0 * reduced**2 * equivalent)) ** -0.5 * f2**-1.5
    got = contact_stiffness(bearing, race, conformity=conformity)
    assert got == pytest.approx(stiffness, rel=1e-6)


@pytest.mark.parametrize('angle', [0.0, 15.0, 40.0])
def test_radial_factor_is_the_derivative_of_the_contact_energy(angle):
    bearing = dataclasses.replace(find_bearing('6205'), contact_angle=math.radians(angle))

    def energy(displacement):
        pressed = displacement * math.cos(bearing.contact_angle)
        return 0.4 * load_deflection_factor(bearing) * pressed**2.5

    x, h = 10e-6, 1e-9
    force = (energy(x + h) - energy(x - h)) / (2.0 * h)
    assert radial_factor(bearing) * x**1.5 == pytest.approx(force, rel=1e-6)


def test_stiffness_scales_with_the_modulus():
    bearing = find_bearing('6205')
    ratio = load_deflection_factor(bearing, young=104e9) / load_deflection_factor(bearing)
    assert ratio == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize(
    'changes',
    [
        {'n_balls': 2},
        {'d_ball': 14.0},
        {'d_ball': 0.03},
        {'contact_angle': 2.0},
        {'element': 'needle'},
        {'rows': 3},
        {'bore': 0.05},
        {'outside': 0.07},
    ],
)
def test_impossible_geometry_is_refused(changes):
    good = {'name': 'x', 'n_balls': 8, 'd_ball': 0.014, 'd_pitch': 0.0575}
    with pytest.raises(BearingTwinError):
        Bearing(**(good | changes))
