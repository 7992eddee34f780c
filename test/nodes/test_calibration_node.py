# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The calibration node: a machine that it does not know is fitted, over DDS."""

from dataclasses import replace
import itertools
import json
import math
import os
import signal
import time

from bearing_twin.assets.calibration.core import CalibrationCore
from bearing_twin.assets.calibration.task import Fit, fit_record, Task
from bearing_twin.assets.parameters.calibration import SPECS
from bearing_twin.bearing import fault_frequencies, find_bearing
from bearing_twin.calibration import Calibration as FitResult
from bearing_twin.calibration import fit
from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.vibration_input import VibrationBlock
from bearing_twin.streams.worker import Worker
from bearing_twin.view.report.data import Machine
from bearing_twin.view.report.plots import appended_figures, figures
from bearing_twin.view.rerun.canvas import Canvas
from bearing_twin.view.rerun.pictures.calibration import CalibrationPicture
from bearing_twin.view.rerun.pictures.picture import Asset
from bearing_twin.view.rerun.timebase import Timebase
import numpy as np
from probe import check_complete, DEEP
import pytest

VALUES = {spec.name: spec.default for spec in SPECS}
RATE = 25600.0


def block(number, samples=1024):
    x = np.random.default_rng(number).standard_normal(samples).astype(np.float32)
    return VibrationBlock(number * 1024, x, RATE, 25.0, 'm/s^2', False, frame_id='imu')


def take(core, numbers, **changed):
    known = {'temperature': 40.0, 'shaft_hz': math.nan}
    tasks = [core.take(replace(block(n), **changed), now=n * 0.04, **known) for n in numbers]
    return [task for task in tasks if task is not None]


def verdict(number, level, place='', bearing='6307', name='', frame_id='imu', sample_rate=RATE):
    """Verdict of the window of 2 s that ends with a block; ``name`` is another for the bearing."""
    from bearing_twin_msgs.msg import Diagnosis
    from std_msgs.msg import Header

    return Diagnosis(
        level=level, faults=[place] if place else [], bearing=name or bearing,
        sample_rate=sample_rate, header=Header(frame_id=frame_id),
        first_sample=max(0, (number - 49) * 1024), sample_count=50 * 1024,
        **fault_frequencies(find_bearing(bearing), 25.0)._asdict(),
    )  # fmt: skip


OK, SUSPECT, FAULT = 0, 1, 2


@pytest.fixture(scope='module')
def healthy():
    """Fit noise; what costs much is asked for less often, so that the cost is given."""
    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, find_bearing('6307'), 25.0, place='none', candidates=64).to_dict()
    return found | {'cost_s': 1.0, 'machine': found['machine'] | {'unit': 'm/s^2'}}


def done(found, levels=(0.0, 0.0)):
    return Fit(
        found=found, bands=('25 Hz', 'order 1'), measured=np.array(levels), twin=np.zeros(2),
        spectrum=np.full(129, -3.0), turns=np.repeat([[1.0], [2.0]], 1024, axis=1),
    )  # fmt: skip


def test_a_record_is_due_each_period_whole_and_without_a_gap():
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 4.0})
    [first] = take(core, range(100))
    assert (first.first_sample, len(first.samples)) == (0, 51200)
    assert take(core, range(100, 149)) == []
    [second] = take(core, range(149, 160))
    assert second.first_sample == 150 * 1024 - 51200
    # After a gap the window has to fill again.
    assert take(core, range(1000, 1049)) == []
    assert take(core, range(1049, 1051))[0].first_sample == 1000 * 1024
    # Without a speed there are no fault frequencies to fit to.
    still = CalibrationCore(VALUES | {'window': 2.0})
    assert take(still, range(50), shaft_hz=math.nan) == []
    assert 'set shaft_hz' in still.waiting and core.waiting == ''


@pytest.mark.parametrize(
    ('change', 'text'),
    [
        ({'load_low': 5.0}, 'load_low=5'),
        ({'load_low': 1.0, 'load_high': 5.0}, 'load from 1 to 5 N: .* from 10 to 50000 N'),
        ({'load_low': 1e6, 'load_high': 2e6}, 'load from 1e.06 to 2e.06 N'),
        ({'bearing': 'ZA-2115'}, 'ZA-2115 has 2 row.s. of rollers.*choose a ball bearing'),
        ({'bearing': '', 'geometry': '16,8,72,50'}, 'contact_angle'),
    ],
)
def test_what_no_fit_takes_is_refused_before_one_begins(change, text):
    with pytest.raises(BearingTwinError, match=text):
        CalibrationCore(VALUES | change)


def blocks(core, speeds):
    """Tasks of a stream of blocks of these speeds, Hz."""
    return [task for n, hz in enumerate(speeds) for task in take(core, [n], shaft_hz=hz)]


def test_a_record_has_its_mean_speed_and_one_whose_speed_moves_is_not_fitted():
    """A window of 2 s has 50 blocks."""
    values = VALUES | {'window': 2.0, 'period': 1.0}
    core = CalibrationCore(values)
    [task] = blocks(core, np.linspace(24.8, 25.2, 50))
    assert task.shaft_hz == pytest.approx(25.0, abs=1e-6) and core.waiting == ''
    ramp = CalibrationCore(values)
    assert blocks(ramp, np.linspace(15.0, 25.0, 50)) == []
    assert ramp.waiting == (
        'the speed moved from 15 to 25 Hz within the window, more than 2 %: keep it steady, or '
        'choose a shorter window'
    )
    # It is fitted again as soon as what is left of the ramp is less than 2 %: three blocks.
    steady = np.concatenate((np.linspace(15.0, 25.0, 50), np.full(50, 25.0)))
    [after] = blocks(CalibrationCore(values), steady)
    assert after.first_sample == 47 * 1024
    assert after.shaft_hz == pytest.approx(steady[47:97].mean())
    # A speed that was not known for a part of the window is no speed of the window.
    late = CalibrationCore(values)
    assert blocks(late, [math.nan] * 10 + [25.0] * 40) == []
    assert 'set shaft_hz' in late.waiting
    still = CalibrationCore(values)
    assert blocks(still, np.zeros(50)) == [] and 'stands still' in still.waiting


@pytest.mark.parametrize(
    'changed', [{'unit': 'g'}, {'sample_rate': 25000.0}, {'frame_id': 'motor'}]
)
def test_samples_of_another_unit_or_rate_are_another_record(changed):
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    assert blocks(core, np.full(45, 25.0)) == []
    assert take(core, range(45, 80), **changed) == []


def test_a_rate_that_a_driver_measures_anew_makes_one_record():
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    sent = [task for n in range(60) for task in take(core, [n], sample_rate=RATE + 0.1 * (n % 3))]
    assert sent and sent[0].sample_rate == RATE


def test_snapshots_that_are_shorter_than_a_rate_takes_to_measure_are_fitted():
    """Three seconds an hour, with stamps and an index that begins anew each time."""
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    tasks = []
    for hour in range(3):
        for n in range(75):
            sent = replace(block(n), stamp=round((3600 * hour + n * 0.04) * 1e9))
            now = 3600.0 * hour + n * 0.04
            tasks.append(core.take(sent, temperature=40.0, shaft_hz=25.0, now=now))
    assert len([task for task in tasks if task is not None]) >= 3


def test_samples_at_another_rate_than_they_say_are_not_fitted():
    """Of 48 kHz said to be 12: each resonance would lie at a quarter of its frequency."""
    core = CalibrationCore(VALUES)
    for n in range(500):
        sent = replace(block(n), sample_rate=12000.0, stamp=round(n * 1024 / 48000.0 * 1e9))
        assert core.take(sent, temperature=40.0, shaft_hz=25.0, now=n * 0.02) is None
    assert core.waiting.startswith('48000 samples a second arrive, sample_rate says 12000')


def test_a_turn_of_a_fast_sensor_has_no_image_of_what_lies_above_its_band():
    """A tone of 46 kHz at 102.4 kHz would be one of 5.2 kHz at half the rate."""
    rate = 102400.0
    tone = 10.0 * np.sin(2.0 * np.pi * 46e3 * np.arange(round(2.0 * rate)) / rate)
    noise = np.random.default_rng(1).standard_normal(len(tone))
    task = Task(
        samples=noise + tone, sample_rate=rate, bearing=find_bearing('6307'), shaft_hz=25.0,
        temperature=40.0, unit='m/s^2', place='none', load=None, candidates=64, others=(),
        reference=None, healthy=False, repairs=0, stamp=0, frame_id='', first_sample=0,
    )  # fmt: skip
    measured = fit_record(task).turns[0]
    assert len(measured) == 2048
    # Half of the white noise is left; the tone had the power 50.
    assert measured.std() == pytest.approx(math.sqrt(0.5), rel=0.15)


def test_the_verdict_of_a_record_is_of_its_sensor_its_bearing_and_its_time():
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    assert take(core, range(100))[-1].place is None
    for number, said, place in (
        (130, {'level': FAULT, 'place': 'outer'}, 'outer'),
        # The diagnosis knows the bearing by its geometry.
        (160, {'level': OK, 'name': '8,13.494,58.5,0'}, 'none'),
        # Another sensor, another bearing of the same sensor, and no part: the last one stays.
        (190, {'level': FAULT, 'place': 'inner', 'frame_id': 'motor'}, 'none'),
        (220, {'level': FAULT, 'place': 'inner', 'bearing': '6205'}, 'none'),
        # A weak comb is not health: the fit looks for itself.
        (250, {'level': SUSPECT, 'place': 'inner'}, None),
        (280, {'level': FAULT, 'place': 'inner', 'sample_rate': 12800.0}, None),
        (310, {'level': FAULT, 'place': 'inner'}, 'inner'),
    ):
        take(core, range(number - 30, number))
        core.verdict(verdict(number - 1, **said))
        [*_, task] = take(core, range(number, number + 26))
        assert task.place == place, number
    # 10 s old, then more: 250 blocks.
    take(core, range(336, 340))
    assert take(core, range(340, 555))[-1].place == 'inner'
    assert take(core, range(555, 600))[-1].place is None
    # The source starts anew: its index goes back, and what was said is of other samples.
    [task] = [core.take(block(n), temperature=40.0, shaft_hz=math.nan, now=100.0)
              for n in range(50)][-1:]  # fmt: skip
    assert task.place is None and task.first_sample == 0


def test_a_repaired_machine_is_fitted_at_once_and_its_old_impacts_are_forgotten(healthy):
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 40.0})
    impacts = {
        'place': 'outer', 'shaft_hz': healthy['machine']['shaft_hz'], 'spacing_s': 3e-3,
        'lobe_s': 1e-4, 'rivals_s': [],
    }  # fmt: skip
    outer = healthy | {'defect': 'outer', 'impacts': impacts}
    take(core, range(40))
    core.verdict(verdict(39, FAULT, 'outer'))
    [task] = take(core, range(40, 60))
    said = core.conclude(task, done(outer), 2.4)
    assert said.width_q95 == outer['quantities']['defect_width_mm']['q95']
    assert core.stale_reason(2.4) == ''
    core.verdict(verdict(59, OK))
    assert core.stale_reason(2.4) == (
        'the diagnosis finds no defect, and the last calibration has a defect of the outer'
    )
    # A fit of a second is followed by two of rest, not by a period.
    assert take(core, range(60, 110)) == []
    [task] = take(core, range(110, 120))
    assert task.place == 'none' and len(task.others) == 1
    said = core.conclude(task, done(healthy), 4.6)
    # What no defect is wider than is no width of one.
    assert math.isnan(said.width_q95)
    assert core.stale_reason(4.6) == ''
    # A minute of health is another bearing; a fit that was begun before it is of the old one.
    old = replace(task, repairs=0)
    assert old.healthy
    for number in range(120, 1700, 100):
        core.verdict(verdict(number, OK))
        tasks = take(core, range(number, number + 100))
    assert [each.others for each in tasks] in ([], [()])
    core.conclude(old, done(outer), 68.0)
    core.verdict(verdict(1720, FAULT, 'outer'))
    [task, *_] = take(core, range(1720, 3000))
    assert task.others == () and task.repairs == 1


def test_after_a_fit_that_failed_a_fault_is_fitted_within_a_period(healthy):
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 8.0})
    core.verdict(verdict(39, OK))
    [task] = take(core, range(60))
    core.conclude(task, done(healthy), 2.4)
    # It is begun and never concluded.
    core.verdict(verdict(259, OK))
    assert len(take(core, range(60, 260))) == 1
    for number in range(260, 700, 50):
        core.verdict(verdict(number - 1, FAULT, 'outer'))
        if tasks := take(core, range(number, number + 50)):
            break
    assert tasks[0].place == 'outer' and number < 500


def test_a_calibration_is_stale_when_the_machine_has_changed_or_it_is_old(healthy):
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 40.0})
    [task] = take(core, range(50))
    assert core.stale_reason(2.0) == ''
    core.conclude(task, done(healthy), 2.0)
    take(core, range(50, 150))
    assert core.stale_reason(6.0) == ''
    for n in range(150, 260):
        core.take(replace(block(n), samples=2.0 * block(n).samples), temperature=40.0,
                  shaft_hz=math.nan, now=n * 0.04)  # fmt: skip
    assert core.stale_reason(10.4).startswith(
        'the vibration is +6.1 dB over that of the record that was'
    )
    # At another speed another vibration is none of another machine.
    take(core, range(260, 370), shaft_hz=27.0)
    assert core.stale_reason(15.0) == ''
    assert core.stale_reason(123.0) == 'it is 121 s old'


def test_residual_learns_while_the_diagnosis_is_ok_and_sees_what_is_new(healthy):
    """One decision a minute; the levels come by hand, the calibration is a real one."""
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    found, rng, level = healthy, np.random.default_rng(2), None

    def minute(number, extra):
        first = 2000 * (number + 3)
        take(core, range(first, first + 49))
        if level is not None:
            core.verdict(verdict(first + 49, level, 'outer' if level == FAULT else ''))
        [task] = take(core, [first + 49])
        return core.conclude(task, done(found, rng.standard_normal(2) + extra), 60.0 * number)

    none = 'no calibration of the healthy machine yet: '
    assert minute(-3, 0.0).residual_reason == (
        none + 'no diagnosis was heard, start the diagnosis node beside this'
    )
    level = SUSPECT
    assert minute(-2, 0.0).residual_reason == none + 'the diagnosis is not ok'
    level = None
    assert minute(-1, 0.0).residual_reason == (
        none + 'the last verdict is 80 s old, and 10 s is the most'
    )
    level, found = OK, healthy | {'defect': 'outer'}
    assert minute(0, 0.0).residual_reason == none + 'this one has a defect (outer)'
    found = healthy
    assert minute(1, 0.0).residual_reason == (
        'this calibration is the healthy twin: the next ones are compared with it'
    )
    for number in range(2, 46):
        message = minute(number, 0.0)
    assert message.residual < 1.0 and not message.residual_alarm
    resumed = CalibrationCore(VALUES)
    resumed.load(core.save())
    assert resumed.save() == core.save()
    # A healthy twin of another bearing explains nothing of this one.
    other = CalibrationCore(VALUES | {'bearing': '6205'})
    with pytest.raises(BearingTwinError, match='not of 6205; choose another state_name'):
        other.load(core.save())
    for number in range(46, 58):
        message = minute(number, np.array([0.0, 20.0]))
    assert message.residual_alarm and message.residual_where == 'order 1'
    assert message.residual_over == pytest.approx(20.0, abs=2.0)
    assert FitResult.from_dict(json.loads(message.json)).defect == 'none'
    assert list(message.quantity) == list(found['quantities'])
    # What is of the machine and what of the twin.
    assert message.measured_level[1] > 10.0 and list(message.twin_level) == [0.0, 0.0]
    machine_db = np.float32(found['spectrum']['machine_db'])
    assert np.array_equal(message.measured_spectrum, machine_db)
    assert set(message.twin_spectrum) == {-3.0}
    assert (set(message.measured_turn), set(message.twin_turn)) == ({1.0}, {2.0})
    with pytest.raises(BearingTwinError):
        resumed.load(b'nothing')
    # After a repair the healthy twin is that of another bearing, and the reason tells so.
    level = FAULT
    minute(58, 0.0)
    level = OK
    for number in range(2000 * 61 + 50, 2000 * 61 + 1750, 100):
        core.verdict(verdict(number, OK))
        take(core, range(number, number + 100))
    for number in range(59, 71):
        message = minute(number, np.array([0.0, 20.0]))
    assert message.residual_alarm and message.residual_reason.endswith(
        'call ~/reset to learn it anew'
    )
    alarmed = Machine(namespace='', calibrations=[(0.0, message)])
    assert alarmed.unexplained.startswith(f'{message.residual_reason} (residual ')
    assert 'learnt anew' in core.forget()
    assert minute(71, 0.0).residual_reason.startswith('this calibration is the healthy twin')
    # A fault that is named while the fit runs began in the record: it teaches nothing.
    core.forget()
    number = 2000 * 80
    take(core, range(number, number + 49))
    core.verdict(verdict(number + 49, OK))
    [task] = take(core, [number + 49])
    core.verdict(verdict(number + 50, FAULT, 'outer'))
    said = core.conclude(task, done(found), 4800.0).residual_reason
    assert said == none + 'the diagnosis is not ok'
    # Report and Rerun show it.
    message.band, message.measured_level, message.twin_level = ['25 Hz'], [3.0], [1.0]
    machine = Machine(namespace='', calibrations=[(0.0, message), (30.0, message)])
    assert machine.unexplained and Machine(namespace='').unexplained == ''
    shown = [*figures(machine, 'a'), *appended_figures(machine, 'b')]
    assert [caption.split(';')[0].split(':')[0] for caption, _ in shown] == [
        'The twin fitted to the machine',
        'Third octaves of the machine, and of its twin',
        'Machine and fitted twin',
    ]
    marks, asset = [], Asset()
    canvas = Canvas(lambda mark, **_: marks.append(mark), '/calibration', Timebase())
    picture = CalibrationPicture(canvas, asset)
    assert picture.draw(message, 10**18)
    picture.flush(slow=True)
    assert len(marks) > 3
    assert asset.panels == {'residual', 'distance', 'fitted_spectrum', 'fitted_turn'}


@pytest.mark.ros
def test_a_calibration_that_hears_no_vibration_names_its_topic(here):
    from bearing_twin.nodes.calibration import CalibrationNode

    node = here(CalibrationNode)
    node.trigger_configure()
    assert node.status().message == 'no vibration yet'
    node.trigger_activate()
    assert node.status().message == 'no vibration yet on /vibration'


@pytest.mark.ros
def test_a_second_thermometer_or_sensor_of_a_fitted_machine_is_told(here):
    from bearing_twin.nodes.calibration import CalibrationNode
    from bearing_twin_msgs.msg import Vibration
    from sensor_msgs.msg import Temperature

    node = here(CalibrationNode, shaft_hz=25.0)
    node.trigger_configure()
    node._on_vibration(Vibration(sample_rate=RATE, y=[0.0] * 1024), {'publisher_gid': 'v'})
    assert node.status().values['temperature'] == 'none received, 30 degC are assumed'
    node._inputs.take_temperature(Temperature(temperature=40.0), {'publisher_gid': 'a'})
    assert node.status().values['temperature'] == '40.0 degC'
    assert node.status().message.startswith('no calibration yet: 0.0 s of vibration of the 6 s')
    node._inputs.take_temperature(Temperature(temperature=60.0), {'publisher_gid': 'b'})
    assert 'only the first is used' in node.status().message
    node._on_vibration(Vibration(sample_rate=RATE, y=[0.0] * 1024), {'publisher_gid': 'w'})
    assert node.status().message == 'several sources on one topic: only the first is used'


@pytest.mark.ros
def test_whatever_ends_a_fit_is_told_and_the_next_one_begins(here, capfd):
    """Work that raises what no fit should, work that is killed, work that is done."""
    from bearing_twin.nodes.calibration import CalibrationNode
    from bearing_twin_msgs.msg import Vibration

    node = here(CalibrationNode, shaft_hz=25.0, window=2.0, period=1.0, candidates=64)
    node.trigger_configure()
    sent = itertools.count()

    def send():
        made = block(number := next(sent))
        message = Vibration(
            sample_rate=RATE, first_sample=number * 1024, shaft_hz=25.0, unit='m/s^2',
            y=made.samples.tolist(),
        )  # fmt: skip
        node._on_vibration(message, {'publisher_gid': 'v'})

    def begin(task):
        node._worker.end()
        node._worker = Worker(task)
        until = time.monotonic() + 60.0
        while node._running is None and time.monotonic() < until:
            time.sleep(0.02)
            send()

    def end(told):
        until = time.monotonic() + 120.0
        while node._running is not None and time.monotonic() < until:
            time.sleep(0.02)
            send()
            node._look()
        assert told in node.status().message
        assert capfd.readouterr().err.count(told) == ('not fitted' in told)

    begin(len)
    end("not fitted: TypeError: object of type 'Task' has no len()")
    begin(time.sleep)
    os.kill(node._worker._process.pid, signal.SIGKILL)
    end('not fitted: its process was killed')
    begin(fit_record)
    end('no defect')


@pytest.mark.usefixtures('compiled')
@pytest.mark.proof
def test_a_hidden_twin_with_a_defect_is_fitted_while_no_block_is_lost(nodes, probe):
    from bearing_twin_msgs.msg import Calibration, Diagnosis, TwinState, Vibration

    states = probe.collect(TwinState, '/twin_state')
    blocks = probe.collect(Vibration, '/vibration')
    verdicts = probe.collect(Diagnosis, '/diagnosis')
    found = probe.collect(Calibration, '/calibration')
    probe.watch_diagnostics()
    nodes.start('diagnosis', {'window': 4.0, 'memory': 4.0, 'update_interval': 1.0})
    nodes.start('calibration', {'window': 4.0, 'period': 2.0, 'candidates': 64})
    hidden = {'preset': 'incipient', 'defect': 'outer', 'defect_width': 0.002, 'noise': 0.2}
    nodes.start('twin', hidden | DEEP)
    # Nothing is published before there is a window; then the twin is fitted, unknown as it is.
    probe.until(lambda: [m for m in found if m.defect == 'outer'], 'a calibration')
    said = next(m for m in found if m.defect == 'outer')
    width = said.quantity.index('defect_width_mm')
    assert said.q05[width] <= 2.0 <= said.q95[width] < 4.0
    assert said.why[width] and said.quantity_unit[width] == 'mm'
    # The fitted twin passes for the machine, an unfitted one does not.
    assert said.distance < 0.5 * said.distance_before
    # Well within the 6 dB that are an alarm, in the whole and in its loudest bands.
    assert abs(said.level) < 3.0
    assert said.cost > 0.0
    both = np.array([said.measured_level, said.twin_level])[
        :, [i for i, b in enumerate(said.band) if b in ('508 Hz', '1016 Hz', '2032 Hz')]
    ]
    assert np.abs(both[0] - both[1]).max() < 3.0
    assert FitResult.from_dict(json.loads(said.json)).situation.place == 'outer'
    # The fit runs beside: no block is lost, and the twin counts those that it gave up.
    check_complete(states, blocks)
    assert verdicts
    probe.until(
        lambda: 'not ok' in probe.status('calibration: residual')[1], 'the status of the residual'
    )
