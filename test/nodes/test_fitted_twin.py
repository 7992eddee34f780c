# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A running twin takes a calibration: without a jump, and so that its recording is verified."""

from itertools import pairwise
import json
import time

import numpy as np
import pytest

pytest.importorskip('rclpy', reason='ROS 2 is not installed')

from bearing_twin.assets.calibration.fitted import read_fitted_model
from bearing_twin.assets.parameters.twin import SPECS
from bearing_twin.assets.twin import Twin
from bearing_twin.bearing import find_bearing
from bearing_twin.calibration import fit
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.dynamics.equations.sensor_path import (
    band_levels,
    distance,
    PathFilter,
    SensorPath,
)
from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.twin import TwinNode
from bearing_twin.offline.verify import reproduce
from bearing_twin.ros.health import Level
from bearing_twin.ros.topics.qos import RESULT
from bearing_twin_msgs.msg import Calibration
from probe import DEEP
from scipy import signal

RATE, SHAFT = 25600.0, 25.0
VALUES = {spec.name: spec.default for spec in SPECS} | {
    'bearing': '6205', 'preset': 'incipient', 'shaft_hz': SHAFT, 'start_temperature': 40.0,
}  # fmt: skip


@pytest.fixture(scope='module')
def machine():
    """Vibration of a machine with a slot of 2 mm, in g, whose sensor rings at 4 kHz."""
    hidden = preset('incipient', bearing='6205', defect='inner', width=2e-3, load=300.0)
    simulator = Simulator(hidden, seed=5, shaft_hz=SHAFT, temperature=40.0)
    x = simulator.advance(6 * 25600, 40.0, SHAFT).y.astype(float)[25600:] / 9.81
    pole = np.exp(2.0 * np.pi * 4000.0 / RATE * (-0.03 + 1j))
    return 0.2 * signal.lfilter([1.0], np.poly([pole, pole.conjugate()]).real, x)


@pytest.fixture(scope='module')
def calibration(machine):
    """Return the JSON of a fit."""
    found = fit(
        machine, RATE, find_bearing('6205'), SHAFT, unit='g', temperature=40.0, place='inner',
        candidates=64,
    )  # fmt: skip
    return json.dumps(found.to_dict())


def run(twin, blocks):
    return np.concatenate([twin.advance().block.y for _ in range(blocks)])


def test_the_filter_is_that_of_scipy_in_any_blocks():
    numerator, denominator = (0.5, 0.2, -0.1, 0.3), (1.0, -0.9, 0.4)
    x = np.random.default_rng(1).standard_normal(1000)
    path = SensorPath(sample_rate=RATE, numerator=numerator, denominator=denominator, noise=0.0)
    expected = signal.lfilter(numerator, denominator, x)
    np.testing.assert_allclose(path.filter().apply(x), expected, atol=1e-12)
    parts = PathFilter(path)
    again = np.concatenate([parts.apply(part) for part in np.array_split(x, 7)])
    assert (again == path.filter().apply(x)).all()


def test_levels_are_those_of_welch():
    x = np.random.default_rng(1).standard_normal(30000)
    _, density = signal.welch(x, RATE, nperseg=256)
    np.testing.assert_allclose(band_levels(x, RATE), 10.0 * np.log10(density), atol=1e-6)


def test_a_running_twin_takes_a_calibration_without_a_jump(machine, calibration):
    twin, other = Twin(VALUES), Twin(VALUES)
    before = run(twin, 50)
    run(other, 50)
    twin.take(read_fitted_model(calibration))
    changing = run(twin, 1)
    after = run(twin, 60)
    # No step larger than those of the signal itself, at the seams and within.
    own = max(np.abs(np.diff(before)).max(), np.abs(np.diff(after)).max())
    assert np.abs(np.diff(np.concatenate([before[-1:], changing, after[:1]]))).max() <= own
    # Sequence and phase go on as if nothing had happened.
    run(other, 61)
    assert twin.simulator.next_sample == other.simulator.next_sample == 111 * 1024
    here, there = twin.simulator.condition(), other.simulator.condition()
    assert here.shaft_angle == there.shaft_angle
    # It passes for the machine, in its unit, and says so; as it was it did not.
    levels = band_levels(machine, RATE)
    similarity = twin.sensor.similarity()
    assert twin.unit == 'g'
    assert similarity.distance == pytest.approx(
        distance(band_levels(after[-51200:], RATE), levels)
    )
    assert similarity.distance < 1.5 and abs(similarity.level) < 1.0
    assert distance(band_levels(before, RATE), levels) > 6.0
    # Given up, it is the twin of its parameters again.
    twin.take(None)
    run(twin, 60)
    assert twin.unit == 'm/s^2' and twin.fitted_model is None
    assert twin.simulator.parameters == other.simulator.parameters
    now, then = run(twin, 25), run(other, 85)[-25 * 1024 :]
    assert now.std() == pytest.approx(then.std(), rel=0.1)


def test_a_state_saved_in_between_goes_on_to_the_byte(calibration):
    twin = Twin(VALUES)
    run(twin, 3)
    twin.take(read_fitted_model(calibration))
    for _ in range(3):
        again = Twin(VALUES)
        again.load(twin.save())
        assert (run(again, 2) == run(twin, 2)).all()
        assert again.unit == twin.unit == 'g'
    bare = Twin(VALUES).save()
    twin.load(bare)
    assert twin.fitted_model is None and twin.save() == bare
    with pytest.raises(BearingTwinError, match='truncated or damaged'):
        twin.load(again.save()[:-1])


@pytest.mark.parametrize(
    ('values', 'change', 'text'),
    [
        ({'bearing': '6307'}, {}, 'of another bearing than 6307'),
        ({'sample_rate': 51200.0}, {}, 'start it with sample_rate:=25600.0'),
        ({}, {'path': None}, 'no calibration'),
        ({}, {'twin': {'defects': [], 'colour': 1.0}}, 'it gives defects, colour of a twin'),
    ],
)
def test_a_calibration_that_is_not_of_this_twin_is_refused(values, change, text, calibration):
    twin = Twin(VALUES | values)
    with pytest.raises(BearingTwinError, match=text):
        twin.take(read_fitted_model(json.dumps(json.loads(calibration) | change)))
    assert twin.fitted_model is None


def test_a_reset_goes_back_to_the_start_also_after_a_calibration(calibration):
    twin = Twin(VALUES)
    twin.simulator.advance(1024, 60.0, 20.0)
    twin.take(read_fitted_model(calibration))
    run(twin, 2)
    assert twin.simulator.parameters.load != Twin(VALUES).simulator.parameters.load
    twin.reset()
    assert (twin.simulator.temperature, twin.simulator.shaft_hz) == (40.0, SHAFT)


def test_an_unstable_path_is_refused(calibration):
    values = json.loads(calibration)
    values['path']['denominator'] = [1.0, -1.1]
    with pytest.raises(BearingTwinError, match='no stable filter'):
        read_fitted_model(json.dumps(values))


@pytest.mark.parametrize(
    ('part', 'change'),
    [
        ('machine', {'shaft_hz': 10**400}),
        ('machine', {'unit': '\ud800'}),
        ('spectrum', {'machine_db': 5.0}),
        ('spectrum', {'machine_db': [[0.0, 1.0]] * 129}),
        ('spectrum', {'machine_db': [float('nan')] * 129}),
        ('spectrum', {'machine_rms': float('nan')}),
        ('twin', {'load': 10**400}),
        ('twin', {'lubricant': 1.0}),
        ('path', {'numerator': [1e300]}),
    ],
)
def test_absurd_calibrations_are_refused(part, change, calibration):
    values = json.loads(calibration)
    values[part] |= change
    with pytest.raises(BearingTwinError):
        read_fitted_model(json.dumps(values))
    with pytest.raises(BearingTwinError):
        read_fitted_model('[' * 200000)


def test_a_calibration_that_no_step_resolves_is_refused(calibration):
    values = json.loads(calibration)
    values['twin'] |= {'hertz_stiffness': 1e12, 'inner_mass': 0.1}
    twin = Twin(VALUES)
    with pytest.raises(BearingTwinError, match='Hz'):
        twin.take(read_fitted_model(json.dumps(values)))
    run(twin, 2)


def test_what_was_asked_for_last_is_what_is_taken(calibration):
    one = read_fitted_model(calibration)
    twin = Twin(VALUES)
    twin.take(one)
    twin.take(None)
    run(twin, 2)
    assert twin.fitted_model is None
    other = json.loads(calibration)
    other['statement'] = 'another'
    twin.take(one)
    run(twin, 2)
    twin.take(read_fitted_model(json.dumps(other)))
    twin.take(one)
    run(twin, 2)
    assert twin.fitted_model.statement == one.statement


def test_a_fitted_twin_has_its_load_along_the_sensor(calibration):
    loads = []
    for angle in (-0.5 * np.pi, 0.0):
        twin = Twin(VALUES | {'load_angle': angle})
        twin.take(read_fitted_model(calibration))
        run(twin, 20)
        loads.append(run(twin, 50).std())
    assert loads[1] == pytest.approx(loads[0], rel=0.05)


def test_injected_defects_keep_their_place_in_the_load(calibration):
    fitted = read_fitted_model(calibration)
    down, aside = (
        fitted.parameters(
            preset('incipient', bearing='6205', defect='inner+outer+cage', load_angle=angle)
        )
        for angle in (-0.5 * np.pi, 0.3)
    )
    for one, other in zip(down.defects, aside.defects, strict=True):
        assert one.angle == pytest.approx(other.angle)
    behind = preset('incipient', bearing='6205', defect='outer:angle=-3', load_angle=3.0)
    [defect] = fitted.parameters(behind).defects
    assert defect.angle == pytest.approx(-6.0 - 0.5 * np.pi + 2.0 * np.pi)


@pytest.mark.usefixtures('compiled')
def test_a_change_that_no_step_resolves_is_refused_and_the_twin_goes_on(nodes, probe):
    from bearing_twin_msgs.msg import Vibration

    blocks = probe.collect(Vibration, 'vibration')
    nodes.start('twin', DEEP)
    probe.until(lambda: len(blocks) > 5, 'vibration')
    done, why = probe.set_parameters('twin', outer_damping=1e6)
    assert not done and 'Hz' in why
    seen = len(blocks)
    probe.until(lambda: len(blocks) > seen + 5, 'more of it')


@pytest.mark.ros
def test_a_twin_waits_for_a_calibration_only_where_somebody_publishes_it(
    here, calibration, tmp_path
):
    given = {name: VALUES[name] for name in ('bearing', 'preset', 'shaft_hz')}
    node = here(TwinNode, follow_calibration=True, state_directory=str(tmp_path), **given)
    node.trigger_configure()
    status = node._calibration.status()
    assert (status.level, status.message) == (Level.OK, 'runs by its own parameters')
    publisher = node.create_publisher(Calibration, 'calibration', RESULT)

    def becomes(level):
        end = time.monotonic() + 120.0
        while node._calibration.status().level != level:
            assert time.monotonic() < end
            time.sleep(0.02)
        return node._calibration.status().message

    assert becomes(Level.STALE) == 'no calibration yet'
    # The newest calibration of a node that has ended is not that of the machine as it is now.
    node._calibration._on_calibration(Calibration(json=calibration), None)
    node._calibration._twin.advance()
    assert becomes(Level.OK).startswith('taken: ')
    node.destroy_publisher(publisher)
    assert becomes(Level.STALE).startswith('no node publishes calibrations any more')
    # What is wrong with one from the topic is not wrong with the next, from a file.
    node._calibration._on_calibration(Calibration(json='{}'), None)
    assert becomes(Level.WARN).startswith('calibration not taken: ')
    (tmp_path / 'pump.json').write_text(calibration.replace('"unit": "g"', '"unit": "m/s^2"'))
    node._calibration.apply({**node.parameters.values, 'calibration': 'pump.json'})
    node._calibration._twin.advance()
    assert becomes(Level.OK).startswith('taken: ')


@pytest.mark.usefixtures('compiled')
def test_a_recording_of_a_twin_that_took_one_is_verified(nodes, probe, calibration, tmp_path):
    from bearing_twin_msgs.msg import Vibration

    (tmp_path / 'pump.json').write_text(calibration)
    blocks = probe.collect(Vibration, 'vibration')
    probe.watch_diagnostics()
    nodes.start('recorder', {'output': str(tmp_path / 'bag')})
    given = {name: VALUES[name] for name in ('bearing', 'preset', 'shaft_hz', 'start_temperature')}
    (tmp_path / 'states').symlink_to(tmp_path)
    nodes.start('twin', given | {'state_directory': str(tmp_path / 'states')} | DEEP)
    probe.until(lambda: len(blocks) > 30, 'vibration')
    assert probe.set_parameters('twin', calibration='none.json')[0] is False
    assert probe.set_parameters('twin', calibration='pump.json') == (True, '')
    # A recorder that was slow to find the twin has the checkpoints from here on.
    change = len(blocks)
    probe.until(lambda: blocks[-1].unit == 'g', 'the unit of the machine')
    probe.until(
        lambda: 'distance_db' in probe.statuses.get('twin: calibration', ('', '', {}))[2],
        'how alike twin and machine are',
    )
    assert float(probe.statuses['twin: calibration'][2]['distance_db']) < 3.0
    # A new fit in the same file is another calibration; a file that has gone is none.
    (tmp_path / 'pump.json').write_text(calibration.replace('"unit": "g"', '"unit": "m/s^2"'))
    assert probe.set_parameters('twin', calibration='pump.json') == (True, '')
    probe.until(lambda: blocks[-1].unit == 'm/s^2', 'the unit of the new fit')
    (tmp_path / 'pump.json').write_text('{}')
    done, why = probe.set_parameters('twin', calibration='pump.json')
    assert not done and 'no calibration' in why
    (tmp_path / 'pump.json').write_text(calibration)
    assert probe.set_parameters('twin', calibration='pump.json') == (True, '')
    probe.until(lambda: blocks[-1].unit == 'g', 'the unit of the first fit')
    (tmp_path / 'pump.json').unlink()
    assert probe.set_parameters('twin', load=321.0) == (True, '')
    # Nor does a folder that cannot be reached end the twin.
    (tmp_path / 'states').unlink()
    (tmp_path / 'states').symlink_to('a' * 256)
    assert probe.set_parameters('twin', load=322.0) == (True, '')
    assert probe.set_parameters('twin', calibration='') == (True, '')
    probe.until(lambda: blocks[-1].unit == 'm/s^2', 'the own unit')
    probe.until(lambda: len(blocks) > change + 60, 'blocks to be made again')
    nodes.end('twin')
    nodes.end('recorder')
    # A busy machine may let the twin give blocks up, but none is cut or told twice.
    steps = {b.first_sample - a.first_sample for a, b in pairwise(blocks)}
    assert min(steps) == 1024 and all(step % 1024 == 0 for step in steps)
    result = reproduce(tmp_path / 'bag')
    # Also those in which it changed.
    assert result.identical, result
    assert result.topics['/vibration'].identical > 50
