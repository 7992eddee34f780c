# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Strikes that come from elsewhere, whose harmonics lie where a fault's would."""

from dataclasses import replace

from bearing_twin.bearing import fault_orders, find_bearing
from bearing_twin.diagnosis import diagnose_record
from bearing_twin.diagnosis.combs.candidate import Candidate
from bearing_twin.diagnosis.combs.comb import OrderSpectra
from bearing_twin.diagnosis.combs.harmonics import (
    denser_series,
    masked_by_shaft,
    MISSING,
    missing_harmonics,
)
from bearing_twin.diagnosis.combs.search import CombSearch
from bearing_twin.diagnosis.signal.lines import NEUTRAL
from bearing_twin.diagnosis.signal.shaft import ShaftSpeed
from bearing_twin.studies.half_pulses import measured
import numpy as np
import pytest

RATE = 25_600.0
SHAFT_HZ = 24.7
SECONDS = 4.0
N = int(RATE * SECONDS)
RING = np.exp(-900 * np.arange(300) / RATE) * np.sin(2 * np.pi * 5200 * np.arange(300) / RATE)
COLUMNS = np.array([0, 1, 2])
KNOWN = {'precision': 0.0005, 'uncertainty': 0.002}


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
    step, count = 0.01, 3000
    power = rng.exponential(size=(count, 3))
    at = np.rint(np.asarray(lines) / step).astype(int) - 1
    power[at[(at >= 0) & (at < count)]] *= 1.0 + excess
    logs = np.log1p(power).astype(np.float32)
    return OrderSpectra(step, logs, np.zeros((count, 2), np.float32), np.zeros(1, np.float32))


def test_comb_of_its_own_is_seldom_denied(rng):
    nothing = np.zeros(3000, bool)
    denied = 0
    for _ in range(400):
        order = rng.uniform(2.5, 6.5)
        spectra = _spectra(rng, order * np.arange(1, 5))
        denied += missing_harmonics(spectra, order, COLUMNS, lambda _: COLUMNS, nothing) > 1
        denied += denser_series(spectra, order, COLUMNS, nothing, nothing, nothing, 0.002) > 0.0
    assert denied <= 8


def test_denser_series_is_found_with_its_order(rng):
    nothing = np.zeros(3000, bool)
    for parts in (2, 3, 5, 8, 13):
        order = 4.57
        spectra = _spectra(rng, order / parts * np.arange(1, 4 * parts + 1), 40.0)
        found = denser_series(spectra, order, COLUMNS, nothing, nothing, nothing, 0.002)
        assert found == pytest.approx(order / parts)
        # Sidebands that the candidate explains fade: these do not.
        everywhere = np.ones(3000, bool)
        again = denser_series(spectra, order, COLUMNS, nothing, nothing, everywhere, 0.002)
        assert again == found


def test_missing_harmonics_tell_the_true_order(rng):
    nothing = np.zeros(3000, bool)
    for multiple in (2, 3, 4):
        spectra = _spectra(rng, 4.57 * multiple * np.arange(1, 3), 100.0)
        found = missing_harmonics(spectra, 4.57, COLUMNS, lambda _: COLUMNS, nothing)
        assert found > 1
        assert found % multiple == 0


def test_harmonics_are_missed_where_their_series_is_highest(rng):
    """The best of many bands of a comb is one whose noise is high at the missing harmonics."""
    nothing, order, bands = np.zeros(3000, bool), 3.023, 50
    heights = np.full((3000, bands), NEUTRAL) + 0.3 * rng.standard_normal((3000, bands))
    rows = np.rint(order * np.arange(1, 5) / 0.01).astype(int) - 1
    heights[rows[1::2]] = 4.0 + NEUTRAL
    # Chance, and the tail of an eccentric pulse: the comb is highest here.
    heights[rows[::2], 18] = 1.5 + NEUTRAL
    blank = np.zeros(1, np.float32)
    spectra = OrderSpectra(0.01, heights.astype(np.float32), np.zeros((3000, bands)), blank)

    def highest(fundamental):
        at = np.rint(fundamental * np.arange(1, 5) / 0.01).astype(int) - 1
        return np.array([heights[at].sum(axis=0).argmax()])

    assert highest(order) == 18
    assert highest(2.0 * order) != 18
    assert missing_harmonics(spectra, order, highest(order), highest, nothing) == 2
    # Where both are highest in the same band the others in which the series is clear tell.
    loud = replace(spectra, logs=spectra.logs.copy())
    loud.logs[rows[1::2], 18] = 4.1 + NEUTRAL

    def same(_):
        return np.array([18])

    def clear(_):
        return np.arange(bands)

    assert missing_harmonics(loud, order, same(order), same, nothing) == 1
    assert missing_harmonics(loud, order, same(order), clear, nothing) == 2
    # A fault has them all; pulses at twice its order in another band do not hide it.
    heights[rows, 18] = 4.5 + NEUTRAL
    fault = OrderSpectra(0.01, heights.astype(np.float32), spectra.excess, blank)
    assert missing_harmonics(fault, order, highest(order), highest, nothing) == 1


def test_comb_beside_the_shaft_needs_to_stand_out(rng):
    impacts = _spectra(rng, np.arange(1.0, 21.0), 40.0)
    unknown = {'precision': 0.02, 'uncertainty': 0.02}
    assert masked_by_shaft(impacts, 5.002, COLUMNS, **KNOWN)
    fault = _spectra(rng, [1.0, 2.0, 5.03, 10.06, 15.09, 20.12], 40.0)
    assert not masked_by_shaft(fault, 5.03, COLUMNS, **unknown)
    # Lines at 1.006 and its multiples are no shaft's that is known to 0.05 %.
    other = _spectra(rng, 1.006 * np.arange(1.0, 21.0), 40.0)
    assert masked_by_shaft(other, 5.03, COLUMNS, **unknown)
    assert not masked_by_shaft(other, 5.03, COLUMNS, **KNOWN)


def test_harmonics_beyond_the_spectrum_are_not_counted_as_noise(rng):
    """A spectrum up to 30 orders holds two harmonics of impacts at 12.3 orders."""
    power = rng.exponential(size=(3000, 2))
    power[[1229, 2459]] *= 41.0
    spectra = OrderSpectra(
        0.01,
        np.log1p(power).astype(np.float32),
        np.zeros((3000, 1), np.float32),
        np.zeros(1, np.float32),
    )
    search = CombSearch(spectra, find_bearing('6205'), ShaftSpeed(SHAFT_HZ, 0.0005, 0.0, 0.002))
    assert search.harmonics.impacts(Candidate('elsewhere', 12.3, 0.0, 9.0, 0.8)) > 1.0
    assert search.harmonics.impacts(Candidate('elsewhere', 6.15, 0.0, 9.0, 0.8)) > 0.5
    # None of them is in the spectrum: nothing is known.
    assert search.harmonics.impacts(Candidate('elsewhere', 20.3, 0.0, 9.0, 0.8)) == 0.0


def test_pulses_at_twice_the_order_of_a_race_are_no_alarm_and_faults_are():
    """Some of the records of the study that the limit of missing harmonics rests on."""
    pulses = [found for n in range(20, 40) if (found := measured('pulses', n))]
    assert len(pulses) > 6
    assert not any(alarm for _, alarm in pulses)
    for kind in ('fault', 'two edges'):
        faults = [found for n in range(6) if (found := measured(kind, n))]
        assert len(faults) > 3
        assert all(height > MISSING for height, _ in faults)
        assert sum(alarm for _, alarm in faults) >= len(faults) - 1
