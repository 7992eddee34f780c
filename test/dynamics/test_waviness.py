# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Surfaces: their levels against the vibration test, and what they do to the signal."""

from bearing_twin.bearing import fault_orders
from bearing_twin.dynamics import Fleet, preset, Simulator
from bearing_twin.dynamics.equations.layout import SPIN_TURNS
from bearing_twin.dynamics.equations.waviness import profiles
from bearing_twin.dynamics.reference import solve
from bearing_twin.dynamics.single.kernel import FAST_HZ
from cases import in_proofs
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('reference')

RATE = 25600.0
BANDS = (50.0, 300.0), (300.0, 1800.0), (1800.0, 10000.0)


def on_the_test(p, seed):
    """
    Velocity in the three bands of a ring on ISO 15242's test, m/s, from the profiles alone.

    1800 rpm for a second, all balls loaded alike, so that the ring moves by 2/Z of the sum of the
    gaps.
    """
    turns = 30.0 * np.arange(51200) / 51200.0
    orders, n = fault_orders(p.bearing), p.bearing.n_balls
    outer, inner, balls = (gaps for gaps, _ in profiles(p, seed))
    moved = np.zeros(len(turns))
    for ball in range(n):
        cage = orders.ftf * turns + ball / n
        gap = 0.0
        for profile, at in (
            (outer[0], cage),
            (inner[0], cage - turns),
            (balls[ball], orders.bsf * turns / SPIN_TURNS),
        ):
            gap = gap + np.interp(
                at * len(profile), np.arange(len(profile)), profile, period=len(profile)
            )
        moved += 2.0 / n * gap * np.cos(2.0 * np.pi * cage)
    window = np.hanning(len(turns))
    hz = np.fft.rfftfreq(len(turns), 1.0 / 51200.0)
    velocity = np.abs(2.0 * np.pi * hz * np.fft.rfft(moved * window)) ** 2
    scale = 2.0 / (window**2).sum() / len(turns)
    return [velocity[(hz >= low) & (hz < high)].sum() * scale for low, high in BANDS]


@pytest.mark.parametrize('bearing', ['6307', '6205'])
def test_a_bearing_has_its_velocity_on_the_vibration_test(bearing):
    p = preset('paper', bearing=bearing, waviness=2e-4)
    squares = np.mean([on_the_test(p, seed) for seed in range(30)], axis=0)
    # A ball has no longer wave than two around it, and the contact bridges the shortest ones.
    assert np.sqrt(squares) == pytest.approx([1.7e-4, 2e-4, 1.8e-4], rel=0.15)


@pytest.mark.parametrize(
    ('name', 'bearing', 'defect'),
    [
        ('incipient', '6307', 'none'), ('paper', '6205', 'inner+ball'),
        *in_proofs(('incipient', '6307', 'inner+ball'), ('paper', '6205', 'none')),
    ],
)  # fmt: skip
def test_waviness_agrees_with_an_adaptive_solver(name, bearing, defect):
    """At this speed the shortest waves pass in three steps, and there is little else to hear."""
    p = preset(name, bearing=bearing, defect=defect, jitter=0.0, noise=0.0, load=1500.0)
    reference = solve(p, 2560, shaft_hz=FAST_HZ, seed=3)
    expected = np.array([reference.x, reference.y])
    block = Simulator(p, shaft_hz=FAST_HZ, seed=3).advance(2560, 20.0, FAST_HZ)
    fleet = Fleet([p], shaft_hz=FAST_HZ, seeds=[3]).advance(2560, 20.0, FAST_HZ)
    limit = 2e-3, 5e-3
    for found, most in zip(([block.x, block.y], [fleet.x[0], fleet.y[0]]), limit, strict=True):
        assert np.linalg.norm(np.array(found) - expected) < most * np.linalg.norm(expected)


def test_a_healthy_bearing_is_heard_above_1_khz():
    levels, high = [], []
    for seed in range(4):
        signal = Simulator(preset('paper', defect='none', noise=0.0), seed=seed)
        y = signal.advance(25600, 20.0, 25.4).y.astype(float)
        power = np.abs(np.fft.rfft(y * np.hanning(len(y)))) ** 2
        hz = np.fft.rfftfreq(len(y), 1.0 / RATE)
        levels.append(y.std())
        high.append(y.std() * np.sqrt(power[hz > 1000.0].sum() / power.sum()))
    # Healthy bearings of motors and pumps show some tenths of a g.
    assert 0.2 < np.mean(levels) < 2.0
    assert np.mean(high) > 0.1


def test_surfaces_scale_the_signal_and_the_seed_makes_them():
    def heard(waviness, seed):
        p = preset('incipient', defect='none', jitter=0.0, noise=0.0, waviness=waviness)
        return Simulator(p, seed=seed).advance(5120, 20.0, 25.4).y

    smooth, low, double, other = (
        heard(*each) for each in ((0, 1), (1e-5, 1), (2e-5, 1), (1e-5, 2))
    )
    assert (double - smooth).std() == pytest.approx(2.0 * (low - smooth).std(), rel=0.05)
    assert np.array_equal(heard(1e-5, 1), low)
    assert (other - low).std() > (low - smooth).std()


def test_a_standing_shaft_with_wavy_surfaces_is_silent():
    simulator = Simulator(preset('paper', noise=0.0), shaft_hz=0.0)
    assert np.abs(simulator.advance(2560, 20.0, 0.0).y).max() < 1e-5


def test_a_loaded_state_brings_its_surfaces():
    p = preset('paper', noise=0.0)
    one = Simulator(p, seed=1)
    expected = one.advance(1000, 20.0, 25.4).y
    saved = one.save()
    following = one.advance(1000, 20.0, 25.4).y
    other = Simulator(p, seed=2)
    other.load(saved)
    assert np.array_equal(other.advance(1000, 20.0, 25.4).y, following)
    other.reset()
    assert np.array_equal(other.advance(1000, 20.0, 25.4).y, expected)


def test_a_fleet_of_smooth_and_wavy_bearings_is_what_they_are_alone():
    several = [
        preset('incipient', defect='none', waviness=0.0),
        preset('incipient', defect='none'),
        preset('paper', bearing='6205'),
        preset('incipient', defect='outer', waviness=5e-4),
    ]
    fleet = Fleet(several, shaft_hz=20.0)
    saved = fleet.save()
    blocks = fleet.advance(2560, 20.0, 20.0).y
    again = Fleet(several, seeds=[9, 8, 7, 6], shaft_hz=20.0)
    again.load(saved)
    assert np.array_equal(again.advance(2560, 20.0, 20.0).y, blocks)
    for index, parameters in enumerate(several):
        alone = Simulator(parameters, seed=index, shaft_hz=20.0).advance(2560, 20.0, 20.0).y
        assert np.linalg.norm(blocks[index] - alone) < 5e-3 * np.linalg.norm(alone)
        condition = fleet.condition(index)
        twin = Simulator(parameters, seed=index, shaft_hz=20.0)
        twin.advance(2560, 20.0, 20.0)
        assert condition.ball_force == pytest.approx(
            twin.condition().ball_force, rel=0.01, abs=5.0
        )
