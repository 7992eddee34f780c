# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The viewer itself, without a display: no view reports an error and none is empty."""

import contextlib
from functools import cache
import io
import json
import math
import os
from pathlib import Path
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from bearing_twin import cli
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.recording.topics import FEATURES
from bearing_twin.recording.writer import RecordingWriter, WriterOptions
from bearing_twin.stamps import split_ns
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.opening import draw_recordings
from bearing_twin.view.rerun.viewer import HeadlessViewer, listening, LOOPBACK
from bearing_twin.view.trends import TWIN_STATE
from cases import in_proofs
import matplotlib.image
import numpy as np
from PIL import Image, ImageOps
import pytest
from rerun.chunk import RrdReader
from rosbags.typesys import get_typestore, Stores

pytestmark = pytest.mark.vulkan

ROOT = Path(__file__).resolve().parents[2]
SCHEDULE = ROOT / 'recordings' / 'paper_schedule.mcap'
IMAGES = ROOT / 'docs' / 'images'
WRITING = {'TextDocument', 'TextLog'}
LAPTOP = (1366, 768)
PAGES = {
    'Verdict': {
        'Verdict',
        'Reasons',
        'Bearing, 40 x slower, shift x 100',
        'Squared envelope spectrum: modulation index over Hz',
        'Colours',
        'First harmonic, enlarged [1 over Hz]',
        'Verdict over time',
        'Evidence over its limits [1]',
        'Vibration level [m/s²] rms',
        'Temperature [°C], twin orange',
    },
    'Vibration': {
        'Vibration [m/s²], last 0.25 s',
        'Extremes over 10 s [m/s²]: vertical blue, horizontal olive',
        'Spectrogram of the last minute',
        'Spectrum [m/s² over Hz]',
    },
    'Evidence': {
        'Significance [σ over noise]',
        'Modulation index [1]',
        'Vibration level [m/s²] rms',
        'Velocity [mm/s rms]',
        'Kurtosis [1], crest factor green',
        'Colours',
    },
    'Temperature': {
        'Waveform over temperature',
        'Bearing, 40 x slower, shift x 100',
        'Temperature [°C], twin orange',
        'Amplitude against 20 °C [%] over °C',
        'Level, rms against 20 °C [%] over °C',
        'Frequency found against 20 °C [%] over °C',
        'Frequency, twin against 20 °C [%] over °C',
        'Cage slip, twin [%] over °C',
    },
    'Twin': {panel.named for panel in TWIN_STATE[1:]},
}
COLOURED, WRITTEN = 30, 300
"""Fewest coloured pixels of a picture that is not empty, and fewest bright ones of a text."""


def warming(seconds, folder, defect):
    """Return a recording over the paper's temperatures in a shorter time."""
    from bearing_twin.offline.run import run_offline

    source = folder / 'inputs.mcap'
    write_temperature_recording(source, *paper_schedule(seconds), source='test')
    run_offline(source, folder / defect, twin={'defect': defect})
    source.unlink()
    return folder / defect


@pytest.fixture(scope='module')
def recordings(tmp_path_factory):
    """Return a healthy recording and one with a defect, too quick for a curve over temperature."""
    folder = tmp_path_factory.mktemp('recordings')
    return [warming(20.0, folder, defect) for defect in ('none', 'outer')]


@pytest.fixture(scope='module')
def short(tmp_path_factory):
    """Return a recording of three seconds, for what is seen of any."""
    return warming(3.0, tmp_path_factory.mktemp('short'), 'outer')


@pytest.fixture(scope='module', autouse=True)
def _vulkan(tmp_path_factory):
    rrd = tmp_path_factory.mktemp('probe') / 'probe.rrd'
    with RerunLogger(recording_id='probe', rrd=rrd):
        pass
    try:
        HeadlessViewer([str(rrd)], size=(200, 200)).close()
    except BearingTwinError as error:
        if 'Vulkan' not in str(error) or os.environ.get('BEARING_TWIN_VULKAN') == 'required':
            raise
        pytest.skip(str(error))


def shots(viewer, names=('',), taken=()):
    """
    Return the views in front whose names begin so, in that order, each with its picture.

    Views that already have a picture are left out.
    """
    views = viewer.client.get_state().views
    known = {view.view_id for view, _ in taken}
    for view in (v for name in names for v in views if v.name.startswith(name)):
        # Those of other pages have none.
        if view.view_id not in known:
            known.add(view.view_id)
            with contextlib.suppress(ConnectionError):
                yield view, viewer.client.take_screenshot(view.view_id)


def seen(viewer, taken=()):
    """Return the names of the views in front, and what is wrong with them."""
    names, views = [], viewer.client.get_state().views
    found = [f'{v.name}: {r.severity} {r.summary}' for v in views for r in v.reports]
    for view, shot in [*taken, *shots(viewer, taken=taken)]:
        names.append(view.name)
        rgb = matplotlib.image.imread(io.BytesIO(shot))[..., :3]
        if view.view_class in WRITING:
            full = (rgb.min(axis=2) > 0.5).sum() > WRITTEN
        else:
            # Grounds, grids and axes are grey; whatever shows data has a colour.
            full = (np.ptp(rgb, axis=2) > 0.25).sum() > COLOURED
        if not full:
            found.append(f'{view.name} ({view.view_class}, {view.origin}) is empty')
    return names, found


NUMBERED = {
    # Without a page: two recordings side by side.
    '': ('Envelope spectrum',),
    'Verdict': ('First harmonic', 'Squared envelope spectrum'),
    'Temperature': ('Amplitude', 'Level', 'Frequency found', 'Frequency, twin', 'Cage slip'),
}
"""Views whose axis of frequency or temperature has at least two numbers on a laptop."""


def turn_to(viewer, page):
    """Bring a page to the front, as a click on its tab does."""
    entities = viewer.client.get_blueprint().blueprint
    containers = {path: of.get('ContainerBlueprint', {}) for path, of in entities.items()}
    [name] = [path for path, of in containers.items() if of.get('display_name') == page]
    [tabs] = [of for of in containers.values() if 'active_tab' in of]
    tabs['active_tab'] = name.strip('/')
    viewer.client.set_blueprint(entities, 'recording')
    viewer.wait()


@pytest.fixture(scope='module')
def shown(recordings, scheduled, tmp_path_factory):
    """Return what a viewer shows of a page: views, what is wrong with them, pictures to read."""

    @cache
    def shown_of(pages):
        rrd = tmp_path_factory.mktemp('page') / 'outer.rrd'
        if 'Temperature' in pages:
            drawn = [scheduled(defect='outer')]
        else:
            drawn = recordings[1:] if pages[0] else recordings
        assert draw_recordings(drawn, rrd, page=pages[0]) == {}
        found = {}
        with HeadlessViewer([str(rrd)], size=LAPTOP) as viewer:
            viewer.wait()
            for page in pages:
                wanted = NUMBERED.get(page, ())
                if page == 'Verdict':
                    wanted += ('Verdict', 'Reasons', 'Colours')
                if page != pages[0]:
                    turn_to(viewer, page)
                # To ask for a view of another page puts a message over those in front.
                taken = list(shots(viewer, wanted))
                pictures = {view.name: png for view, png in taken}
                found[page] = *seen(viewer, taken), pictures
        return found

    def show(page):
        together = ('Vibration', 'Evidence', 'Twin')
        return shown_of(together if page in together else (page,))[page]

    return show


@pytest.mark.parametrize(
    'page', ['Verdict', 'Temperature', *in_proofs('Vibration', 'Evidence', 'Twin')]
)
def test_a_recording_fills_every_view_of_every_page(shown, page):
    names, found, _ = shown(page)
    assert found == []
    assert set(names) == PAGES[page]


MOST_OTHER = 0.01
"""Largest part of a picture that another machine draws otherwise; a line more changes 2 %."""
JOINTS = 'sensor_msgs/msg/JointState'
READ = {
    'none': ('healthy', ('next step', 'no fault comb')),
    'outer': ('outer race fault', ('found', 'hz, expected', 'next step', 'outer: comb at')),
    'stopped': (
        'inner race fault at the end: held, shaft standing',
        ('windows, from', 'shaft standing', 'hz, expected', 'next step', 'inner: comb at'),
    ),
}
"""What a laptop shows of each recording without scrolling: on the card, and among the reasons."""


@pytest.fixture(scope='module')
def stopped(tmp_path_factory):
    """Return a recording with a defect, whose shaft stands from 24 s on."""
    from bearing_twin.offline.run import run_offline

    source = tmp_path_factory.mktemp('viewer') / 'stopped.mcap'
    store = get_typestore(Stores.ROS2_KILTED)
    joints, header, time = (
        store.types[name]
        for name in (JOINTS, 'std_msgs/msg/Header', 'builtin_interfaces/msg/Time')
    )
    with RecordingWriter(source, WriterOptions()) as writer:
        begin = next(read_messages(SCHEDULE)).log_time
        for message in read_messages(SCHEDULE):
            now = message.log_time
            speed = np.array([2.0 * math.pi * (25.0 if now - begin < 24e9 else 0.0)])
            sec, nanosec = split_ns(now)
            stamp = header(stamp=time(sec=sec, nanosec=nanosec), frame_id='')
            turning = joints(
                header=stamp, name=['shaft'], position=speed, velocity=speed, effort=speed
            )
            for topic, name, cdr in (
                (message.topic, message.type_name, message.cdr),
                ('/joint_states', JOINTS, bytes(store.serialize_cdr(turning, JOINTS))),
            ):
                writer.write(topic, name, cdr, log_time=now, qos='')
    run_offline(source, source.with_suffix(''), twin={'defect': 'inner', 'joint': 'shaft'})
    return source.with_suffix('')


AXIS = 18
"""Height of the numbers of an axis, pixels."""


def read(png):
    """Return the letters of a picture, in small ones and with single spaces."""
    # Letters are white on whatever colour: of the three channels the lowest.
    rgb = matplotlib.image.imread(io.BytesIO(png))[..., :3]
    letters = Image.fromarray(np.uint8(255.0 * (1.0 - rgb.min(axis=2))))
    large = io.BytesIO()
    letters = letters.resize((3 * letters.width, 3 * letters.height), Image.Resampling.LANCZOS)
    ImageOps.expand(letters, 30, 255).save(large, 'PNG')
    # Its threads wait for each other busily: one alone takes a third of their time.
    done = subprocess.run(
        ['tesseract', '-', '-', '--psm', '6'], env=os.environ | {'OMP_THREAD_LIMIT': '1'},
        input=large.getvalue(), capture_output=True, check=True, timeout=120,
    )  # fmt: skip
    return ' '.join(done.stdout.decode().lower().split())


@pytest.mark.skipif(
    shutil.which('tesseract') is None and os.environ.get('BEARING_TWIN_VULKAN') != 'required',
    reason='there is no tesseract',
)
@pytest.mark.parametrize('name', ['outer', *in_proofs('none', 'stopped')])
def test_a_laptop_shows_the_answer_and_why_without_scrolling(
    recordings, stopped, shown, tmp_path, name
):
    rrd, (card, reasons) = tmp_path / f'{name}.rrd', READ[name]
    if name == 'outer':
        *_, pictures = shown('Verdict')
    else:
        draw_recordings([recordings[0] if name == 'none' else stopped], rrd)
        with HeadlessViewer([str(rrd)], size=LAPTOP) as viewer:
            viewer.wait()
            pictures = {view.name: shot for view, shot in shots(viewer, ('Verdict', 'Reasons'))}
    assert card in read(pictures['Verdict'])
    words = read(pictures['Reasons'])
    assert [text for text in reasons if text not in words] == []


@pytest.mark.skipif(
    shutil.which('tesseract') is None and os.environ.get('BEARING_TWIN_VULKAN') != 'required',
    reason='there is no tesseract',
)
@pytest.mark.parametrize('page', ['Verdict', 'Temperature', *in_proofs('')])
def test_an_axis_has_two_numbers_on_a_laptop(shown, page):
    *_, pictures = shown(page)
    found = {}
    for name, png in pictures.items():
        if name.startswith(NUMBERED[page]):
            with Image.open(io.BytesIO(png)) as shot:
                strip = io.BytesIO()
                shot.crop((0, shot.height - AXIS, *shot.size)).save(strip, 'PNG')
            found[name] = set(re.findall(r'\d+', read(strip.getvalue())))
    assert len(found) == len(NUMBERED[page])
    assert [name for name, numbers in found.items() if len(numbers) < 2] == []
    if page == 'Verdict':
        words = read(pictures['Colours'])
        assert 'bpfi 126' in words and 'shaft 25.4' in words


def test_the_pictures_of_the_docs_show_the_views_of_today():
    kept = set(json.loads((IMAGES / 'views.json').read_text(encoding='utf-8')))
    assert kept == set().union(*PAGES.values()), 'take them again: make screenshots'


@pytest.mark.proof
def test_the_picture_of_the_docs_is_what_is_drawn_today(scheduled, tmp_path):
    rrd, today = tmp_path / 'inner.rrd', tmp_path / 'today.png'
    assert draw_recordings([scheduled(defect='inner')], rrd) == {}
    with Image.open(IMAGES / 'recording.png') as picture:
        kept = np.asarray(picture.convert('RGB'), float)
    with HeadlessViewer([str(rrd)], size=LAPTOP) as viewer:
        viewer.wait(24.0)
        # On a busy machine views fill some time after the viewer has loaded.
        deadline, other = time.monotonic() + 60.0, 1.0
        while other > MOST_OTHER and time.monotonic() < deadline:
            viewer.screenshot(today)
            with Image.open(today) as picture:
                # Without the viewer's title bar, as make screenshots keeps it.
                box = (0, LAPTOP[1] - len(kept), *LAPTOP)
                now = np.asarray(picture.convert('RGB').crop(box), float)
            other = (np.abs(now - kept).max(axis=2) > 16.0).mean()
    assert other <= MOST_OTHER, 'take them again: make screenshots'


def test_rerun_alone_shows_each_figure_of_a_verdict(recordings):
    """
    Opened without a layout of ours, Rerun adds a view for each of them.

    It has once left one out for a minute, on a busy machine, and in no other opening: the views
    follow the order in which it comes to the data.
    """
    figures, missing = {'temperature', *(f'features/{name}' for name in FEATURES)}, []
    for _ in range(2):
        with HeadlessViewer([str(next(recordings[1].glob('*.mcap')))], size=LAPTOP) as viewer:
            viewer.wait()
            deadline, paths = time.monotonic() + 60.0, set()
            while not figures <= paths and time.monotonic() < deadline:
                time.sleep(0.2)
                paths = {str(view.origin).strip('/') for view in viewer.client.get_state().views}
        missing.append(figures - paths)
        if not missing[-1]:
            return
    pytest.fail(f'without a view: {missing}')


@pytest.mark.proof
def test_two_recordings_fill_every_view(shown):
    names, found, _ = shown('')
    assert found == []
    assert {'Verdict: none', 'Verdict: outer'} <= set(names)
    assert names.count('Envelope spectrum: index over Hz') == 2


def test_a_late_viewer_of_a_running_server_sees_the_past(recordings):
    before = set(listening(os.getpid()))
    with RerunLogger(recording_id='live', serve=(LOOPBACK, 0)) as logger:
        [port] = set(listening(os.getpid())) - before
        for count, message in enumerate(read_messages(recordings[1])):
            logger.log(message.topic, message.type_name, message.decode(), message.log_time)
            assert count % 500 or logger.drain(60.0)
        assert logger.drain(60.0)
        assert logger.dropped == 0
        with HeadlessViewer([f'rerun+http://{LOOPBACK}:{port}/proxy'], size=LAPTOP) as viewer:
            viewer.wait()
            names, found = seen(viewer)
            assert found == []
            assert set(names) == PAGES['Verdict']


SPEAKER = """
import os, sys, threading, time
from pathlib import Path
from bearing_twin.recording.reader import read_messages
from bearing_twin.view.rerun import outlet
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.viewer import listening, LOOPBACK
import rerun as rr

outlet.WAITING = 10
messages = [
    (m.topic, m.type_name, m.decode(), m.log_time)
    for m in read_messages(Path(sys.argv[1]), topics=['/vibration'])
]
logger = RerunLogger(
    recording_id='frozen',
    rrd=Path(sys.argv[2]),
    serve=(LOOPBACK, 0),
    memory_limit='1MB',
    full_samples=True,
)
for message in messages:
    logger.log(*message)
print(*listening(os.getpid()), flush=True)
sys.stdin.readline()

# What holds up the whole machine or the process holds up this thread as well.
held_up = 0.0
def watch():
    global held_up
    while True:
        before = time.perf_counter()
        time.sleep(0.001)
        held_up = max(held_up, time.perf_counter() - before)
threading.Thread(target=watch, daemon=True).start()
# The buffers of Rerun alone take six minutes of samples, and it lets a viewer go that has not read
# for 20 s: long texts fill them before that. They are for viewers only: the file would be 0.8 GB.
text = rr.TextLog(os.urandom(2_000_000).hex())
logger._served.put(lambda recording: recording.log('/text', text))
while logger.drain(2.0):
    logger._served.put(lambda recording: recording.log('/text', text))
longest, calls = 0.0, len(messages)
while logger.dropped < 100 and calls < 40_000:
    for message in messages:
        before = time.perf_counter()
        logger.log(*message)
        longest = max(longest, time.perf_counter() - before)
        calls += 1
        if calls % 4 == 0:
            time.sleep(0.001)
closing = time.perf_counter()
logger.close()
closing = time.perf_counter() - closing
print(longest - held_up, closing, calls, messages[0][2].y.size, logger.dropped, logger.failed)
"""


def test_a_frozen_viewer_holds_nothing_up(recordings, tmp_path):
    rrd = tmp_path / 'frozen.rrd'
    with subprocess.Popen(
        [sys.executable, '-c', SPEAKER, str(recordings[0]), str(rrd)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as speaker:
        try:
            port = int(speaker.stdout.readline())
            url = f'rerun+http://{LOOPBACK}:{port}/proxy'
            with HeadlessViewer([url], size=(200, 200)) as viewer:
                viewer.wait()
                os.kill(viewer.pid, signal.SIGSTOP)
                try:
                    answer, _ = speaker.communicate('\n', timeout=900)
                finally:
                    os.kill(viewer.pid, signal.SIGCONT)
        finally:
            speaker.kill()
    # It ends by itself while the viewer is still frozen.
    assert speaker.returncode == 0
    longest, closing, calls, size, dropped, failed = map(float, answer.split())
    assert dropped >= 100
    assert failed == 0
    assert longest < 0.5
    # Rerun itself would wait for 20 s.
    assert closing < 10.0
    axis = '/vibration/samples/y'
    rows = sum(c.num_rows for c in RrdReader(rrd).stream() if str(c.entity_path) == axis)
    # One more row, its look, is static.
    assert rows - 1 == calls * size


def test_the_command_writes_a_picture_and_leaves_nothing_else(short, tmp_path, monkeypatch):
    """Of a recording with a name in any script."""
    named, temporary = tmp_path / 'fan 軸受 ünïcode', tmp_path / 'temporary'
    named.symlink_to(short)
    target = tmp_path / 'shot.png'
    temporary.mkdir()
    monkeypatch.setenv('TMPDIR', str(temporary))
    monkeypatch.setattr(tempfile, 'tempdir', str(temporary))
    arguments = ['view', str(named), '--screenshot', str(target), '--size', '900x600']
    assert cli.main([*arguments, '--at', '2']) == 0
    assert matplotlib.image.imread(target).shape[:2] == (600, 900)
    assert cli.main([*arguments, '--at', '2000']) == 1
    assert list(temporary.iterdir()) == []
