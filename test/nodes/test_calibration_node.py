# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The calibration node: a machine that it does not know is fitted, over DDS."""

import json
import math
from pathlib import Path
import subprocess
import sys
import tempfile

from bearing_twin.assets.calibration import CalibrationCore, Fit
from bearing_twin.assets.calibration_parameters import SPECS
from bearing_twin.calibration import Calibration as Fitted
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
    with pytest.raises(BearingTwinError, match='load_low=5'):
        CalibrationCore(VALUES | {'load_low': 5.0})


def test_residual_learns_while_the_diagnosis_is_ok_and_sees_what_is_new():
    """One decision a minute; the levels come by hand, the calibration is a real one."""
    from bearing_twin.bearing import find_bearing
    from bearing_twin.calibration import fit
    from bearing_twin_msgs.msg import Diagnosis

    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(noise, RATE, find_bearing('6307'), 25.0, place='none', candidates=64).to_dict()
    # Whatever it cost here: what costs much is asked for less often.
    found['cost_s'] = 1.0
    core = CalibrationCore(VALUES | {'window': 2.0, 'period': 1.0})
    bands, rng = ('25 Hz', 'order 1'), np.random.default_rng(2)

    def minute(number, extra):
        [task] = take(core, range(2000 * number, 2000 * number + 50))
        levels = rng.standard_normal(2) + extra
        done = Fit(
            found=found, bands=bands, measured=levels, twin=np.zeros(2), spectrum=np.zeros(129),
            turns=np.ones((2, 1024)),
        )  # fmt: skip
        return core.conclude(task, done, 60.0 * number)

    message = minute(0, 0.0)
    assert 'the diagnosis is not ok' in message.residual_reason
    core.verdict(Diagnosis(level=Diagnosis.LEVEL_OK))
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
