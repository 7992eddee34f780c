# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The main job with real processes: temperature in, vibration, verdict and recording out."""

import json

from bearing_twin.recording.reader import recording_info
from commands import python
import numpy as np
import pytest


def bearing_twin(*words):
    """Run the command line as a user does."""
    return python('-m', 'bearing_twin', *words)


@pytest.mark.ros
def test_demo_on_the_warm_up_of_a_real_machine(tmp_path, data_dir):
    """The measured 43..110 degC of a test rig (FEMTO Bearing2_5), its first 80 minutes in 24 s."""
    trend = np.load(data_dir / 'femto' / 'femto_Bearing2_5_trend.npz')
    wanted = np.arange(0.0, 4800.0, 10.0)
    measured = np.interp(wanted, trend['temp_t_s'] - trend['temp_t_s'][0], trend['temp_C'])
    table, recording = tmp_path / 'warm_up.csv', tmp_path / 'warm_up.mcap'
    np.savetxt(table, np.column_stack((wanted, measured)), '%.3f', delimiter=',')
    made = bearing_twin('schedule', '-o', recording, '--from', table)
    assert made.returncode == 0, made.stderr

    ran = bearing_twin(
        'demo', '--recording', recording, '--rate', 200, '--out', tmp_path / 'runs', '--json'
    )
    result = json.loads(ran.stdout)
    assert ran.returncode == (0 if result['good'] else 1), ran.stdout + ran.stderr

    # The second machine: its place is found, and the width where the vibration tells it.
    hidden = result['hidden']
    assert hidden['place'] == 'inner'
    assert hidden['statement'].startswith('inner race defect')
    assert hidden['width_q05'] < hidden['width_q95']
    assert 'dB over the machine' in hidden['followed']
    assert result['temperature_low'] < 45.0
    assert result['temperature_high'] > 109.0
    assert result['verdicts']['inner'] > 0
    assert result['false_alarms'] == 0
    # A machine that is busy with something else costs blocks, which the twin counts: each begins
    # a new window. On the way nothing is lost.
    given_up = 1024 * result['blocks_dropped']
    assert result['samples_lost_by_recorder'] == given_up
    assert result['samples_lost_by_diagnosis'] <= given_up
    [folder] = (tmp_path / 'runs').iterdir()
    recorded = recording_info(folder / 'bag').topics['/temperature'].count
    assert (recorded, result['sent_before_recorder']) == (recording_info(recording).count, 0)
    if not given_up:
        assert result['good']
        assert result['result'] == 'inner'
        assert result['fault_hz'] == pytest.approx(result['fault_hz_expected'], rel=0.005)
    assert {name.rsplit('.', 1)[1] for name in result['files']} == {'mcap', 'rrd'}
    assert all(size > 0 for size in result['files'].values())
