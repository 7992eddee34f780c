# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
import dataclasses
import math

from bearing_twin.bearing import Bearing
from bearing_twin.dynamics import Fleet, preset, PRESETS, Simulator
from bearing_twin.dynamics.equations.model import Contact
from bearing_twin.dynamics.equations.statics import force_and_stiffness, healthy_balls
from bearing_twin.dynamics.parameters import Defect, PROFILES
from bearing_twin.dynamics.reference import solve
from bearing_twin.dynamics.single.kernel import FAST_HZ
from bearing_twin.dynamics.trend import impact_amplitude
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.network import ThermalNetwork
from cases import in_proofs
import numpy as np
import pytest
from scipy.signal import hilbert

pytestmark = pytest.mark.usefixtures('reference')

RATE = 25600.0


def quiet(name='incipient', **changes):
    return preset(name, **({'jitter': 0.0, 'noise': 0.0, 'waviness': 0.0} | changes))


def relative(got, expected):
    return np.linalg.norm(got - expected) / np.linalg.norm(expected)


# --- against an independent solver -------------------------------------------------------------


@pytest.mark.parametrize(
    'parameters',
    [
        quiet(defect='inner+outer+ball+cage', unbalance=1e-3),
        quiet('mishra2017', bearing='6205', thermal_mode='physical'),
        quiet(defect='inner+outer', load_angle=0.7, outer_stiffness_x=4e6, outer_damping_x=900.0),
        *in_proofs(
            quiet(),
            quiet(defect='outer', load=2000.0, width=2.8e-3, depth=40e-6),
            quiet(defect='ball'),
            quiet('sawalhi2008', resonance_hz=0.0),
        ),
    ],
    ids=['all', 'physical', 'aslant', 'inner', 'outer', 'ball', 'no sensor'],
)
def test_agrees_with_an_adaptive_solver(parameters):
    samples, hz = 5120, FAST_HZ  # the fastest shaft with one step a sample has the largest error
    reference = solve(parameters, samples, temperature=60.0, shaft_hz=hz)
    block = Simulator(parameters, temperature=60.0, shaft_hz=hz).advance(samples, 60.0, hz)
    expected = np.array([reference.x, reference.y])
    assert relative(np.array([block.x, block.y]), expected) < 1e-3
    fleet = Fleet([parameters], temperatures=60.0, shaft_hz=hz).advance(samples, 60.0, hz)
    assert relative(np.array([fleet.x[0], fleet.y[0]]), expected) < 1e-3


@pytest.mark.parametrize('defect', ['outer', *in_proofs('inner')])
def test_the_paper_preset_agrees_too(defect):
    # A deep, wide defect under 3.2 kN loses contact harder: a fleet's fixed steps show it.
    parameters = quiet('paper', defect=defect)
    reference = solve(parameters, 2560, temperature=60.0, shaft_hz=25.4)
    expected = np.array([reference.x, reference.y])
    block = Simulator(parameters, temperature=60.0, shaft_hz=25.4).advance(2560, 60.0, 25.4)
    assert relative(np.array([block.x, block.y]), expected) < 1e-3
    fleet = Fleet([parameters], temperatures=60.0, shaft_hz=25.4).advance(2560, 60.0, 25.4)
    assert relative(np.array([fleet.x[0], fleet.y[0]]), expected) < 2e-3


# --- closed forms ------------------------------------------------------------------------------


@pytest.mark.parametrize('load', [50.0, 500.0, 5000.0])
def test_bearing_carries_its_load(load):
    simulator = Simulator(quiet(defect='none', load=load, slip_model='none'))
    simulator.advance(12800, 20.0, 25.4)
    forces = []
    turn = 1.0 / simulator.condition().bpfo
    for _ in range(512):  # eight ball passes
        simulator.advance(max(1, round(turn * RATE / 64)), 20.0, 25.4)
        condition = simulator.condition()
        angle = condition.cage_angle + 2.0 * np.pi * np.arange(8) / 8
        forces.append(-(condition.ball_force * np.sin(angle)).sum())
    assert np.mean(forces) == pytest.approx(load, rel=1e-3)


@pytest.mark.parametrize('turn', [math.pi / 2, math.pi, -math.pi / 2])
def test_a_machine_that_is_turned_as_a_whole_gives_the_signal_turned(turn):
    upright = quiet('paper', defect='inner+outer', outer_stiffness_x=1e7, outer_damping_x=1500.0)
    swapped = {}
    if abs(turn) < 3.0:
        swapped = {'outer_stiffness': 1e7, 'outer_stiffness_x': upright.outer_stiffness}
        swapped |= {'outer_damping': 1500.0, 'outer_damping_x': upright.outer_damping}
    lying = dataclasses.replace(
        upright,
        load_angle=upright.load_angle + turn,
        start_angle=upright.start_angle + turn,
        defects=tuple(
            dataclasses.replace(d, angle=d.angle + turn * (d.place == 'outer'))
            for d in upright.defects
        ),
        **swapped,
    )
    one, other = (Simulator(p).advance(5120, 40.0, 25.4) for p in (upright, lying))
    fleet = Fleet([upright, lying], seeds=[0, 0]).advance(5120, 40.0, 25.4)
    c, s = round(math.cos(turn)), round(math.sin(turn))
    for block, limit in ((one, 1e-5), (Fleet, 2e-3)):
        x, y = (fleet.x[0], fleet.y[0]) if block is Fleet else (one.x, one.y)
        turned = np.array([c * x - s * y, s * x + c * y])
        got = [fleet.x[1], fleet.y[1]] if block is Fleet else [other.x, other.y]
        assert relative(np.array(got), turned) < limit


@pytest.mark.parametrize('angle', [-math.pi / 2, 0.0, 0.7, 2.5])
def test_the_mean_force_has_the_load_s_size_and_direction(angle):
    # Softer across than along: the housing moves aside, the force does not.
    p = quiet(defect='none', load=2000.0, load_angle=angle, outer_stiffness_x=4e6)
    forces = []
    for position in np.arange(16) / 16.0 * math.tau / 8:
        at_rest = dataclasses.replace(p, start_angle=position)
        balls = Simulator(at_rest, shaft_hz=0.0).condition().ball_force
        angles = position + math.tau * np.arange(8) / 8
        forces.append([balls @ np.cos(angles), balls @ np.sin(angles)])
    expected = 2000.0 * np.array([math.cos(angle), math.sin(angle)])
    assert np.mean(forces, axis=0) == pytest.approx(expected, abs=2.0)


def test_free_motion_decays_to_static_equilibrium():
    parameters = quiet(defect='none', resonance_hz=0.0)
    simulator = Simulator(parameters, shaft_hz=0.0)
    at_rest = simulator.condition()
    assert np.abs(simulator.advance(2560, 20.0, 0.0).y).max() < 1e-6
    pushed = simulator.state.copy()
    pushed['v'] = 0.0, -1e-3, 0.0, 0.0
    simulator.continue_from(pushed, simulator.next_sample)

    def energy():
        inner, outer = simulator.state['v'][0].reshape(2, 2)
        return 0.5 * (6.2638 * (inner**2).sum() + 12.638 * (outer**2).sum())

    peaks = [
        max(energy() for _ in range(32) if simulator.advance(8, 20.0, 0.0)) for _ in range(40)
    ]
    assert peaks[-1] < 1e-6 * peaks[0]
    above_rounding = [peak for peak in peaks if peak > 1e-20 * peaks[0]]
    assert len(above_rounding) > 20
    assert all(
        later < 1.001 * sooner
        for sooner, later in zip(above_rounding, above_rounding[4:], strict=False)
    )
    assert simulator.condition().inner_y == pytest.approx(at_rest.inner_y, rel=1e-6)


def test_unbalance_alone_moves_the_rotor_at_shaft_speed_with_its_force():
    """Far below the resonances m_u e omega^2 reaches the housing through springs in series."""
    still = quiet(defect='none', resonance_hz=0.0, load=2000.0)
    turning = dataclasses.replace(still, unbalance=5e-3)
    samples = int(RATE)
    signals = []
    for parameters in (still, turning):
        simulator = Simulator(parameters, shaft_hz=25.0)
        simulator.advance(samples // 2, 20.0, 25.0)
        signals.append(simulator.advance(samples, 20.0, 25.0).x.astype(float))
    carrier = np.exp(-2j * np.pi * 25.0 * np.arange(samples) / RATE)
    line = 2.0 * abs(np.mean((signals[1] - signals[0]) * carrier))
    omega = 2.0 * np.pi * 25.0
    # The balls are a third spring; its mean over the cage's positions counts.
    values = Simulator(still, shaft_hz=25.0).condition()
    apart, contact = (values.inner_x, values.inner_y), Contact(values.k_b, damping=0.0)
    stiffness = np.mean(
        [
            force_and_stiffness(*apart, contact, healthy_balls(a, 5e-6, 8))[2]
            for a in np.linspace(0.0, math.pi / 4, 32, endpoint=False)
        ]
    )
    through = 1.0 / (1.0 / stiffness + 1.0 / 1.51e7)
    expected = 5e-3 * omega**2 * through / (through + 7.42e7) / 1.51e7 * omega**2
    assert line == pytest.approx(expected, rel=0.1)


# --- the start ---------------------------------------------------------------------------------


@pytest.mark.parametrize('places', ['inner', 'outer', 'inner+outer+ball+cage'])
@pytest.mark.parametrize('profile', ['ball', 'rect'])
def test_a_standing_shaft_is_silent_with_balls_over_defects(places, profile):
    simulator = Simulator(quiet(defect=places, profile=profile), shaft_hz=0.0)
    assert np.abs(simulator.advance(2560, 20.0, 0.0).y).max() < 1e-5
    struck = simulator.condition().ball_force
    assert struck[0] < struck.max() or places == 'outer'


@pytest.mark.parametrize('hz', [2.0, 10.0, 25.4, 60.0, 150.0, 500.0])
@pytest.mark.parametrize('name', ['incipient', 'paper'])
@pytest.mark.parametrize('place', ['inner', 'outer', 'ball'])
def test_start_and_reset_are_no_louder_than_what_follows(name, place, hz):
    simulator = Simulator(quiet(name, defect=place), shaft_hz=hz)
    simulator.advance(100, 20.0, hz)
    simulator.reset()
    first = simulator.advance(int(0.04 * RATE), 20.0, hz)
    later = simulator.advance(int(max(0.4, 3.0 / hz) * RATE), 20.0, hz)
    assert np.abs([first.x, first.y]).max() < 1.2 * np.abs([later.x, later.y]).max()


# --- determinism, damaged states ---------------------------------------------------------------


def test_seed_decides_the_noise_and_nothing_else_does():
    runs = [Simulator(preset('incipient'), seed=s).advance(512, 20.0, 25.4).y for s in (1, 1, 2)]
    assert np.array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


@pytest.mark.parametrize('keep', [0, 5, 30, 200, -1])
def test_damaged_state_is_refused_and_changes_nothing(keep):
    simulator = Simulator(preset('incipient'))
    simulator.advance(100, 30.0, 20.0)
    data = simulator.save()
    with pytest.raises(BearingTwinError):
        simulator.load(data[:keep])
    for at in range(0, len(data), 37):
        bad = bytearray(data)
        bad[at] ^= 0x10
        with pytest.raises(BearingTwinError):
            simulator.load(bytes(bad))
    assert simulator.save() == data
    for other in ({'bearing': '6205'}, {'bearing': '6203'}, {'thermal_mode': 'physical'}):
        with pytest.raises(BearingTwinError, match='belongs to another'):
            Simulator(preset('incipient', **other)).load(data)


# --- inputs ------------------------------------------------------------------------------------


@pytest.mark.parametrize('n_balls', [50, 60, 100])
def test_a_state_with_many_balls_is_taken_up_to_the_bit(n_balls):
    bearing = Bearing(name='slewing', n_balls=n_balls, d_ball=8e-3, d_pitch=0.3)
    parameters = quiet(bearing=bearing, defect='outer', load=2000.0)
    # So slow that the first balls and the last ones stay those that bear the load.
    whole, cut = (Simulator(parameters, shaft_hz=1.0) for _ in range(2))
    expected = whole.advance(600, 20.0, 1.0)
    first = cut.advance(250, 20.0, 1.0)
    again = Simulator(parameters)
    again.load(cut.save())
    assert np.array_equal(np.append(first.y, again.advance(350, 20.0, 1.0).y), expected.y)
    assert again.save() == whole.save()
    forces = whole.condition().ball_force
    assert forces[0] > 0.0
    assert forces[-1] > 0.0


@pytest.mark.parametrize('n_balls', [53, *in_proofs(60, 100)])
def test_many_balls_agree_with_an_adaptive_solver(n_balls):
    bearing = Bearing(name='slewing', n_balls=n_balls, d_ball=8e-3, d_pitch=0.3)
    parameters = quiet(bearing=bearing, defect='outer', load=2000.0, slip_model='none')
    reference = solve(parameters, 1280, temperature=20.0, shaft_hz=5.0)
    block = Simulator(parameters, shaft_hz=5.0).advance(1280, 20.0, 5.0)
    assert relative(np.array([block.x, block.y]), np.array([reference.x, reference.y])) < 2e-3


def test_a_fraction_of_a_ball_or_of_a_seed_is_refused():
    with pytest.raises(BearingTwinError, match=r'seed=1\.7 is not a whole number'):
        Simulator(preset('incipient'), seed=1.7)
    with pytest.raises(BearingTwinError, match=r'defect ball=1\.5 is not a whole number'):
        Defect(place='ball', width=1e-3, depth=2e-5, ball=1.5)
    # One that has been read from an array is whole.
    ball = np.arange(3)[2]
    assert Defect(place='ball', width=1e-3, depth=2e-5, ball=ball).ball == 2


@pytest.mark.parametrize('temperature', [19.9, 110.1, math.nan, math.inf])
def test_the_equations_never_see_a_bad_temperature(temperature):
    simulator = Simulator(preset('incipient'))
    before = simulator.save()
    with pytest.raises(BearingTwinError, match=r'20\.\.110'):
        simulator.advance(10, temperature, 25.4)
    with pytest.raises(BearingTwinError):
        simulator.advance(10, 20.0, math.nan)
    with pytest.raises(BearingTwinError):
        simulator.advance(0, 20.0, 25.4)
    assert simulator.save() == before


def test_a_temperature_step_is_a_ramp_over_its_block():
    simulator = Simulator(quiet(defect='none'), shaft_hz=0.0)
    simulator.advance(1024, 20.0, 0.0)
    jump = simulator.advance(1024, 110.0, 0.0)
    assert np.abs(np.diff(jump.y)).max() < 0.05  # a step of K_b would ring with many m/s^2


@pytest.mark.parametrize(
    'changes', [{'width': 9e-3}, {'defect': 'inner+roof'}, {'bearing': '6307x'}, {'unknown': 1.0}]
)
def test_a_preset_refuses_what_it_does_not_know(changes):
    with pytest.raises(BearingTwinError):
        preset('incipient', **changes)


# --- kinematics, slip, fault lines -------------------------------------------------------------


def squared_envelope_lines(signal):
    """Squared envelope spectrum of the band above 2 kHz, frequencies and amplitudes."""
    spectrum = np.fft.rfft(signal - signal.mean())
    spectrum[: int(2000.0 * len(signal) / RATE)] = 0.0
    envelope = np.abs(hilbert(np.fft.irfft(spectrum, len(signal)))) ** 2
    return np.fft.rfftfreq(len(signal), 1.0 / RATE), np.abs(
        np.fft.rfft((envelope - envelope.mean()) * np.hanning(len(signal)))
    )


def line_over_floor(frequencies, amplitudes, at):
    near = np.abs(frequencies - at) < 0.6
    around = (np.abs(frequencies - at) < 6.0) & (np.abs(frequencies - at) > 1.5)
    return amplitudes[near].max() / np.median(amplitudes[around])


@pytest.mark.parametrize(
    ('fault', 'order'), [('inner', 'bpfi'), ('outer', 'bpfo'), ('ball', '2bsf'), ('cage', 'ftf')]
)
def test_each_fault_shows_its_envelope_line(fault, order):
    def lines(defect):
        simulator = Simulator(preset('incipient', defect=defect, slip_model='none'), seed=4)
        simulator.advance(2560, 20.0, 25.4)
        block = simulator.advance(int(6 * RATE), 20.0, 25.4)
        c = block.condition
        at = 2.0 * c.bsf if order == '2bsf' else getattr(c, order)
        return line_over_floor(*squared_envelope_lines(block.y.astype(float)), at)

    assert lines(fault) > 10.0
    assert lines(fault) > 2.0 * lines('none')


@pytest.mark.parametrize(('temperature', 'expected'), [(20.0, 126.412), (100.0, 126.825)])
def test_slip_shifts_the_inner_line_as_the_paper_says(temperature, expected):
    parameters = quiet()
    simulator = Simulator(parameters, temperature=temperature)
    begin = simulator.condition()
    turns = 0.0
    last = begin
    for _ in range(200):
        simulator.advance(256, temperature, 25.4)
        now = simulator.condition()
        for sign, angle in ((1.0, 'shaft_angle'), (-1.0, 'cage_angle')):
            turns += sign * ((getattr(now, angle) - getattr(last, angle)) % (2.0 * np.pi))
        last = now
    measured = 8.0 * turns / (2.0 * np.pi) / (200 * 256 / RATE)
    assert measured == pytest.approx(expected, abs=0.01)
    assert now.bpfi == pytest.approx(measured, abs=1e-6)
    assert now.bpfi + now.bpfo == pytest.approx(8 * 25.4, abs=1e-9)


def test_shaft_angle_is_the_integral_of_a_ramped_speed():
    simulator = Simulator(quiet(), shaft_hz=10.0)
    begin = simulator.condition().shaft_angle
    end = simulator.advance(2560, 20.0, 37.0).condition.shaft_angle
    turns = (end - begin) / (2.0 * np.pi) - 0.1 * 0.5 * (10.0 + 37.0)
    assert turns - round(turns) == pytest.approx(0.0, abs=1e-9)


# --- temperature -------------------------------------------------------------------------------


def amplitude(parameters, temperature):
    """Impact amplitude over 3 s, m/s^2."""
    simulator = Simulator(parameters, temperature=temperature)
    simulator.advance(int(0.3 * RATE), temperature, 25.4)
    y = simulator.advance(int(3.0 * RATE), temperature, 25.4).y
    return impact_amplitude(y, RATE, 126.337)


def test_a_hotter_inner_ring_closes_the_clearance_and_weakens_the_impacts():
    def condition(ratio):
        parameters = quiet(
            thermal_mode='physical', clearance=8e-6, network=ThermalNetwork(shaft_ratio=ratio)
        )
        return parameters, Simulator(parameters, temperature=100.0).condition()

    cool, at_cool = condition(1.0)
    hot, at_hot = condition(1.12)
    gap = at_hot.inner_ring_temperature - at_cool.inner_ring_temperature
    assert gap == pytest.approx(0.8 * 0.12 * 80.0, rel=0.05)
    closed = at_cool.radial_clearance - at_hot.radial_clearance
    assert closed == pytest.approx(0.345e-6 * gap, rel=0.02)
    assert amplitude(hot, 100.0) < amplitude(cool, 100.0)


def test_inner_ring_follows_with_its_time_constant():
    simulator = Simulator(quiet(thermal_mode='physical'), temperature=30.0)
    start = simulator.condition().inner_ring_temperature
    steady = Simulator(quiet(thermal_mode='physical'), temperature=60.0)
    target = steady.condition().inner_ring_temperature
    simulator.advance(256, 60.0, 25.4)
    simulator.advance(int(8.0 * RATE), 60.0, 25.4)  # C_i / (G_io + G_is) = 8 s
    reached = simulator.condition().inner_ring_temperature
    assert (target - reached) / (target - start) == pytest.approx(math.exp(-1.0), abs=0.02)


@pytest.mark.parametrize('mode', ['paper', 'physical'])
def test_life_falls_with_temperature(mode):
    def life(temperature):
        parameters = quiet(thermal_mode=mode, load=3000.0)
        return Simulator(parameters, temperature=temperature).condition().life_hours

    assert life(20.0) > 5.0 * life(110.0) > 0.0


@pytest.mark.parametrize('profile', [p for p in PROFILES if p != 'ball'])
def test_a_preset_takes_the_profiles_of_the_literature(profile):
    ball, other = (
        Simulator(quiet(profile=p)).advance(5120, 20.0, 25.4).y for p in ('ball', profile)
    )
    assert relative(other, ball) > 0.1


# --- presets -----------------------------------------------------------------------------------


@pytest.mark.parametrize('name', list(PRESETS))
def test_presets_run(name):
    block = Simulator(preset(name)).advance(2048, 25.0, 25.4)
    assert 0.1 < block.y.std() < 1000.0


def test_fault_injected_while_running_is_there_at_once():
    simulator = Simulator(quiet(defect='none'))
    healthy = simulator.advance(5120, 20.0, 25.4).y
    simulator.reconfigure(quiet())
    spalled = simulator.advance(5120, 20.0, 25.4)
    assert spalled.first_sample == 5120
    assert spalled.y.std() > 5.0 * healthy.std()
    assert np.abs(spalled.y[:20]).max() < 10.0  # carried on, not started anew
