# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Strikes that come from elsewhere, whose harmonics lie where a fault's would."""

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.combs.candidate import Candidate
from bearing_twin.diagnosis.combs.comb import comb_scores, OrderSpectra
from bearing_twin.diagnosis.combs.expected_orders import ExpectedOrders
from bearing_twin.diagnosis.combs.harmonics import CombHarmonics, MISSING
from bearing_twin.diagnosis.combs.sidebands import CombSidebands
from bearing_twin.diagnosis.signal.lines import NEUTRAL
from bearing_twin.diagnosis.signal.shaft import ShaftSpeed
from half_pulses import measured
import numpy as np
import pytest

RATE = 25_600.0
SHAFT_HZ = 24.7
SECONDS = 4.0
N = int(RATE * SECONDS)
RING = np.exp(-900 * np.arange(300) / RATE) * np.sin(2 * np.pi * 5200 * np.arange(300) / RATE)


SEED = 31


def _strikes(order, rng, height=10.0, jitter=0.0):
    """Impacts ``order`` times a turn, each with its own height, rung by one mode."""
    count = int(order * SHAFT_HZ * SECONDS)
    at = (np.arange(count) + rng.uniform() + jitter * rng.standard_normal(count)) / order
    x = np.zeros(N)
    index = (at / SHAFT_HZ * RATE).astype(int)
    index = index[(index >= 0) & (index < N)]
    x[index] = height * (1.0 + 0.2 * rng.standard_normal(len(index)))
    return np.convolve(x, RING)[:N]


def _order(name, family, slip=0.01):
    orders = fault_orders(find_bearing(name), slip)
    return {'inner': orders.bpfi, 'outer': orders.bpfo, 'ball': 2.0 * orders.bsf}[family]


@pytest.mark.parametrize('parts', [4, 5, 6, 7, 9, 12])
@pytest.mark.parametrize(
    ('name', 'family'), [('6205', 'outer'), ('6205', 'ball'), ('NICE', 'inner')]
)
def test_harmonic_of_slower_strikes_is_no_fault(rng, name, family, parts):
    x = _strikes(_order(name, family) / parts, rng) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(name), SHAFT_HZ)
    assert said.level != 'fault', said.reasons


@pytest.mark.parametrize('multiple', [2.0, 3.0, 4.0, 1.5, 0.8, 1.25])
@pytest.mark.parametrize(('name', 'family'), [('6205', 'ball'), ('NICE', 'inner')])
def test_comb_without_its_odd_teeth_is_no_fault(rng, name, family, multiple):
    x = _strikes(multiple * _order(name, family), rng) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(name), SHAFT_HZ)
    assert said.level != 'fault', said.reasons


@pytest.mark.parametrize('off', [-0.018, -0.012, -0.004, 0.004, 0.012, 0.018])
@pytest.mark.parametrize('name', ['6203', 'UER204'])
def test_impact_once_a_turn_of_a_shaft_beside_its_nameplate_is_no_fault(rng, name, off):
    x = _strikes(1.0, rng, jitter=0.001) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing(name), SHAFT_HZ * (1.0 + off))
    assert said.level != 'fault', said.reasons


@pytest.mark.parametrize(('family', 'slip'), [('inner', 0.01), ('outer', 0.01), ('ball', 0.015)])
@pytest.mark.parametrize('elsewhere', [0.83, 1.27, 0.37])
def test_fault_among_strikes_from_elsewhere_is_named(rng, family, slip, elsewhere):
    x = _strikes(_order('6205', family, slip), rng, 6.0, jitter=0.01)
    x += _strikes(elsewhere, rng, 6.0) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing('6205'), SHAFT_HZ, speed_tolerance=0.002)
    assert said.faults == (family,), said.reasons


def test_strikes_from_elsewhere_do_not_hide_a_fault(rng):
    """The seventh harmonic of a belt lies at the outer race's order, the inner race is damaged."""
    belt = _strikes(_order('6205', 'outer') / 7.0, rng, 12.0)
    x = belt + _strikes(_order('6205', 'inner'), rng, 6.0, jitter=0.01) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing('6205'), SHAFT_HZ, speed_tolerance=0.002)
    assert said.faults == ('inner',), said.reasons


def test_ball_that_strikes_one_race_only_is_named(rng):
    """Its lines are multiples of the spin, twice as dense as those of both strikes."""
    x = _strikes(0.5 * _order('6205', 'ball'), rng, jitter=0.003) + rng.standard_normal(N)
    said = diagnose_record(x, RATE, find_bearing('6205'), SHAFT_HZ, speed_tolerance=0.002)
    assert said.faults == ('ball',), said.reasons


def _spectra(rng, lines, excess=6.0):
    """Noise with lines that stand so many times over the floor."""
    power = rng.exponential(size=(3000, 3))
    at = np.rint(np.asarray(lines) / 0.01).astype(int) - 1
    power[at[(at >= 0) & (at < 3000)]] *= 1.0 + excess
    return _of_logs(np.log1p(power))


def _of_logs(logs):
    """Spectra with some log scores, 0.01 orders apart."""
    blank = np.zeros(logs.shape, np.float32)
    return OrderSpectra(0.01, logs.astype(np.float32), blank, blank[0])


def _harmonics(spectra, uncertainty=0.002, tolerance=0.02, whitenings=3):
    """Harmonics of the combs of a 6205, in spectra without lines of its shaft."""
    expected = ExpectedOrders(find_bearing('6205'), uncertainty)
    speed = ShaftSpeed(SHAFT_HZ, uncertainty, 0.0, tolerance)
    scores = comb_scores(spectra.off_shaft, 7.0, whitenings)
    return CombHarmonics(spectra, speed, expected, scores, CombSidebands(spectra, expected))


def _inner(order):
    return Candidate('inner', order, 0.0, 9.0, 0.8)


def test_comb_of_its_own_is_seldom_denied(rng):
    denied = 0
    for _ in range(400):
        order = rng.uniform(2.5, 6.5)
        harmonics = _harmonics(_spectra(rng, order * np.arange(1, 5)))
        denied += harmonics.extraneous_order(_inner(order)) > 0.0
    assert denied <= 8


def test_denser_series_is_found_with_its_order(rng):
    # No line between its harmonics lies on a multiple of the shaft.
    order = 4.58
    for parts in (2, 3, 5, 8, 13):
        spectra = _spectra(rng, order / parts * np.arange(1, 4 * parts + 1), 40.0)
        found = _harmonics(spectra).extraneous_order(_inner(order))
        assert found == pytest.approx(order / parts)


def test_missing_harmonics_tell_the_true_order(rng):
    for multiple in (2, 3, 4):
        harmonics = _harmonics(_spectra(rng, 4.57 * multiple * np.arange(1, 3), 100.0))
        found = harmonics.multiple(4.57)
        assert found > 1
        assert found % multiple == 0
        assert harmonics.extraneous_order(_inner(4.57)) == pytest.approx(4.57 * found)


def test_harmonics_are_missed_where_their_series_is_highest(rng):
    """The best of many bands of a comb is one whose noise is high at the missing harmonics."""
    order, bands = 3.023, 50
    heights = np.full((3000, bands), NEUTRAL) + 0.3 * rng.standard_normal((3000, bands))
    rows = np.rint(order * np.arange(1, 5) / 0.01).astype(int) - 1
    heights[rows[1::2]] = 4.0 + NEUTRAL
    # Chance, and the tail of an eccentric pulse: the comb is highest here.
    heights[rows[::2], 18] = 1.5 + NEUTRAL
    pulses = _harmonics(_of_logs(heights), whitenings=1)
    assert pulses.columns(order) == [18]
    assert pulses.columns(2.0 * order) != [18]
    assert pulses.multiple(order) == 2
    # Where both are highest in the same band the others in which the series is clear tell.
    loud = heights.copy()
    loud[rows[1::2], 18] = 5.0 + NEUTRAL
    both = _harmonics(_of_logs(loud), whitenings=1)
    assert both.columns(order) == both.columns(2.0 * order) == [18]
    assert both.multiple(order) == 2
    # A fault has them all; pulses at twice its order in another band do not hide it.
    heights[rows, 18] = 4.5 + NEUTRAL
    assert _harmonics(_of_logs(heights), whitenings=1).multiple(order) == 1


def test_comb_beside_the_shaft_needs_to_stand_out(rng):
    impacts = _spectra(rng, np.arange(1.0, 21.0), 40.0)
    assert _harmonics(impacts, tolerance=0.002).masked_by_shaft(_inner(5.002))
    fault = _spectra(rng, [1.0, 2.0, 5.03, 10.06, 15.09, 20.12], 40.0)
    assert not _harmonics(fault, uncertainty=0.02).masked_by_shaft(_inner(5.03))
    # Lines at 1.006 and its multiples are no shaft's that is known to 0.2 %.
    other = _spectra(rng, 1.006 * np.arange(1.0, 21.0), 40.0)
    assert _harmonics(other, uncertainty=0.02).masked_by_shaft(_inner(5.03))
    assert not _harmonics(other, tolerance=0.002).masked_by_shaft(_inner(5.03))


def test_harmonics_beyond_the_spectrum_are_not_counted_as_noise(rng):
    """A spectrum up to 30 orders holds two harmonics of impacts at 12.3 orders."""
    harmonics = _harmonics(_spectra(rng, [12.3, 24.6], 40.0))
    assert harmonics.impacts(Candidate('elsewhere', 12.3, 0.0, 9.0, 0.8)) > 1.0
    assert harmonics.impacts(Candidate('elsewhere', 6.15, 0.0, 9.0, 0.8)) > 0.5
    # None of them is in the spectrum: nothing is known.
    assert harmonics.impacts(Candidate('elsewhere', 20.3, 0.0, 9.0, 0.8)) == 0.0


def test_pulses_at_twice_the_order_of_a_race_are_no_alarm_and_faults_are():
    """The limit of missing harmonics rests on such records."""
    pulses = [found for n in range(20, 40) if (found := measured('pulses', n))]
    assert len(pulses) > 6
    assert not any(alarm for _, alarm in pulses)
    for kind in ('fault', 'two edges'):
        faults = [found for n in range(6) if (found := measured(kind, n))]
        assert len(faults) > 3
        assert all(height > MISSING for height, _ in faults)
        assert sum(alarm for _, alarm in faults) >= len(faults) - 1
