# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is drawn, read back from the Rerun files: positions, times, forces, and no failure."""

import math
from pathlib import Path
import socket
from types import SimpleNamespace

from bearing_twin import cli
from bearing_twin.bearing import fault_frequencies
from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages
from bearing_twin.view.rerun.bearing3d import contact_forces, SLOWED
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.opening import draw_recordings, find_recording
from bearing_twin.view.rerun.spectra import cursors, pooled
from bearing_twin.view.rerun.viewer import live_url, LOOPBACK
from bearing_twin.view.rerun.waveform import extremes
from bearing_twin.view.timebase import Timebase
import numpy as np
import pytest
from rerun.chunk import RrdReader

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'
SECOND = 1_000_000_000


@pytest.fixture(scope='module')
def recording(tmp_path_factory):
    """Return a recording of twin and diagnosis over the paper's schedule."""
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    from bearing_twin.offline.run import run_offline

    target = tmp_path_factory.mktemp('view') / 'inner'
    run_offline(SCHEDULE, target, twin={'defect': 'inner'})
    return target


@pytest.fixture(scope='module')
def picture(recording, tmp_path_factory):
    """Return the Rerun file of it."""
    rrd = tmp_path_factory.mktemp('rrd') / 'inner.rrd'
    assert draw_recordings([recording], rrd) == {}
    return rrd


def columns(rrd, entity, component):
    """Return times in ns and values of a component of an entity, row by row."""
    times, values = [], []
    for chunk in RrdReader(rrd).stream():
        if str(chunk.entity_path) != entity or chunk.is_static:
            continue
        batch = chunk.to_record_batch()
        names = batch.schema.names
        times += batch.column(names.index('ros_time')).cast('int64').to_pylist()
        data = next(n for n in names if n.endswith(f':{component}'))
        values += batch.column(names.index(data)).to_pylist()
    order = np.argsort(times, kind='stable')
    return np.array(times)[order], [values[k] for k in order]


def stamp(time):
    """Return a message that is stamped."""
    sec, nanosec = divmod(time, SECOND)
    return SimpleNamespace(
        header=SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id='')
    )


def test_every_sample_is_drawn_at_its_own_time(recording, picture):
    times, values = columns(picture, '/vibration/samples/y', 'scalars')
    blocks = [m.decode() for m in read_messages(recording, topics=['/vibration'])]
    samples = np.concatenate([block.y for block in blocks])
    assert len(values) == samples.size
    np.testing.assert_allclose(np.ravel(values), samples, rtol=1e-12)
    spacing = np.diff(times)
    np.testing.assert_allclose(spacing, SECOND / 25600, atol=2)


def test_the_verdict_is_drawn_where_its_window_ends(recording, picture):
    first = next(read_messages(recording, topics=['/diagnosis'])).decode()
    begin = first.header.stamp.sec * SECOND + first.header.stamp.nanosec
    times, values = columns(picture, '/diagnosis/verdict', 'state')
    assert times[0] == begin + round(first.sample_count / first.sample_rate * SECOND)
    assert values[-1] == ['inner']


def test_the_forces_drawn_are_those_of_the_model(recording):
    checked = 0
    for message in read_messages(recording, topics=['/twin_state']):
        state = message.decode()
        angles = state.cage_angle + np.arange(8) * 2.0 * np.pi / 8
        forces = contact_forces(
            angles, state.inner_x, state.inner_y, state.radial_clearance, state.k_b
        )
        # Balls step off the pitch positions by the cage's play, and into the defect.
        close = np.isclose(forces, state.ball_force, rtol=0.05, atol=6.0)
        checked += close.all()
    assert checked > 900


def test_the_cage_turns_slower_by_the_stated_factor(recording, picture):
    times, values = columns(picture, '/twin_state/bearing/balls', 'positions')
    ftf = [m.decode().ftf for m in read_messages(recording, topics=['/twin_state'])]
    angle = np.unwrap([math.atan2(balls[0][1], balls[0][0]) for balls in values])
    turns = (angle[-1] - angle[0]) / (2.0 * np.pi) * SLOWED
    seconds = (times[-1] - times[0]) / SECOND
    assert turns == pytest.approx(np.mean(ftf) * seconds, rel=0.01)


def test_cursors_stand_at_the_fault_frequencies():
    f = fault_frequencies(find_bearing('6307'), 25.0)
    message = SimpleNamespace(bpfo=f.bpfo, bpfi=f.bpfi, bsf=f.bsf, ftf=f.ftf, shaft_hz=25.0)
    drawn = cursors(message, harmonics=2)
    assert [x for x, _ in drawn['outer']] == pytest.approx([f.bpfo, 2 * f.bpfo])
    assert [x for x, _ in drawn['cage']] == pytest.approx([f.ftf, 2 * f.ftf])
    places = [k * f.bpfi + s for k in (1, 2) for s in (-25.0, 0.0, 25.0)]
    assert [x for x, _ in drawn['inner']] == pytest.approx(places)
    places = [2 * k * f.bsf + s for k in (1, 2) for s in (-f.ftf, 0.0, f.ftf)]
    assert [x for x, _ in drawn['ball']] == pytest.approx(places)
    message.bpfo = math.nan
    assert 'outer' not in cursors(message)


def test_pooling_keeps_every_peak_at_its_frequency():
    values = np.random.default_rng(1).random(51201)
    values[12345] = 9.0
    frequencies, heights, width = pooled(values, 0.25, 0.25)
    assert len(heights) <= 300
    assert frequencies[heights.argmax()] == 0.25 + 12345 * 0.25
    assert len(heights) * width >= 51201 * 0.25


@pytest.mark.parametrize('size', [1, 15, 16, 17, 1024, 1030])
def test_thinning_keeps_the_extremes_of_every_group(size):
    samples = np.random.default_rng(size).normal(size=size)
    kept = extremes(samples, 16)
    assert (np.diff(kept) > 0).all()
    for start in range(0, size - 15, 16):
        inside = kept[(kept >= start) & (kept < start + 16)]
        assert samples[inside].max() == samples[start : start + 16].max()
        assert samples[inside].min() == samples[start : start + 16].min()


def test_a_stamp_of_another_day_is_shifted_and_keeps_its_distances():
    base = Timebase()
    now, then = 1_795_000_000 * SECOND, 1_577_836_800 * SECOND
    assert base.of(stamp(now - 3 * SECOND), now) == now - 3 * SECOND
    first = base.of(stamp(then), now)
    assert first == now
    # The first was slow; what comes faster sets the offset, and nothing is ahead of its arrival.
    second = base.of(stamp(then + SECOND), now + SECOND - 250_000_000)
    assert second == now + SECOND - 250_000_000
    third = base.of(stamp(then + 2 * SECOND), now + 2 * SECOND)
    assert third - second == SECOND
    assert base.of(SimpleNamespace(data=1.0), now) == now


def test_nothing_that_a_message_holds_reaches_the_caller(tmp_path):
    odd = [
        None,
        3,
        SimpleNamespace(),
        SimpleNamespace(header=None, values=[], bin_hz=math.nan),
        SimpleNamespace(sample_rate=math.inf, x=[1, 2], y='text', unit=None, shaft_hz=None),
        SimpleNamespace(sample_rate=25600.0, x=[], y=np.full(100, np.nan), unit='g'),
        SimpleNamespace(temperature=math.nan, variance=-1.0),
        SimpleNamespace(status=[SimpleNamespace(level=99, name='', values=None)]),
        SimpleNamespace(level=3, msg=b'\xff', name='/a b//c'),
        stamp(2**62),
    ]
    types = [
        'bearing_twin_msgs/msg/Vibration',
        'bearing_twin_msgs/msg/TwinState',
        'bearing_twin_msgs/msg/Diagnosis',
        'bearing_twin_msgs/msg/Spectrum',
        'bearing_twin_msgs/msg/Checkpoint',
        'sensor_msgs/msg/Temperature',
        'diagnostic_msgs/msg/DiagnosticArray',
        'rcl_interfaces/msg/Log',
        'some_msgs/msg/Unknown',
        '',
    ]
    with RerunLogger(recording_id='odd', rrd=tmp_path / 'odd.rrd') as logger:
        for message in odd:
            for k, type_name in enumerate(types):
                logger.log(f'/line {k}//x/', type_name, message, SECOND * 100)
    assert logger.failed > 20
    assert all(logger.problems.values())
    assert list(RrdReader(tmp_path / 'odd.rrd').stream())


def test_namespaces_are_scenes_of_their_own(recording, tmp_path):
    rrd = tmp_path / 'fleet.rrd'
    with RerunLogger(recording_id='fleet', rrd=rrd) as logger:
        for k, message in enumerate(read_messages(recording, topics=['/diagnosis', '/vibration'])):
            for bearing in ('/line3/bearing_7', '/line3/bearing_8'):
                logger.log(
                    bearing + message.topic, message.type_name, message.decode(), message.log_time
                )
            if k > 100:
                break
    entities = {str(chunk.entity_path) for chunk in RrdReader(rrd).stream()}
    for bearing in ('/line3/bearing_7', '/line3/bearing_8'):
        assert f'{bearing}/diagnosis/verdict' in entities
        assert f'{bearing}/vibration/samples/y' in entities


def test_a_client_that_never_reads_holds_nothing_up(recording, tmp_path):
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        port = probe.getsockname()[1]
    messages = [
        (m.topic, m.type_name, m.decode(), m.log_time)
        for m in read_messages(recording, topics=['/vibration'])
    ][:250]
    with (
        RerunLogger(
            recording_id='deaf', serve=(LOOPBACK, port), memory_limit='1MB', full_samples=True
        ) as logger,
        socket.create_connection((LOOPBACK, port)) as deaf,
    ):
        deaf.sendall(b'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n')
        for _ in range(8):
            for message in messages:
                logger.log(*message)
    assert logger.failed == 0


def test_files_and_ports_in_use_are_refused(tmp_path):
    rrd = tmp_path / 'a.rrd'
    rrd.write_bytes(b'precious')
    with pytest.raises(BearingTwinError, match='not overwritten'):
        RerunLogger(recording_id='a', rrd=rrd)
    assert rrd.read_bytes() == b'precious'
    with pytest.raises(BearingTwinError, match='no folder'):
        RerunLogger(recording_id='a', rrd=tmp_path / 'none' / 'a.rrd')
    with socket.socket() as taken:
        taken.bind((LOOPBACK, 0))
        taken.listen()
        with pytest.raises(BearingTwinError, match='port'):
            RerunLogger(recording_id='a', serve=(LOOPBACK, taken.getsockname()[1]))


@pytest.mark.parametrize(
    ('text', 'url'),
    [
        ('9876', 'rerun+http://127.0.0.1:9876/proxy'),
        ('10.0.0.5:80', 'rerun+http://10.0.0.5:80/proxy'),
        ('rerun+http://a:1/proxy', 'rerun+http://a:1/proxy'),
    ],
)
def test_servers_are_named_in_three_ways(text, url):
    assert live_url(text) == url


@pytest.mark.parametrize('text', ['', '0', '70000', 'host', 'http://x', 'a b:1'])
def test_what_is_no_server_is_refused(text):
    with pytest.raises(BearingTwinError, match='no Rerun server'):
        live_url(text)


def test_a_folder_stands_for_the_bag_in_it(recording, tmp_path):
    run = tmp_path / 'demo'
    run.mkdir()
    (run / 'bag').symlink_to(recording, target_is_directory=True)
    (run / 'view.rrd').touch()
    assert find_recording(run) == run / 'bag'
    assert find_recording(run / 'view.rrd') == run / 'view.rrd'
    with pytest.raises(BearingTwinError, match='does not exist'):
        find_recording(tmp_path / 'nothing')
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BearingTwinError, match='no recording'):
        find_recording(tmp_path / 'empty')


def test_the_command_says_what_is_wrong(tmp_path, capsys):
    assert cli.main(['view']) == 1
    assert '--live' in capsys.readouterr().err
    torn = tmp_path / 'x.mcap'
    torn.write_bytes(b'no mcap at all')
    assert cli.main(['view', str(torn), '--save', str(tmp_path / 'x.rrd')]) == 1
    assert 'Traceback' not in capsys.readouterr().err
