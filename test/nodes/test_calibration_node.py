# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The calibration node: a machine that it does not know is fitted, over DDS."""

from dataclasses import replace
import json
import math
from pathlib import Path
import subprocess
import sys
import tempfile

from bearing_twin.assets.calibration import CalibrationCore, Fit, Task, work
from bearing_twin.assets.calibration_parameters import SPECS
from bearing_twin.bearing import find_bearing
from bearing_twin.calibration import Calibration as Fitted
from bearing_twin.calibration import fit
from bearing_twin.errors import BearingTwinError
from bearing_twin.streams.vibration_input import VibrationBlock
from bearing_twin.view.report.data import Machine
from bearing_twin.view.report.plots import figures
from bearing_twin.view.rerun.calibration import CalibrationPicture
from bearing_twin.view.rerun.canvas import Canvas
from bearing_twin.view.rerun.picture import Asset
from bearing_twin.view.rerun.timebase import Timebase
from block_streams import check_complete, DEEP
import numpy as np
import pytest

VALUES = {spec.name: spec.default for spec in SPECS}
RATE = 25600.0


def block(number, samples=1024, shaft_hz=25.0):
    x = np.random.default_rng(number).standard_normal(samples).astype(np.float32)
    return VibrationBlock(number * 1024, x, RATE, shaft_hz, 'm/s^2', False)


def take(core, numbers, **given):
    known = {'stamp': 0, 'frame_id': 'imu', 'temperature': 40.0, 'shaft_hz': math.nan}
    tasks = [core.take(block(n), **known | given | {'now': n * 0.04}) for n in numbers]
    return [task for task in tasks if task is not None]


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
    assert still.take(block(0, 51200, math.nan), stamp=0, frame_id='', temperature=40.0,
                      shaft_hz=math.nan, now=0.0) is None  # fmt: skip
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


def blocks(core, speeds, **changed):
    """Tasks of a stream of blocks of these speeds, Hz."""
    known = {'stamp': 0, 'frame_id': 'imu', 'temperature': 40.0, 'shaft_hz': math.nan}
    tasks = [
        core.take(replace(block(n, shaft_hz=hz), **changed), **known, now=n * 0.04)
        for n, hz in enumerate(speeds)
    ]
    return [task for task in tasks if task is not None]


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


@pytest.mark.parametrize('changed', [{'unit': 'g'}, {'sample_rate': 25000.0}])
def test_samples_of_another_unit_or_rate_are_another_record(changed):
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    assert blocks(core, np.full(45, 25.0)) == []
    known = {'stamp': 0, 'frame_id': 'imu', 'temperature': 40.0, 'shaft_hz': math.nan}
    assert [
        core.take(replace(block(n), **changed), **known, now=n * 0.04) for n in range(45, 80)
    ] == [None] * 35


def test_a_turn_of_a_fast_sensor_has_no_image_of_what_lies_above_its_band():
    """A tone of 46 kHz at 102.4 kHz would be one of 5.2 kHz at half the rate."""
    rate = 102400.0
    tone = 10.0 * np.sin(2.0 * np.pi * 46e3 * np.arange(round(2.0 * rate)) / rate)
    noise = np.random.default_rng(1).standard_normal(len(tone))
    task = Task(
        samples=noise + tone, sample_rate=rate, bearing=find_bearing('6307'), shaft_hz=25.0,
        temperature=40.0, unit='m/s^2', place='none', load=None, candidates=64, others=(),
        reference=None, stamp=0, frame_id='', first_sample=0,
    )  # fmt: skip
    measured = work(task).turns[0]
    assert len(measured) == 2048
    # Half of the white noise is left; the tone had the power 50.
    assert measured.std() == pytest.approx(math.sqrt(0.5), rel=0.15)


def test_residual_learns_while_the_diagnosis_is_ok_and_sees_what_is_new():
    """One decision a minute; the levels come by hand, the calibration is a real one."""
    from bearing_twin_msgs.msg import Diagnosis

    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, find_bearing('6307'), 25.0, place='none', candidates=64).to_dict()
    # Whatever it cost here: what costs much is asked for less often.
    found['cost_s'] = 1.0
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    bands, rng = ('25 Hz', 'order 1'), np.random.default_rng(2)

    def minute(number, extra):
        [task] = take(core, range(2000 * (number + 3), 2000 * (number + 3) + 50))
        levels = rng.standard_normal(2) + extra
        done = Fit(
            found=found, bands=bands, measured=levels, twin=np.zeros(2), spectrum=np.zeros(129),
            turns=np.ones((2, 1024)),
        )  # fmt: skip
        return core.conclude(task, done, 60.0 * number)

    none = 'no calibration of the healthy machine yet: '
    assert minute(-3, 0.0).residual_reason == (
        none + 'no diagnosis was heard, start the diagnosis node beside this one'
    )
    core.verdict(Diagnosis(level=Diagnosis.LEVEL_FAULT))
    assert minute(-2, 0.0).residual_reason == none + 'the diagnosis is not ok'
    core.verdict(Diagnosis(level=Diagnosis.LEVEL_OK))
    sound, found = found, found | {'defect': 'outer'}
    assert minute(-1, 0.0).residual_reason == none + 'this one has a defect (outer)'
    found = sound
    assert minute(0, 0.0).residual_reason == (
        'this calibration is the healthy twin: the next ones are compared with it'
    )
    for number in range(1, 45):
        message = minute(number, 0.0)
    assert message.residual < 1.0 and not message.residual_alarm
    resumed = CalibrationCore(VALUES)
    resumed.load(core.save())
    assert resumed.save() == core.save()
    # A healthy twin of another bearing explains nothing of this one.
    other = CalibrationCore(VALUES | {'bearing': '6205'})
    with pytest.raises(BearingTwinError, match='not of 6205; choose another state_name'):
        other.load(core.save())
    for number in range(45, 50):
        message = minute(number, np.array([0.0, 20.0]))
    assert message.residual_alarm and message.residual_where == 'order 1'
    assert message.residual_over == pytest.approx(20.0, abs=2.0)
    assert Fitted.from_dict(json.loads(message.json)).defect == 'none'
    assert list(message.quantity) == list(found['quantities'])
    with pytest.raises(BearingTwinError):
        resumed.load(b'nothing')
    # Report and Rerun show it.
    message.band, message.measured_level, message.twin_level = ['25 Hz'], [3.0], [1.0]
    shown = figures(Machine(namespace='', calibrations=[(0.0, message), (30.0, message)]), 'a')
    assert [caption.split(';')[0].split(':')[0] for caption, _ in shown] == [
        'The twin fitted to the machine',
        'Machine and fitted twin',
        'Machine and fitted twin',
    ]
    marks, asset = [], Asset()
    canvas = Canvas(lambda mark, **_: marks.append(mark), '/calibration', Timebase())
    picture = CalibrationPicture(canvas, asset)
    assert picture.draw(message, 10**18)
    picture.flush(slow=True)
    assert len(marks) > 3
    assert asset.panels == {
        'width', 'residual', 'distance', 'fitted_spectrum', 'fitted_turn',
    }  # fmt: skip


def test_a_worker_ends_with_its_node():
    """Killed, a node can not end its worker: that looks for it."""
    code = (
        'from bearing_twin.nodes.calibration import _worker\n'
        "import os\nif __name__ == '__main__':\n"
        '    print(_worker().submit(os.getpid).result(), flush=True)\n    os.kill(os.getpid(), 9)'
    )
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / 'node.py'
        script.write_text(code)
        # The worker has the same output, which ends when both have.
        done = subprocess.run(
            [sys.executable, script], stdout=subprocess.PIPE, check=False, timeout=300.0
        )
    assert done.returncode == -9 and int(done.stdout) > 0


@pytest.mark.usefixtures('compiled')
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
    probe.until(lambda: [m for m in found if m.defect == 'outer'], 'a calibration', timeout=240.0)
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
    assert Fitted.from_dict(json.loads(said.json)).situation.place == 'outer'
    # The fit runs beside: no block is lost, and the twin counts those that it gave up.
    check_complete(states, blocks)
    assert verdicts
    probe.until(
        lambda: 'not ok' in probe.status('calibration: residual')[1],
        'the status of the residual',
    )
