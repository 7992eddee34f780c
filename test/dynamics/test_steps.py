# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the integrator parts its steps, and where it goes over from long to short ones."""

import math

from bearing_twin.bearing import fault_orders
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.dynamics.equations import coefficients
from bearing_twin.dynamics.reference import solve
from bearing_twin.dynamics.single.kernel import FAST_HZ
from bearing_twin.dynamics.single.kinematics import kinks
from cases import in_proofs
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('reference')

RATE = 25600.0
BELOW, ABOVE = FAST_HZ - 0.1, FAST_HZ + 0.1


def quiet(**changes):
    return preset('incipient', **({'jitter': 0.0, 'noise': 0.0, 'waviness': 0.0} | changes))


def along_inner_race(p, values, hz, times):
    """Distance of each ball from the centre of the spall on the inner race, (balls, n), m."""
    omega, b = 2.0 * math.pi * hz, p.bearing
    turned = omega * (1.0 - fault_orders(b, values[coefficients.SLIP]).ftf) * times
    balls = 2.0 * math.pi * np.arange(b.n_balls)[:, None] / b.n_balls
    angle = balls - turned - p.defects[0].angle
    return ((angle + math.pi) % (2.0 * math.pi) - math.pi) * 0.5 * (b.d_pitch - b.d_ball)


def contact(p, values, hz, times, states):
    """By how much each ball is pressed together, m, and whether it is loaded; (balls, n)."""
    b, spall = p.bearing, p.defects[0]
    cage = 2.0 * math.pi * hz * fault_orders(b, values[coefficients.SLIP]).ftf
    angles = p.start_angle + cage * times
    angles = angles + 2.0 * math.pi * np.arange(b.n_balls)[:, None] / b.n_balls
    edge = np.maximum(0.5 * spall.width - abs(along_inner_race(p, values, hz, times)), 0.0)
    path = edge**2 * (1.0 / b.d_ball + 1.0 / (b.d_pitch - b.d_ball))
    gap = values[coefficients.CLEARANCE] + values[coefficients.DEPTH] * np.minimum(
        path, spall.depth
    )
    x, y, vx, vy = (states[i] - states[i + 2] for i in (0, 1, 4, 5))
    c, s = np.cos(angles), np.sin(angles)
    delta = x * c + y * s - gap
    force = values[coefficients.K_B] * np.maximum(delta, 0.0) ** 1.5 + p.contact_damping * (
        vx * c + vy * s
    )
    return delta, (delta > 0.0) & (force > 0.0)


@pytest.mark.parametrize('hz', [BELOW, *in_proofs(ABOVE)])
def test_contact_is_lost_and_found_when_an_adaptive_solver_finds_it(hz):
    """
    Of the balls loaded at a sample, the one nearest to the end or the beginning of its contact.

    By its approach over the rate of that, which just after an event is the time since then.
    """
    p, samples = quiet(resonance_hz=0.0), 3072
    simulator = Simulator(p, shaft_hz=hz)
    values = simulator.values
    near, loaded = np.empty(samples), np.empty(samples, np.int64)
    for k in range(samples):
        simulator.advance(1, 20.0, hz)
        state = simulator.state[0]
        near[k], loaded[k] = state['near'], state['loaded']
    states = solve(p, samples, shaft_hz=hz).states[:, 2::3]
    times, soon = np.arange(1, samples + 1) / RATE, 2e-6

    def at(shift):
        moved = states.copy()
        moved[:4] += shift * states[4:8]
        return contact(p, values, hz, times + shift, moved)

    (before, was), (delta, expected), (after, will) = at(-soon), at(0.0), at(soon)
    certain = (was == will).all(axis=0)
    assert certain.mean() > 0.98
    bits = (expected << np.arange(8)[:, None]).sum(axis=0)
    assert np.count_nonzero(np.diff(bits)) > 20
    assert np.array_equal(loaded[certain], bits[certain])
    since = np.abs(delta / (after - before)) * 2.0 * soon
    expected_near = np.where(expected, since, np.inf).min(axis=0)
    close = certain & (expected_near < 2.0 / RATE)
    assert np.count_nonzero(close) > 20
    assert np.abs(near - expected_near)[close].max() < 5e-7


@pytest.mark.parametrize('hz', [BELOW, ABOVE])
def test_kinks_are_where_the_path_has_them(hz):
    p = quiet()
    simulator = Simulator(p, shaft_hz=hz)
    values, found = simulator.values, np.empty(32)
    tables, state = simulator.tables, simulator.state[0]
    machine, defect = tables.machines[0], tables.defects[0]
    h = machine['step']
    orders = fault_orders(p.bearing, values[coefficients.SLIP])
    rates = hz * orders.ftf, hz, hz * orders.bsf
    edges = defect['half'], defect['inner_kink']
    begin = np.array([state[name] for name in ('cage', 'shaft', 'spin')])
    instants = []
    for step in range(2560):
        phases = tuple(begin + step * h * np.array(rates))
        n = kinks(machine, tables.defects, phases, rates, found)
        instants += list(step * h + found[:n])
    instants = np.array(instants)
    distance = abs(along_inner_race(p, values, hz, instants)).min(axis=0)
    assert np.abs(distance[:, None] - edges).min(axis=1).max() < 1e-12
    # Each ball that passes meets four of them.
    passes = 0.1 * hz * 8.0 * (1.0 - orders.ftf)
    assert abs(len(instants) - 4.0 * passes) <= 4.0
    assert (np.diff(instants) > 0.0).all()


@pytest.mark.parametrize('mode', ['paper', 'physical'])
def test_same_bits_however_a_run_over_the_switch_is_cut(mode):
    """Ramps that end within a chunk of the grid, then held; every cut is saved and restored."""

    def build():
        return Simulator(preset('incipient', thermal_mode=mode), seed=3, shaft_hz=BELOW)

    def run(cuts):
        simulator, signal, short = build(), [], []
        for hz in (ABOVE, BELOW, ABOVE + 2.0, BELOW - 2.0):
            for n in (1000, *cuts):
                signal.append(simulator.advance(n, 40.0, hz).y)
                short.append(simulator.state['next_step'][0])
                if len(cuts) > 1:
                    saved = simulator.save()
                    simulator = build()
                    simulator.load(saved)
        return np.concatenate(signal), simulator.save(), short

    whole, cut = run([713]), run([1, 30, 33, 300, 349])
    assert np.array_equal(whole[0], cut[0])
    assert whole[1] == cut[1]
    steps = set(np.round(np.array(whole[2]) * RATE * 3.0))
    assert steps == {1.0, 3.0}  # both were in use


def test_equal_steps_converge_to_the_adaptive_solver():
    exact = np.array(solve(quiet(), 2560)[:2])
    runs = [solve(quiet(), 2560, steps=steps) for steps in (1, 2, 4)]
    errors = [np.linalg.norm(run[:2] - exact) / np.linalg.norm(exact) for run in runs]
    assert errors[0] < 1e-2
    assert errors[2] < 0.25 * errors[0]
    assert errors[2] < 5e-4
    assert all(run.cost > 0.0 for run in runs)
