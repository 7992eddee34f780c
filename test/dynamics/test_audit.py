# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin against the audit, which shares no code with it, and the paper's trends."""

from __future__ import annotations

from dataclasses import replace

import audit
from bearing_twin.bearing import fault_frequencies
from bearing_twin.dynamics import Fleet, preset, Simulator
from bearing_twin.dynamics.trend import amplitude_change, impact_amplitude, trend_sentence
from bearing_twin.thermal.gcr15 import Beta0
from cases import in_proofs
import numpy as np
import pytest

RATE = 25600.0
SPEEDS = (25.4, *in_proofs(22.0, 29.0))
STATED = {'expansion': -1, 'hardness': 1, 'friction': -1, 'all': -1}


def ideal(**changes):
    """Return the preset as the audit has it: no sensor, jitter, waviness or slip; its K_b0."""
    quiet = {
        'jitter': 0.0, 'noise': 0.0, 'waviness': 0.0, 'slip_model': 'none', 'resonance_hz': 0.0,
    }  # fmt: skip
    return preset('paper', **{**quiet, 'hertz_stiffness': audit.K_B0, **changes})


@pytest.mark.parametrize('shaft_hz', SPEEDS)
def test_the_twin_moves_as_the_audit_does(shaft_hz):
    hot = audit.housing(audit.beta0(110.0, 'ehf'), shaft_hz, 0.25)
    simulator = Simulator(ideal(), temperature=110.0, shaft_hz=shaft_hz)
    delay = round(simulator.delay * RATE)
    ours = simulator.advance(len(hot) + delay, 110.0, shaft_hz).y[delay:].astype(float)
    settled = slice(2560, None)
    error = np.linalg.norm(ours[settled] - hot[settled]) / np.linalg.norm(hot[settled])
    # What the decimation filter takes off near 12.8 kHz is in the audit.
    assert error < 0.03
    # No whole sample of delay more or less fits as well.
    for off in (-1, 1):
        shifted = np.roll(ours, off)[settled]
        assert np.linalg.norm(shifted - hot[settled]) > 2.0 * error * np.linalg.norm(hot[settled])


def test_every_place_at_once_under_a_turned_load_through_standstill():
    """Spalls of inner race, outer race and ball 0; the shaft stops and starts again."""
    braked, angle, rate = 0.12, -0.3, RATE
    defects = f'inner+outer:angle={audit.DOWN}+ball'
    parameters = ideal(load_angle=angle, defect=defects)
    n, found = round(braked * rate), []
    simulator = Simulator(parameters, shaft_hz=25.4)
    for fleet in (simulator, Fleet([parameters], seeds=[0], shaft_hz=25.4)):
        delay = round(simulator.delay * rate)
        blocks = [fleet.advance(n, 20.0, hz) for hz in (25.4, 0.0, 25.4)]
        blocks.append(fleet.advance(delay, 20.0, 25.4))
        for axis in 'xy':
            parts = [np.ravel(getattr(block, axis)) for block in blocks]
            found.append(np.concatenate(parts)[delay : 3 * n + delay - 1].astype(float))
    expected = [
        audit.housing(1.0, 25.4, 3.0 * braked, places=('inner', 'outer', 'ball'), braked=braked,
                      load_angle=angle, axis=axis) for axis in (0, 1)
    ]  # fmt: skip
    settled, still = slice(2560, len(found[0]) - 64), slice(2 * n - 40, 2 * n + 40)
    for i, ours in enumerate(found):
        theirs = expected[i % 2]
        error = np.linalg.norm(ours[settled] - theirs[: len(ours)][settled])
        assert error < 0.03 * np.linalg.norm(theirs[settled])
        assert np.abs(ours[still]).max() < 0.02 * np.abs(theirs).max()


@pytest.mark.parametrize('shaft_hz', SPEEDS)
@pytest.mark.parametrize(('factors', 'name'), [('e', 'expansion'), ('f', 'friction')])
def test_the_trends_are_those_of_the_audit(shaft_hz, factors, name):
    expected = audit.change(factors, shaft_hz)
    assert STATED[name] * expected > 0.0
    on = {each: each == name for each in ('expansion', 'hardness', 'friction')}
    found = []
    for temperature in (20.0, 110.0):
        simulator = Simulator(ideal(beta0=Beta0(**on)), temperature=temperature, shaft_hz=shaft_hz)
        delay = round(simulator.delay * RATE)
        y = simulator.advance(int(0.7 * RATE) + delay, temperature, shaft_hz).y[delay:]
        found.append(audit.amplitude(y[int(0.2 * RATE) :].astype(float), shaft_hz))
    assert found[1] / found[0] - 1.0 == pytest.approx(expected, rel=0.05, abs=5e-4)


@pytest.mark.parametrize('sensor', [True, False])
@pytest.mark.parametrize('shaft_hz', SPEEDS)
def test_every_trend_of_the_paper_holds_in_every_corner(shaft_hz, sensor):
    """Clearance 0 to 10 um, load +-20 %, two seeds with the default jitter, noise, surfaces."""
    # beta0 is 1 at 20 degC through expansion and through friction, so one run serves both.
    states = {'expansion': (20.0, 110.0), 'hardness': (20.0, 110.0), 'friction': (110.0,)}
    states['all'] = (110.0,)
    lanes, keys = [], []
    for clearance in (0.0, 10e-6):
        for load in (0.8, 1.2):
            for seed in (0, 1):
                for factor, temperatures in states.items():
                    on = {f: factor in (f, 'all') for f in ('expansion', 'hardness', 'friction')}
                    base = preset('paper')
                    one = replace(
                        base, clearance=clearance, load=load * base.load, slip_model='none',
                        beta0=Beta0(**on), resonance_hz=base.resonance_hz if sensor else 0.0,
                    )  # fmt: skip
                    for temperature in temperatures:
                        lanes.append((one, temperature, seed))
                        keys.append((clearance, load, seed, factor, temperature))
    temperatures = np.array([temperature for _, temperature, _ in lanes])
    fleet = Fleet(
        [one for one, _, _ in lanes], seeds=[seed for _, _, seed in lanes],
        temperatures=temperatures, shaft_hz=shaft_hz,
    )  # fmt: skip
    fleet.advance(int(0.3 * RATE), temperatures, shaft_hz)
    y = fleet.advance(int(3.0 * RATE), temperatures, shaft_hz).y
    passing = fault_frequencies(lanes[0][0].bearing, shaft_hz).bpfi
    found = {key: impact_amplitude(row, RATE, passing) for key, row in zip(keys, y, strict=True)}
    cold = {'expansion': 'expansion', 'hardness': 'hardness', 'friction': 'expansion'}
    cold['all'] = 'hardness'
    for *corner, factor, temperature in keys:
        if temperature == 110.0:
            change = found[(*corner, factor, 110.0)]
            change = change / found[(*corner, cold[factor], 20.0)] - 1.0
            assert STATED[factor] * change > 0.0, (corner, factor, change)


@pytest.mark.parametrize('shaft_hz', SPEEDS)
def test_presets_and_modes_say_which_way_they_move(shaft_hz):
    for mode, name, falls in (
        ('paper', 'paper', True), ('paper', 'incipient', False), ('physical', 'paper', True),
        ('physical', 'incipient', True), ('paper', 'mishra2017', False),
        ('paper', 'sawalhi2008', False),
    ):  # fmt: skip
        parameters = preset(name, thermal_mode=mode)
        assert (amplitude_change(parameters, shaft_hz) < 0.0) == falls, (mode, name)
        said = trend_sentence(parameters, shaft_hz)
        assert ('it falls, as the paper states' in said) == falls, said
        assert ("it rises, against the paper's statement" in said) != falls, said


def test_where_nothing_can_move_the_sentence_says_so():
    assert 'no defect' in trend_sentence(preset('paper', defect='none'), 25.4)
    assert 'not computed below 1 Hz' in trend_sentence(preset('paper'), 0.0)
