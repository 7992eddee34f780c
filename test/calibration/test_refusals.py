# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Records that tell no width, and the reason that is given."""

from dataclasses import replace
import math

from bearing_twin.bearing import fault_frequencies, fault_orders, find_bearing
from bearing_twin.calibration import fit
from bearing_twin.calibration.answer.estimates import of_defect, of_slip, spacing_shortfall
from bearing_twin.calibration.answer.impacts import gear_mesh
from bearing_twin.calibration.answer.refusals import half_frequency, Kind, no_impacts, unresolved
from bearing_twin.calibration.candidates import cloud
from bearing_twin.calibration.candidates.cloud import Situation
from bearing_twin.calibration.candidates.posterior import without_spacing
from bearing_twin.calibration.joint import common_width
from bearing_twin.calibration.measured.summaries import correlate, summarise
from bearing_twin.dynamics.parameters import widest
from impact_trains import BEARING, impact_train, RATE, ring
import numpy as np
import pytest
from scipy.signal import lfilter

NOISE = np.random.default_rng(0).standard_normal(51200)


def test_spots_of_half_a_millimetre_on_a_fast_shaft_are_not_measured(data_dir):
    """CWRU: the passage lasts one to five samples."""
    for name in ('cwru_0105_DE', 'cwru_0258_DE'):
        with np.load(data_dir / 'cwru' / f'{name}.npz') as file:
            x, rate, hz = file['x'].astype(float), float(file['fs']), float(file['rpm']) / 60.0
        found = fit(x, rate, BEARING, hz, candidates=64)
        width = found.quantities['defect_width_mm']
        assert found.defect in ('inner', 'outer')
        assert not width.identifiable
        assert width.q95 - width.q05 > width.median


@pytest.mark.parametrize(
    ('measured', 'why'),
    [
        (math.nan, 'no line of a fault measures it'),
        (-0.0044, 'the line of the part gives -0.44 %, not 0 to 5 %'),
        (0.002, 'from the line of the part'),
    ],
)
def test_a_slip_is_said_to_be_measured_only_where_a_twin_can_have_it(measured, why):
    slip = of_slip(cloud.example('inner'), measured)
    assert slip.why.startswith(why) and not slip.identifiable


def test_a_slot_wider_than_is_simulated_is_said_to_be():
    assert 1e3 * widest(BEARING) < 6.0
    found = fit(impact_train(6e-3, 'outer', 12.0), RATE, BEARING, 12.0, place='outer',
                candidates=64)  # fmt: skip
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.TOO_WIDE and not width.identifiable
    assert 'are 6.0 mm apart' in width.why
    assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
    # Two records together bound it no closer than each alone.
    assert common_width([found, found])[1].q95 == width.q95


@pytest.mark.parametrize(('place', 'shaft_hz'), [('outer', 12.0), ('inner', 13.0)])
def test_impacts_of_another_part_or_speed_are_no_width(place, shaft_hz):
    x = impact_train(2e-3, 'inner', 12.0)
    found = fit(x, RATE, BEARING, shaft_hz, place=place, candidates=64)
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.NO_IMPACTS and not width.identifiable
    assert f'of the {place} race stand out: check bearing, speed and place' in width.why
    assert found.statement.startswith('no width: no impacts at')
    # A part that does not strike says nothing of a width, nor that it is one that is simulated.
    machine = replace(cloud.example(place), shaft_hz=shaft_hz)
    assert width.q95 == pytest.approx(1e3 * machine.speed / machine.impact_rate)
    assert common_width([found, found])[2] == found.statement


@pytest.mark.parametrize(('rate', 'shaft_hz'), [(0.5 * RATE, 12.0), (RATE, 24.0)])
@pytest.mark.parametrize('place', ['inner', 'outer'])
def test_a_rate_or_a_speed_that_is_twice_off_is_no_width(place, rate, shaft_hz):
    """The second harmonic lies where the part would strike, and the width would be too wide."""
    x = impact_train(2e-3, place, 12.0)
    found = fit(x, rate, BEARING, shaft_hz, place=place, candidates=64)
    assert (
        found.refusal is Kind.NO_IMPACTS and not found.quantities['defect_width_mm'].identifiable
    )
    assert found.statement.endswith('race: check speed and sample rate')


def test_noise_between_faint_impacts_is_no_wrong_speed():
    """Half of the records of noise have a line there that is as high as that of faint impacts."""
    machine = cloud.example()
    rng = np.random.default_rng(4)
    assert all(half_frequency(rng.standard_normal(51200), machine) is None for _ in range(20))


def test_impacts_of_another_bearing_say_which_would_fit():
    rng = np.random.default_rng(1)
    times = np.arange(0.01, 5.9, 1.0 / (25.0 * fault_orders(BEARING).impacts('outer')))
    times += 8e-5 * rng.standard_normal(len(times))
    x = np.zeros(76800)
    x[(12800.0 * times).astype(int)] = 1.0
    x = lfilter([1.0], [1.0, -0.18, 0.81], x) + 0.05 * rng.standard_normal(len(x))
    found = fit(x, 12800.0, find_bearing('6305'), 25.0)
    assert found.refusal is Kind.NO_PART
    assert 'fit no part of a 6305' in found.statement and 'outer of 6205' in found.statement


@pytest.mark.parametrize('shaft_hz', [10.0, 25.4])
def test_a_part_that_strikes_at_a_multiple_of_the_shaft_is_seen(shaft_hz):
    """The outer race of a 6307 strikes 3.026 times a turn, where the shaft has a line."""
    machine = Situation(
        bearing=find_bearing('6307'), place='outer', shaft_hz=shaft_hz, sample_rate=12800.0
    )
    x = np.random.default_rng(1).standard_normal(38400)
    times = np.arange(0.0, 3.0, 1.008 / machine.impact_rate)
    x[np.round(12800.0 * times).astype(int)] += 12.0
    assert not no_impacts(x, machine)


def swelling(seed, shaft_hz=25.0):
    """Six seconds of noise that swells with orders 1 to 6 of the shaft: a healthy machine."""
    rng = np.random.default_rng(seed)
    t = np.arange(6 * 12800) / 12800.0
    turning = [np.cos(2.0 * np.pi * (k * shaft_hz * t + rng.random())) for k in range(1, 7)]
    return (1.0 + 0.15 * sum(turning)) * rng.standard_normal(len(t))


def test_orders_of_the_shaft_are_no_impacts_of_an_outer_race():
    """That of a 6307 strikes 3.026 times a turn."""
    machine = Situation(
        bearing=find_bearing('6307'), place='outer', shaft_hz=25.0, sample_rate=12800.0
    )
    for seed in range(10):
        x = swelling(seed)
        refusal = no_impacts(x, machine)
        assert refusal.kind is Kind.NO_IMPACTS
        assert refusal.why.endswith(
            'the line there is order 3 of the shaft, and the orders beside it are about as high'
        )
        # A speed that is known to a few thousandths only changes nothing.
        assert no_impacts(swelling(seed, shaft_hz=25.08), machine)
        # A part that strikes between them is seen.
        rate = machine.impact_rate
        gaps = (1.0 + 0.002 * np.random.default_rng(seed).standard_normal(400)) / rate
        x[np.round(12800.0 * np.cumsum(gaps)).astype(int)] += 8.0
        assert no_impacts(x, machine) is None
    found = fit(swelling(0), 12800.0, machine.bearing, 25.0, place='outer', candidates=64)
    assert found.statement.startswith('no width: no impacts at the')


def test_a_second_impact_that_is_not_heard_is_no_limit_of_the_width():
    """The other edge is faint, or it is farther away than two balls are: nothing says which."""
    rng = np.random.default_rng(3)
    train = np.zeros(4 * int(RATE))
    strikes = fault_frequencies(BEARING, 20.0).impacts('outer')
    times = np.cumsum(1.0 + 0.004 * rng.standard_normal(int(4 * strikes) - 4)) / strikes
    train[np.round(times[times < 3.99] * RATE).astype(int)] = 1.0
    x = ring(train)
    x += 0.3 * x.std() * rng.standard_normal(len(x))
    found = fit(x, RATE, BEARING, 20.0, place='outer', candidates=64)
    width = found.quantities['defect_width_mm']
    assert found.refusal is Kind.ONE_IMPACT and not width.identifiable
    assert (
        found.statement
        == 'outer race defect, width not identifiable: only one impact per passage is heard'
    )
    assert (width.q05, width.q95) == (0.0, pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3))
    assert common_width([found, found])[2] == found.statement
    # Between impacts a resonance is found, and its interval is not believed.
    modes = [q for name, q in found.quantities.items() if name.startswith('resonance')]
    assert modes and not any(mode.identifiable for mode in modes)


def test_impacts_that_go_on_after_twice_the_time_are_no_passage():
    """Three impacts at equal distances are the teeth of a gear: no defect is twice as wide."""
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=20.0, sample_rate=RATE)
    apart = round(0.7 * machine.longest_spacing * RATE)
    rng = np.random.default_rng(1)
    for teeth, kind in ((2, None), (3, Kind.SEVERAL_SPACINGS)):
        train = np.zeros(4 * int(RATE))
        steps = np.cumsum(1.0 + 0.004 * rng.standard_normal(240)) / machine.impact_rate * RATE
        for tooth in range(teeth):
            train[np.round(steps).astype(int) + tooth * apart] += 1.0
        x = ring(train)
        whole = correlate(x + 0.02 * x.std() * rng.standard_normal(len(x)), RATE)
        refusal = unresolved(whole, whole.summary(machine.longest_spacing), machine)
        assert (refusal and refusal.kind) is kind


def test_the_echo_of_a_gear_in_the_whitening_is_no_passage():
    """Teeth closer than its reach: each impact of the bearing leaves another after their time."""
    rng = np.random.default_rng(2)
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=24.0, sample_rate=RATE)
    train = np.zeros(4 * int(RATE))
    at = np.cumsum(1.0 + 0.005 * rng.standard_normal(300)) / machine.impact_rate * RATE
    train[np.round(at).astype(int)] = 1.0
    teeth = np.round(np.arange(0.0, 4.0, 1.0 / (41 * 24.0)) * RATE).astype(int)
    for mesh, turns in ((0.0, False), (0.5, True)):
        x = train.copy()
        x[teeth] += mesh
        x = ring(x)
        x += 0.02 * x.std() * rng.standard_normal(len(x))
        assert (
            gear_mesh(x, RATE, summarise(x, RATE, machine.longest_spacing)) is not None
        ) is turns
    found = fit(x, RATE, BEARING, 24.0, place='outer', candidates=64)
    assert found.refusal is Kind.SEVERAL_SPACINGS and found.impacts is None
    assert 'the teeth of a gear' in found.quantities['defect_width_mm'].why


def test_a_gear_of_three_lines_is_one_where_its_echo_lies_beside_the_time_of_a_tooth():
    rng = np.random.default_rng(3)
    x = impact_train(0.0, 'outer', 24.0)
    meshing = 2.0 * np.pi * 1213.0 * np.arange(len(x)) / RATE
    x += 1.5 * x.std() * sum(np.cos(k * meshing + k) / k for k in (1, 2, 3))
    x += 0.01 * x.std() * rng.standard_normal(len(x))
    found = fit(x, RATE, BEARING, 24.0, place='outer', candidates=64)
    assert found.refusal is Kind.SEVERAL_SPACINGS
    assert 'the teeth of a gear' in found.quantities['defect_width_mm'].why


@pytest.mark.parametrize(
    ('place', 'width'), [('outer', 13.5e-3), ('inner', 8.5e-3), ('outer', 9e-3)]
)
def test_a_defect_wider_than_half_way_to_the_next_ball_is_not_told_as_the_rest_of_the_way(
    place, width
):
    found = fit(impact_train(width, place, 12.0), RATE, BEARING, 12.0, place=place, candidates=64)
    estimate = found.quantities['defect_width_mm']
    assert found.refusal is Kind.TOO_WIDE and not estimate.identifiable
    assert f'{1e3 * width:.1f} mm apart' in estimate.why and estimate.q95 > 1e3 * width


@pytest.mark.parametrize(('width', 'farther'), [(0.3e-3, 0.0), (9e-3, 9e-3)])
def test_a_limit_allows_for_impacts_beside_an_echo_that_are_no_rest_of_the_way_to_the_next_ball(
    width, farther
):
    """Each impact has an echo that makes the spacing doubtful."""
    x = impact_train(width, 'outer', 12.0, noise=0.0)
    late = round(0.25e-3 * RATE)
    x[late:] += 0.8 * np.diff(x, prepend=x[0])[:-late]
    machine = replace(cloud.example(), shaft_hz=12.0, sample_rate=RATE)
    whole = correlate(x, RATE)
    measured = whole.summary(machine.longest_spacing)
    refusal = unresolved(whole, measured, machine)
    assert refusal.longest_spacing * machine.speed == pytest.approx(farther, rel=0.01)
    left = without_spacing(measured, machine, candidates=32)
    estimate = of_defect(left, machine, measured, refusal)['defect_width_mm']
    assert 1e3 * width < estimate.q95 < 1e3 * width + 4.0


def test_candidates_that_rebound_leave_the_width_of_the_bare_passage_possible():
    """All kept candidates are narrower than the impacts are apart; the ball's path is not."""
    machine = cloud.example()
    x = 1e-3 * NOISE[:25600]
    x[200:25000:143] += 1.0
    x[220:25020:143] -= 0.7
    measured = summarise(x, machine.sample_rate, machine.longest_spacing)
    left = without_spacing(measured, machine, candidates=32)
    narrow = np.full(len(left.weights), 1.0)
    left = replace(left, values=left.values | {'defect_width_mm': narrow})
    estimate = of_defect(left, machine, measured, None)['defect_width_mm']
    apart, half = (1e3 * seconds * machine.speed for seconds in (measured.spacing, measured.lobe))
    assert apart > 1.5 and estimate.median == pytest.approx(1.0)
    assert estimate.q95 == pytest.approx(apart + 1e3 * spacing_shortfall(machine, 0.5))
    assert estimate.q05 <= apart - half
