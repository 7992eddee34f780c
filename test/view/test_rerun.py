# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is drawn, read back from the Rerun files: positions, times, forces, and no failure."""

from io import BytesIO
import math
from pathlib import Path
import re
import struct
from types import SimpleNamespace

from bearing_twin.assets.parameters.twin import SPECS
from bearing_twin.bearing import fault_frequencies
from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.dynamics.equations.load_zone import contact_forces
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import START
from bearing_twin.recording.topics import FEATURES
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.streams.vibration_input import SOURCE_SIMULATED
from bearing_twin.view.rerun.canvas import Canvas
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.opening import draw_recordings
from bearing_twin.view.rerun.pictures.bearing3d import SLOWED
from bearing_twin.view.rerun.pictures.calibration import _words
from bearing_twin.view.rerun.pictures.picture import Asset
from bearing_twin.view.rerun.pictures.spectra import SpectrumBars, vector
from bearing_twin.view.rerun.pictures.spectrogram import COLUMNS, ROWS, Spectrogram
from bearing_twin.view.rerun.pictures.texts import parameter_tables
from bearing_twin.view.rerun.pictures.waveform import extremes
from bearing_twin.view.rerun.timebase import Timebase
from bearing_twin.view.spectrum import ENVELOPE
from copies import raw_recording
from drawn import columns, message, SECOND, stamp, VIBRATION, view_names
import numpy as np
from PIL import Image
import pytest
import rerun as rr
from rerun.chunk import McapReader, RrdReader
from scipy.signal import welch
import yaml

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'


@pytest.fixture(scope='module')
def picture(recording, tmp_path_factory):
    """Return the Rerun file of it."""
    rrd = tmp_path_factory.mktemp('rrd') / 'inner.rrd'
    assert draw_recordings([recording], rrd) == {}
    return rrd


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
    # A schedule has no date: time counts from its beginning.
    begin -= START
    assert times[0] == begin + round(first.sample_count / first.sample_rate * SECOND)
    assert values[-1] == ['inner']


def test_a_picture_begins_with_the_vibration(recording, tmp_path):
    late, rrd = tmp_path / 'late.mcap', tmp_path / 'late.rrd'
    today = START + 1000 * 86400 * SECOND
    with RecordingWriter(late, WriterOptions()) as writer:
        for recorded in read_messages(recording):
            # Seconds in which the twin compiles, while the sensor and the parameters are there.
            early = recorded.topic in ('/temperature', '/twin_checkpoint')
            if not early and recorded.log_time > START + 4 * SECOND:
                continue
            time = recorded.log_time - START + today + (0 if early else 20 * SECOND)
            writer.write(
                recorded.topic, recorded.type_name, recorded.cdr,
                log_time=time, qos='',
            )  # fmt: skip
    assert draw_recordings([late], rrd) == {}
    vibration = next(read_messages(late, topics=['/vibration'])).log_time
    for entity, component in (
        ('/temperature/measured', 'values'),
        ('/twin_checkpoint/parameters', 'text'),
    ):
        times, values = columns(rrd, entity, component)
        assert len(values)
        assert times[0] >= vibration - SECOND


def test_rerun_without_us_draws_each_figure_under_its_name(recording):
    drawn = {}
    for chunk in McapReader(next(recording.glob('*.mcap'))).stream():
        names = set(chunk.to_record_batch().schema.names)
        if names & {'Scalars:scalars', 'Measurements:values'}:
            drawn[str(chunk.entity_path)] = names
    assert set(drawn) == {'/temperature', *(f'/features/{name}' for name in FEATURES)}


def test_the_forces_drawn_are_those_of_the_model(recording):
    checked = 0
    for recorded in read_messages(recording, topics=['/twin_state']):
        state = recorded.decode()
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


def test_a_fleet_keeps_the_parameters_of_each_bearing_apart(tmp_path):
    configuration = {
        'line3/pump': {'bearing': '6307', 'defect': 'inner', 'seed': 1},
        'line3/fan': {'bearing': '6205', 'defect': 'none', 'seed': 2},
    }
    checkpoint = stamp(SECOND)
    checkpoint.node, checkpoint.kind, checkpoint.version = '/fleet', 'fleet', '0.1.0'
    checkpoint.configuration = yaml.safe_dump(configuration)
    assert parameter_tables(configuration) == configuration
    assert parameter_tables({'a': 1, 'b': 'x'}) == {'': {'a': 1, 'b': 'x'}}
    rrd = tmp_path / 'fleet.rrd'
    with RerunLogger(recording_id='fleet', rrd=rrd) as logger:
        logger.log('/fleet/checkpoint', 'bearing_twin_msgs/msg/Checkpoint', checkpoint, SECOND)
    assert logger.problems == {}
    _, ((text,),) = columns(rrd, '/fleet/checkpoint/parameters', 'text')
    fan, pump = text.split('#### ')[1:]
    assert pump.startswith('line3/pump')
    assert '| bearing | 6307 | defect | inner |' in pump
    assert '| bearing | 6205 | defect | none |' in fan


def test_a_file_that_is_drawn_at_once_has_one_layout(tmp_path):
    """The viewer would take minutes for those of a fleet whose topics appear one by one."""
    layouts = []
    for footer in (True, False):
        rrd = tmp_path / f'{footer}.rrd'
        with RerunLogger(recording_id='fleet', rrd=rrd, footer=footer) as logger:
            for k in range(400):
                time = SECOND + k * SECOND // 10
                # Seven within 21 s, and the last one at the end.
                for pump in range(min(1 + k // 30, 7) + (k > 380)):
                    logger.log(f'/p{pump}/vibration', VIBRATION, vibration(k, time), time)
        assert logger.problems == {}
        layouts.append(len(RrdReader(rrd).blueprints()))
        assert '/p7' in view_names(rrd)
    assert layouts == [1, 2]


def test_a_fleet_says_what_simulated_each_vibration(tmp_path):
    checkpoint = stamp(SECOND)
    checkpoint.node, checkpoint.kind, checkpoint.version = '/plant/fleet', 'fleet', '0.1.0'
    values = {spec.name: spec.default for spec in SPECS} | {'preset': 'incipient'}
    configuration = {'p1': values | {'defect': 'inner'}, 'line3/p2': values | {'defect': 'none'}}
    checkpoint.configuration = yaml.safe_dump(configuration)
    rrd = tmp_path / 'fleet.rrd'
    with RerunLogger(recording_id='fleet', rrd=rrd) as logger:
        logger.log('/plant/p1/vibration', VIBRATION, vibration(0, SECOND), SECOND)
        logger.log(
            '/plant/fleet/checkpoint', 'bearing_twin_msgs/msg/Checkpoint', checkpoint, SECOND
        )
        logger.log('/plant/line3/p2/vibration', VIBRATION, vibration(0, SECOND), SECOND)
    assert logger.problems == {}
    sources = {}
    for chunk in RrdReader(rrd).stream():
        batch = chunk.to_record_batch()
        if 'source' in batch.schema.names:
            path = str(chunk.entity_path).replace('\\', '').partition('/__properties/')[2]
            sources[path] = batch.column('source').to_pylist()[0][0]
    text = 'simulated by /plant/fleet, preset incipient, '
    assert sources.pop('vibration plant/p1').startswith(f'{text}inner race')
    assert sources == {'vibration plant/line3/p2': f'{text}no defect'}


def vibration(k, time, amplitude=1.0, unit='m/s^2'):
    """Return the k-th block of a tenth of a second."""
    return message(
        'Vibration', time, sample_rate=2560.0, first_sample=256 * k, unit=unit,
        source=SOURCE_SIMULATED, y=amplitude * np.sin(np.arange(256.0)),
    )  # fmt: skip


def test_a_card_says_that_its_verdict_is_only_held(recording, tmp_path):
    """A fault is held for up to an hour, over windows and spectra that do not show it."""
    rrd, [*_, last] = tmp_path / 'held.rrd', read_messages(recording, topics=['/diagnosis'])
    verdict = last.decode()
    with RerunLogger(recording_id='held', rrd=rrd) as logger:
        for window, level in ((verdict.result, verdict.level), (0, 0), (6, verdict.level)):
            verdict.window_result, verdict.window_level = window, level
            verdict.header.stamp.sec += 1
            logger.log(last.topic, last.type_name, verdict, last.log_time)
    _, cards = columns(rrd, '/diagnosis/card', 'blob')
    assert cards[0] == cards[2] != cards[1]


@pytest.mark.parametrize(('level', 'alarm'), [(0, False), (2, True)])
@pytest.mark.parametrize('other', [False, True], ids=['alone', 'beside a second sensor'])
def test_a_verdict_without_vibration_is_not_shown_as_that_of_now(
    recording, tmp_path, level, alarm, other
):
    """A sensor that dies leaves its last verdict, which may be healthy."""
    rrd, [*_, last] = tmp_path / 'dead.rrd', read_messages(recording, topics=['/diagnosis'])
    verdict, now = last.decode(), last.log_time

    def say(name, level, text):
        status = SimpleNamespace(name=name, level=level, message=text)
        told = SimpleNamespace(status=[status])
        logger.log('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', told, now)

    with RerunLogger(recording_id='dead', rrd=rrd) as logger:
        for dead in (False, True, False):
            verdict.level = verdict.window_level = level
            logger.log('/fan' + last.topic, last.type_name, verdict, now)
            verdict.header.stamp.sec += 3
            now += 3 * SECOND
            if dead:
                say('fan/diagnosis: bearing', 3, 'no vibration used for 2.6 s; the last verdict')
            if other:
                say('fan/diagnosis_2: bearing', 0, 'healthy')
            # Said before the verdict and heard after it.
            now -= 4 * SECOND
            say('fan/diagnosis: bearing', 3, 'no verdict yet')
            say('fan/diagnosis: bearing', 0, 'inner')
            now += 4 * SECOND
    assert logger.problems == {}
    _, states = columns(rrd, '/fan/diagnosis/verdict', 'state')
    _, cards = columns(rrd, '/fan/diagnosis/card', 'blob')
    _, words = columns(rrd, '/fan/diagnosis/words', 'text')
    if other:
        # Whose verdict it is cannot be told.
        assert len(set(map(str, cards))) == 1
        return
    assert states == [['inner'], ['stale'], ['inner']]
    assert 'no vibration used for 2.6 s' in words[2][0]
    before, _, dead, after = (Image.open(BytesIO(np.array(card[0], np.uint8))) for card in cards)
    assert before == after != dead
    # Red stays, as the machine may be as it was; green does not.
    grounds = {card.convert('RGB').getpixel((0, 0)) for card in (before, dead)}
    assert len(grounds) == (1 if alarm else 2)


@pytest.mark.parametrize('period', [1, 10])
def test_a_node_that_is_killed_leaves_no_verdict_of_now(recording, tmp_path, period):
    """It cannot say that its verdict is old; ``period`` in s between its statuses."""
    rrd, [*_, last] = tmp_path / 'killed.rrd', read_messages(recording, topics=['/diagnosis'])
    verdict, begin = last.decode(), last.log_time
    verdict.level, ended = 0, 20

    def say(name, time):
        told = SimpleNamespace(status=[SimpleNamespace(name=name, level=0, message='')])
        logger.log('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray', told, time)

    with RerunLogger(recording_id='killed', rrd=rrd) as logger:
        logger.log(last.topic, last.type_name, verdict, begin)
        for second in range(1, 60):
            time = begin + second * SECOND
            if second <= ended and second % period == 0:
                say('diagnosis: bearing', time)
            say('recorder: recording', time)
            # Other nodes are as they were.
            say('twin: real time', time)
    assert logger.problems == {}
    times, states = columns(rrd, '/diagnostics/diagnosis_bearing', 'state')
    silent = next(t for t, state in zip(times, states, strict=True) if state == ['stale'])
    assert silent == begin + (ended + max(5, 3 * period) + 1) * SECOND
    _, cards = columns(rrd, '/diagnosis/card', 'blob')
    assert cards[0] != cards[1]
    _, words = columns(rrd, '/diagnosis/words', 'text')
    # On the card of the end of the recording too.
    assert all('diagnosis is silent' in text for (text,) in words[1:])
    _, others = columns(rrd, '/diagnostics/twin_real_time', 'state')
    assert {tuple(state) for state in others} == {('ok',)}


@pytest.mark.parametrize('step', [1, 30])
@pytest.mark.parametrize(('pause', 'parted'), [(2, False), (4, True), (600, True)])
def test_a_line_does_not_cross_a_pause(recording, tmp_path, pause, parted, step):
    rrd, [*_, last] = tmp_path / 'pause.rrd', read_messages(recording, topics=['/diagnosis'])
    verdict = last.decode()
    with RerunLogger(recording_id='pause', rrd=rrd) as logger:
        for number in (*range(10), *range(9 + pause, 20 + pause)):
            verdict.header.stamp.sec = last.log_time // SECOND + step * number
            logger.log(last.topic, last.type_name, verdict, verdict.header.stamp.sec * SECOND)
    assert logger.problems == {}
    times, values = columns(rrd, '/diagnosis/level/rms', 'scalars')
    (missing,) = np.isnan(values).nonzero()[:1]
    assert missing.tolist() == ([10] if parted else [])
    assert (np.diff(times) > 0).all()
    _, limits = columns(rrd, '/diagnosis/over_limits/limit/1', 'scalars')
    assert np.isfinite(limits).all()


@pytest.mark.parametrize(
    'sensors', [('vibration', 'nde'), ('nde', 'vibration'), ('nde', 'twin', 'vibration')]
)
def test_every_sensor_follows_the_temperature(tmp_path, sensors):
    rrd, growth = tmp_path / 'sensors.rrd', {'vibration': 1.0, 'nde': 2.0, 'twin': 4.0}
    with RerunLogger(recording_id='sensors', rrd=rrd) as logger:
        for k in range(60):
            time = SECOND + k * SECOND // 10
            if k > 3:
                # Not before all of them have spoken.
                warm = stamp(time)
                warm.temperature, warm.variance = 20.0 + 10.0 * (k // 10), 0.0
                logger.log('/temperature', 'sensor_msgs/msg/Temperature', warm, time)
            for name in sensors[: 1 + k]:
                unit = 'g' if name == 'nde' else 'm/s^2'
                block = vibration(k, time, 1.0 + growth[name] * (k // 10), unit)
                logger.log(f'/{name}', VIBRATION, block, time)
    assert logger.problems == {}
    views = {name for name in view_names(rrd) if name.endswith('last 0.25 s')}
    assert views == {'Vibration [g], last 0.25 s', 'Vibration [m/s²], last 0.25 s'}
    for name in sensors:
        drawn = {}
        for part in ('abscissa', 'values'):
            _, rows = columns(rrd, f'/{name}/over_temperature/level', part)
            drawn[part] = rows[-1][0]['buffer']
        # Two bars without height hold an axis that is numbered at each 100 degC only.
        assert drawn['abscissa'] == [20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 0.0, 100.0]
        changes = [100.0 * growth[name] * k for k in range(6)]
        assert drawn['values'] == pytest.approx([*changes, 0.0, 0.0])
        _, strips = columns(rrd, f'/{name}/waterfall', 'strips')
        assert len(strips[-1]) == 6


def twin_state(defect, time, **angles):
    """Return a state of a standing 6307."""
    pose = {'shaft_angle': 0.0, 'cage_angle': 0.0, 'ball_angle': 0.0} | angles
    return message(
        'TwinState',
        time,
        **pose,
        **dict.fromkeys(('shaft_hz', 'bsf', 'ftf', 'inner_x', 'inner_y'), 0.0),
        temperature_used=20.0,
        bearing='6307',
        defect=defect,
        radial_clearance=1e-5,
        k_b=1e10,
    )


def drawn_angle(points):
    """Return the angle from +x at which points lie, rad."""
    x, y, _ = np.mean(np.reshape(points, (-1, 3)), axis=0)
    return math.atan2(y, x)


def test_a_defect_that_changes_with_a_block_begins_the_waterfall_anew(tmp_path):
    with RerunLogger(recording_id='change', rrd=tmp_path / 'change.rrd') as logger:
        warm = stamp(SECOND)
        warm.temperature, warm.variance = 60.0, 0.0
        logger.log('/temperature', 'sensor_msgs/msg/Temperature', warm, SECOND)
        # Two blocks make a strip.
        for k, defect in enumerate(('inner', 'inner', 'outer')):
            time = SECOND + k * SECOND // 10
            logger.log('/vibration', VIBRATION, vibration(k, time), time)
            state = twin_state(defect, time)
            state.shaft_hz = 25.0
            logger.log('/twin_state', 'bearing_twin_msgs/msg/TwinState', state, time)
    assert logger.problems == {}


def test_defects_are_drawn_where_their_text_says(tmp_path):
    bearing, rrd = find_bearing('6307'), tmp_path / 'defects.rrd'
    text = 'inner:angle=1.2+outer:angle=-0.5+outer:angle=2.5+ball:ball=3,angle=0.4+cage:ball=2'
    start = {'shaft_angle': 0.7, 'cage_angle': 0.3, 'ball_angle': 0.9}
    with RerunLogger(recording_id='defects', rrd=rrd) as logger:
        state = twin_state(text, SECOND, **start)
        logger.log('/twin_state', 'bearing_twin_msgs/msg/TwinState', state, SECOND)
        healthy = twin_state('none', 2 * SECOND, **start)
        logger.log('/twin_state', 'bearing_twin_msgs/msg/TwinState', healthy, 2 * SECOND)
    assert logger.problems == {}
    root = '/twin_state/bearing'
    _, (inner, *_) = columns(rrd, f'{root}/inner/defect_0', 'strips')
    assert drawn_angle(inner) == pytest.approx(1.2)
    # The ring that carries it stands at the shaft's angle from the first moment on.
    _, (turn, *_) = columns(rrd, f'{root}/inner', 'quaternion')
    assert 2.0 * math.atan2(turn[0][2], turn[0][3]) == pytest.approx(0.7)
    for k, angle in ((1, -0.5), (2, 2.5)):
        _, (outer, *_) = columns(rrd, f'{root}/outer/defect_{k}', 'strips')
        assert drawn_angle(outer) == pytest.approx(angle)
    # Ball 3 is at 0.3 + 3/8 turns; its defect points to the shaft at a spin of 0.4.
    _, (ball, *_) = columns(rrd, f'{root}/defects/ball_3', 'positions')
    at = 0.3 + 3.0 * 2.0 * math.pi / 8.0
    centre = 500.0 * bearing.d_pitch * np.array([math.cos(at), math.sin(at)])
    offset = np.asarray(ball)[0, :2] - centre
    direction = at + math.pi - (0.9 - 0.4)
    assert offset / np.linalg.norm(offset) == pytest.approx(
        [math.cos(direction), math.sin(direction)]
    )
    _, (cage, *_) = columns(rrd, f'{root}/cage/defect_4', 'strips')
    assert drawn_angle(cage) == pytest.approx(math.pi / 2.0)
    times, _ = columns(rrd, f'{root}/inner/defect_0', 'is_recursive')
    assert list(times) == [2 * SECOND], 'the mark goes with the defect'


def test_topics_in_other_encodings_are_left_to_rerun(tmp_path):
    path, rrd = tmp_path / 'a.mcap', tmp_path / 'a.rrd'
    with raw_recording(path, profile='') as writer:
        schema = writer.register_schema('Log', 'jsonschema', b'{"type": "object"}')
        channel = writer.register_channel('/levels', 'json', schema)
        for k in range(5):
            writer.add_message(channel, SECOND + k, b'{"level": 1}', SECOND + k)
    assert draw_recordings([path], rrd).keys() == {'/levels'}
    drawn = [c for c in RrdReader(rrd).stream() if c.entity_path == '/levels']
    assert 5 in [chunk.num_rows for chunk in drawn]


def test_protobuf_of_others_is_a_table_and_no_complaint(tmp_path):
    path, rrd = tmp_path / 'a.mcap', tmp_path / 'a.rrd'
    # A FileDescriptorSet: file m.proto, message Motor with the field 'rpm' of type double.
    field = b'\x0a\x03rpm\x18\x01\x20\x01\x28\x01'
    motor = b'\x0a\x05Motor\x12' + bytes([len(field)]) + field
    file_descriptor = b'\x0a\x07m.proto\x22' + bytes([len(motor)]) + motor + b'\x62\x06proto3'
    schema_text = b'\x0a' + bytes([len(file_descriptor)]) + file_descriptor
    with raw_recording(path, profile='') as writer:
        schema = writer.register_schema('Motor', 'protobuf', schema_text)
        channel = writer.register_channel('/motor', 'protobuf', schema)
        for k in range(5):
            message = b'\x09' + struct.pack('<d', 1500.0 + k)
            writer.add_message(channel, SECOND + k, message, SECOND + k)
    assert draw_recordings([path], rrd) == {}
    chunks = [c for c in RrdReader(rrd).stream() if c.entity_path == '/motor']
    rows = [row for c in chunks if c.num_rows == 5 for row in c.to_record_batch().to_pylist()]
    assert [row['Motor:message'][0]['rpm'] for row in rows] == [1500.0 + k for k in range(5)]


@pytest.mark.parametrize('count', [2, 3])
def test_recordings_of_temperatures_alone_stand_side_by_side(tmp_path, count):
    rrd = tmp_path / 'a.rrd'
    assert draw_recordings([SCHEDULE] * count, rrd) == {}
    assert view_names(rrd).count('Temperature [°C]') == count


def test_a_fit_tells_the_defect_first_and_then_what_is_identifiable():
    names = ['gain', 'noise_floor', 'defect_width_mm']
    numbers = {name: [1.0, 2.0, 3.0] for name in ('q05', 'median', 'q95')}
    fit = message(
        'Calibration', quantity=names, quantity_unit=['', 'm/s^2/sqrt(Hz)', 'mm'],
        identifiable=[False, True, False], why=['', '', ''], **numbers,
    )  # fmt: skip
    rows = re.findall(r'(?m)^\| (\w+) \|', _words(fit))
    assert rows == ['quantity', 'defect_width_mm', 'noise_floor', 'gain']


def test_marks_of_a_fault_go_with_it():
    expected = fault_frequencies(find_bearing('6307'), 25.4)
    asset, paths = Asset(), []
    bars = SpectrumBars(Canvas(lambda mark, **_: paths.append(mark), '/e', Timebase()), asset)

    def draw(window, place, hertz):
        asset.diagnosis = message(
            'Diagnosis', first_sample=window, result_name=place, faults=[place], fault_hz=hertz
        )
        bars.draw(
            message(
                'Spectrum', kind=ENVELOPE, first_sample=window, start_hz=0.125, bin_hz=0.125,
                band_low=0.0, band_high=0.0, shaft_hz=25.4, values=np.full(6400, 1e-4),
                floor=np.full(6400, 1e-4), **expected._asdict(),
            ),
            window * SECOND,
        )  # fmt: skip
        return {key for key in bars._marked if key.endswith('_found')}

    assert draw(1, 'ball', 2.0 * expected.bsf) == {'whole/ball_found', 'near/ball_found'}
    # Else the long marks of the ball would stand below the verdict on the cage.
    assert draw(2, 'cage', expected.ftf) == {'whole/cage_found', 'near/cage_found'}


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
        for recorded in odd:
            for k, type_name in enumerate(types):
                logger.log(f'/line {k}//x/', type_name, recorded, SECOND * 100)
    assert logger.failed > 20
    assert all(logger.problems.values())
    assert list(RrdReader(tmp_path / 'odd.rrd').stream())


def test_a_pixel_of_many_samples_shows_their_peaks(picture):
    looks = {
        str(chunk.entity_path): chunk.to_record_batch().to_pydict()
        for chunk in RrdReader(picture).stream()
        if chunk.is_static
    }
    policy = looks['/vibration/samples/y']['SeriesLines:aggregation_policy']
    assert policy == [[rr.components.AggregationPolicy.MinMax.value]]


@pytest.mark.parametrize('block', [1024, 7680, 100_000])
def test_a_spectrogram_spans_a_minute_however_long_the_blocks(block):
    rate, quiet, loud = 25600.0, 20.0, 10.0
    picture = Spectrogram(Canvas(lambda mark, **_: None, '', Timebase()), 'spectrogram')
    level = np.repeat([1e-3, 1.0], [round(quiet * rate), round(loud * rate)])
    samples = level * np.random.default_rng(1).standard_normal(level.size)
    for first in range(0, samples.size, block):
        time = SECOND + round(first / rate * SECOND)
        picture.add(samples[first : first + block], time, rate, 'm/s^2')
    levels = picture.levels.mean(axis=0)
    assert np.isfinite(levels).sum() == (quiet + loud) / 60.0 * COLUMNS
    assert (levels > -60.0).sum() == loud / 60.0 * COLUMNS
    last = samples[-round(0.2 * rate) :]
    _, power = welch(last - last.mean(), nperseg=2 * ROWS, detrend=False, scaling='spectrum')
    assert np.allclose(picture.levels[:, -1], 10.0 * np.log10(power[1:]), atol=1e-9)


@pytest.mark.parametrize('gap', [0.0, 0.5, 12.0, 90.0])
def test_a_gap_is_as_long_in_the_spectrogram_as_it_was(gap):
    rate, before = 25600.0, 10.0
    picture = Spectrogram(Canvas(lambda mark, **_: None, '', Timebase()), 'spectrogram')
    samples = np.random.default_rng(1).standard_normal(round(rate))
    times = [*np.arange(before), *(before + gap + np.arange(10.0))]
    for time in times:
        picture.add(samples, SECOND + round(time * SECOND), rate, 'm/s^2')
    drawn = np.flatnonzero(np.isfinite(picture.levels[0]))
    blank = gap if gap >= 1.0 else 0.0
    # The newest are at the right, the others left of the gap.
    steps = [COLUMNS - round(5.0 * (before + blank + 10.0)) + k for k in range(50)]
    assert drawn.tolist() == [k for k in steps if k >= 0] + list(range(COLUMNS - 50, COLUMNS))


def test_snapshots_shorter_than_a_step_are_in_the_spectrogram():
    rate, sent = 25600.0, []
    canvas = Canvas(lambda mark, **_: sent.append(mark), '', Timebase())
    picture = Spectrogram(canvas, 'spectrogram')
    for k in range(4):
        samples = np.random.default_rng(k).standard_normal(round(0.1 * rate))
        picture.add(samples, SECOND + 10 * k * SECOND, rate, 'm/s^2')
        canvas.flush(slow=True)
        # Each of them is shown at once.
        assert len(sent) == k + 1
    assert np.flatnonzero(np.isfinite(picture.levels[0])).tolist() == [150, 200, 250]


@pytest.mark.parametrize('size', [1, 200])
def test_a_vector_is_what_rerun_makes_of_it(size):
    values = np.random.default_rng(2).standard_normal(size).astype(np.float32)
    made = rr.components.TensorDataBatch(values.astype(np.float64)).as_arrow_array()
    assert vector(values).equals(made)
    assert vector(values).type == made.type
