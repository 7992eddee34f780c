# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A file played as a sensor arrives sample for sample, in time."""

from functools import partial
from signal import SIGTERM
import time

from forked import run_command, start_command
import numpy as np
import pytest
from scipy.io import savemat, wavfile

pytestmark = pytest.mark.ros

RATE = 4000
SIGNAL = np.round(np.random.default_rng(0).standard_normal(6000) * 3000).astype(np.int16)


@pytest.fixture
def files(tmp_path):
    wavfile.write(tmp_path / 'a.wav', RATE, SIGNAL)
    savemat(tmp_path / 'a.mat', {'fan_time': SIGNAL.astype(float)[:, None], 'other': [[1.0]]})
    times = np.arange(SIGNAL.size) / RATE
    table = np.column_stack([times, SIGNAL])
    np.savetxt(tmp_path / 'a.csv', table, delimiter=',', header='time,x', comments='')
    np.savez(tmp_path / 'volt.npz', x=SIGNAL.astype(float), fs=RATE, unit='V')
    np.savez(tmp_path / 'a.npz', x=SIGNAL.astype(float), fs=RATE, rpm=600.0)
    return tmp_path


@pytest.fixture
def play(tmp_path):
    """Return a function that starts to play a file and writes its messages to ``said``."""
    return partial(start_command, 'play', out=tmp_path / 'said')


def stamp(message):
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


@pytest.mark.parametrize(
    ('name', 'words', 'scale'),
    [
        ('a.wav', (), 2.0**-15),
        ('a.mat', ('--channel', 'fan', '--rate', RATE), 1.0),
        ('a.csv', ('--channel', 'x'), 1.0),
    ],
)
def test_blocks_without_a_stamp_come_at_the_rate_of_the_file(
    probe, files, play, name, words, scale
):
    from std_msgs.msg import Float32MultiArray

    came = probe.collect(Float32MultiArray, '/fan/accel')
    began = time.monotonic()
    playing = play(files / name, *words, '--topic', '/fan/accel')
    probe.until(lambda: playing.poll() is not None, 'the end of the file')
    assert playing.returncode == 0, (files / 'said').read_text()
    assert time.monotonic() - began >= SIGNAL.size / RATE
    probe.until(lambda: sum(len(m.data) for m in came) == SIGNAL.size, 'the last samples')
    samples = np.concatenate([m.data for m in came])
    assert np.array_equal(samples, (SIGNAL * scale).astype(np.float32))


def test_blocks_of_vibration_go_on_over_the_end_of_a_loop(probe, files, play):
    from bearing_twin_msgs.msg import Vibration

    came = probe.collect(Vibration, '/vibration')
    playing = play(files / 'a.npz', '--as', 'vibration', '--loop', '--speed', 3, '--unit', 'g')
    probe.until(lambda: len(came) >= 8, 'more than one round')
    playing.send_signal(SIGTERM)
    assert playing.wait(120) == 0, (files / 'said').read_text()
    first, *_, last = came
    assert (first.unit, first.shaft_hz, first.source) == ('g', 10.0, Vibration.SOURCE_MEASURED)
    assert [m.first_sample for m in came] == [1024 * k for k in range(len(came))]
    assert stamp(last) - stamp(first) == pytest.approx(last.first_sample / RATE, abs=1e-6)
    samples = np.concatenate([m.y for m in came])
    assert np.array_equal(samples, np.resize(SIGNAL, samples.size))


def test_single_samples_have_their_own_stamps(probe, files, play):
    from sensor_msgs.msg import Imu

    came = probe.collect(Imu, '/imu', depth=SIGNAL.size)
    playing = play(files / 'a.npz', '--as', 'imu', '--speed', 0.5, '--frame-id', 'fan')
    probe.until(lambda: len(came) == SIGNAL.size, 'all samples')
    assert playing.wait(120) == 0
    assert [m.linear_acceleration.x for m in came] == SIGNAL.tolist()
    assert np.diff([stamp(m) for m in came]) == pytest.approx(1.0 / RATE, abs=2e-6)
    assert came[0].header.frame_id == 'fan'


def test_a_file_in_g_is_an_imu_in_metres_and_no_unit_stays_unknown(probe, files, play):
    from bearing_twin_msgs.msg import Vibration
    from sensor_msgs.msg import Imu

    came, blocks = probe.collect(Imu, '/imu', depth=SIGNAL.size), probe.collect(Vibration, '/v')
    playing = play(files / 'a.npz', '--as', 'imu', '--unit', 'g', '--speed', 0.5)
    probe.until(lambda: len(came) >= 100, 'some samples')
    playing.send_signal(SIGTERM)
    found = np.array([m.linear_acceleration.x for m in came[:100]])
    assert found == pytest.approx(9.80665 * SIGNAL[:100], rel=1e-6)
    playing.wait(120)
    playing = play(files / 'a.wav', '--as', 'vibration', '--topic', '/v')
    probe.until(lambda: blocks, 'a block')
    assert blocks[0].unit == ''
    assert playing.wait(120) == 0


def test_what_cannot_be_played_is_refused_with_the_remedy(files):
    for words, status, said in (
        (('a.mat',), 1, '--sample-rate'),
        (('a.wav', '--speed', 2), 2, '--speed needs --as imu or --as vibration'),
        (('a.npz', '--block', 0), 2, '--block 0'),
        (('volt.npz', '--as', 'imu'), 1, 'is in V, an Imu in m/s^2'),
    ):
        played = run_command('play', files / words[0], *words[1:])
        assert played.returncode == status
        assert said in played.stderr
