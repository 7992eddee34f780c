# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The passage of a ball over a defect, against its geometry; and the candidates simulated."""

from dataclasses import replace
import math

from bearing_twin.bearing import Bearing, fault_frequencies, find_bearing
from bearing_twin.calibration.candidates import cloud
from bearing_twin.calibration.candidates.cloud import parameters, Situation, unknowns, vibrations
from bearing_twin.calibration.candidates.passage import (
    contact_speed,
    impact_spacing,
    interference,
    load_range,
    path_curvature,
)
from bearing_twin.dynamics import Defect, TwinParameters
from bearing_twin.dynamics.equations.coefficients import (
    CLEARANCE,
    CONDITION_SIZE,
    constants_of,
    evaluate,
    THERMAL_GAP,
)
from bearing_twin.dynamics.single.tables import defect_table
from bearing_twin.thermal.network import ThermalNetwork
from impact_trains import BEARING, RATE
import numpy as np
import pytest
from scipy.optimize import brentq


@pytest.mark.parametrize('degrees', [0.0, 40.0])
@pytest.mark.parametrize(('place', 'sign'), [('inner', 1.0), ('outer', -1.0)])
def test_sinking_is_the_path_of_a_ball_over_an_edge(place, sign, degrees):
    """The ball touches one point of the edge while its centre sinks along the contact normal."""
    bearing = replace(BEARING, contact_angle=math.radians(degrees))
    c, sine = math.cos(bearing.contact_angle), math.sin(bearing.contact_angle)
    radius, pitch, s = 0.5 * bearing.d_ball, 0.5 * bearing.d_pitch, 1e-4
    # Edge of the slot at angle zero of the race; the ball has rolled past it by s.
    race = pitch - sign * radius * c
    turn = s / race

    def to_edge(sunk):
        across, axial = pitch - sign * sunk * c, (radius - sunk) * sine
        around = across**2 + race**2 - 2.0 * across * race * math.cos(turn)
        return math.sqrt(around + axial**2) - radius

    sunk = brentq(to_edge, -1e-4, 1e-4, xtol=1e-15)
    assert sunk == pytest.approx(path_curvature(bearing, place) * s * s, rel=1e-3)


@pytest.mark.parametrize('name', ['6205', '7218B'])
def test_the_passage_has_the_contacts_of_the_twin(name):
    """The twin has gaps and approach along the radius; a ball loses contact at the same place."""
    bearing, load = find_bearing(name), 1000.0
    spalls = tuple(Defect(place=place, width=1e-3, depth=1e-4) for place in ('inner', 'outer'))
    p = TwinParameters(bearing=bearing, defects=spalls)
    approach = (4.37 * load / (bearing.n_balls * p.k_b0)) ** (2.0 / 3.0)
    for row, place in zip(defect_table(p), ('inner', 'outer'), strict=True):
        edge = interference(bearing, load) / path_curvature(bearing, place)
        assert edge == pytest.approx(approach / row[f'{place}_curvature'])
        assert row['depth'] / approach == pytest.approx(1e-4 / interference(bearing, load))


def test_spacing_is_short_of_the_slot_by_what_the_interference_asks_for():
    load, width = 200.0, 2e-3
    sinking = interference(BEARING, load)
    for place in ('inner', 'outer'):
        curvature = path_curvature(BEARING, place)
        apart = impact_spacing(width, sinking, curvature)
        edge = 0.5 * (width - apart)
        assert curvature * edge**2 == pytest.approx(sinking)
    assert impact_spacing(1e-4, sinking, path_curvature(BEARING, 'outer')) == 0.0


def test_contact_speed_times_passages_goes_round_the_race():
    rates = fault_frequencies(BEARING, 20.0)
    outer = math.pi * (BEARING.d_pitch + BEARING.d_ball)
    assert contact_speed(BEARING, 'outer', 20.0) == pytest.approx(
        outer * rates.bpfo / BEARING.n_balls
    )
    inner = math.pi * (BEARING.d_pitch - BEARING.d_ball)
    assert contact_speed(BEARING, 'inner', 20.0) == pytest.approx(
        inner * rates.bpfi / BEARING.n_balls
    )


def test_loads_without_a_range_are_shares_of_the_rating():
    low, high = load_range(BEARING)
    assert (low, high) == pytest.approx((42.0, 1400.0), rel=0.01)
    assert load_range(BEARING, (100.0, 200.0)) == (100.0, 200.0)


@pytest.mark.parametrize('name', ['6203', '6313', '6220', '7218B'])
def test_every_candidate_of_a_bearing_can_be_simulated(name):
    """Large bearings lose more clearance when hot; half of their balls is over 10 mm."""
    bearing = find_bearing(name)
    for place in ('inner', 'outer', 'none'):
        machine = Situation(bearing=bearing, place=place, shaft_hz=10.0, sample_rate=12800.0)
        prior = unknowns(machine)
        for share in (0.0, 0.5, 1.0):
            parameters(machine, {name: float(about.place(share)) for name, about in prior.items()})


def test_the_contact_angle_is_that_of_the_twin():
    """A ball of 40 degrees rolls where the fault frequencies have it."""
    bearing = find_bearing('7218B')
    rates = fault_frequencies(bearing, 10.0)
    track = bearing.d_pitch + bearing.d_ball * math.cos(bearing.contact_angle)
    assert contact_speed(bearing, 'outer', 10.0) == pytest.approx(math.pi * track * rates.ftf)


def test_a_long_simulation_in_blocks_is_the_one_in_a_piece(monkeypatch):
    machine = Situation(bearing=BEARING, place='outer', shaft_hz=20.0, sample_rate=RATE)
    values = {name: about.place(np.full(2, 0.5)) for name, about in unknowns(machine).items()}
    whole = next(vibrations(machine, values, 0.2, 1))
    monkeypatch.setattr(cloud, 'LONGEST_BLOCK', 1000)
    assert np.array_equal(next(vibrations(machine, values, 0.2, 1)), whole)


@pytest.mark.parametrize('d_pitch', [0.01, 0.02, 0.9, 2.0])
def test_the_clearances_assumed_are_those_of_a_twin_of_any_size_hot_and_cold(d_pitch):
    sized = Bearing(
        name='sized', n_balls=8, d_ball=0.2 * d_pitch, d_pitch=d_pitch, contact_angle=0.0
    )
    machine = Situation(bearing=sized, place='outer', shaft_hz=10.0, sample_rate=RATE)
    assumed = unknowns(machine)['clearance_um']
    for clearance in (assumed.low, assumed.high):
        p = TwinParameters(bearing=sized, clearance=1e-6 * clearance, thermal_mode='physical')
        constants, values = constants_of(p), np.empty(CONDITION_SIZE)
        hot = ThermalNetwork().scaled(d_pitch).inner_excess(110.0)
        evaluate(constants, 110.0, 110.0 + hot, 10.0, values)
        assert values[CLEARANCE] == values[THERMAL_GAP]
