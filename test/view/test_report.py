# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The report: one page that needs nothing else, right about what is in the recording."""

from dataclasses import replace
import html
from html.parser import HTMLParser
import math
from pathlib import Path
import re
from types import SimpleNamespace

from bearing_twin import cli
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.writer import RecordingWriter
from bearing_twin.view.over_temperature import Strip, STRIP_SECONDS
from bearing_twin.view.report.appendix import off_default
from bearing_twin.view.report.data import collect
from bearing_twin.view.report.page import report_page
from bearing_twin.view.report.plots import (
    _all,
    _evidence,
    _history,
    _mark_limits,
    _other_evidence,
    _panels,
    _patches,
    _waterfall,
    verdicts_over_time,
)
from bearing_twin.view.report.svg import hex_colour
from bearing_twin.view.style import FAMILIES
from bearing_twin.view.trends import DIAGNOSIS, LINE, Panel, Trend, zone_limits
from copies import put
from matplotlib.figure import Figure
import numpy as np
import pytest
import yaml

SCHEDULE = Path(__file__).resolve().parents[2] / 'recordings' / 'paper_schedule.mcap'


def machines_of(path):
    return collect(path)[2]


def drawn(machine, *pictures):
    """Return caption and SVG of some of the pictures of the page, as it draws them."""
    return _all(machine, 'a', pictures)


@pytest.fixture(scope='module')
def recording(scheduled):
    """Return a recording of twin and diagnosis over the paper's schedule."""
    return scheduled(defect='inner', preset='incipient')


@pytest.fixture(scope='module')
def page(recording):
    """Return the report on it."""
    return report_page(recording)


class Elements(HTMLParser):
    """Collect tags, ids and references of a page, and check that tags are closed."""

    VOID = frozenset({'meta', 'br', 'link', 'img', 'hr', 'input', 'wbr'})

    def __init__(self, text):
        super().__init__()
        self.tags, self.ids, self.references = [], [], []
        self._open = []
        self.feed(text)
        assert not self._open, f'never closed: {self._open}'

    def handle_starttag(self, tag, attrs):
        self._note(tag, attrs)
        if tag not in self.VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self._note(tag, attrs)

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def _note(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name == 'id':
                self.ids.append(value)
            elif name in ('src', 'href', 'xlink:href', 'data', 'poster', 'action'):
                self.references.append(value)
            self.references += re.findall(r'url\((.*?)\)', value or '')


def rewritten(source, target, *, rename=lambda topic: [topic], metadata=None, until=None):
    """Copy a recording with other topics; return the new one."""
    with RecordingWriter(target) as writer:
        for name, values in (metadata or {}).items():
            writer.metadata(name, values)
        for message in read_messages(source, end=until):
            for topic in rename(message.topic):
                put(writer, message, topic)
    return target


def test_the_page_refers_to_nothing_outside_itself(page):
    elements = Elements(page)
    assert not {'script', 'link', 'img', 'iframe', 'object', 'base'} & set(elements.tags)
    assert len(elements.ids) == len(set(elements.ids))
    assert elements.references, 'the pictures use clip paths, so that there are references'
    for reference in elements.references:
        assert reference.startswith('#')
        assert reference[1:] in elements.ids
    assert '@import' not in page


def test_the_page_names_the_verdict_and_shows_every_picture(recording, page):
    (machine,) = machines_of(recording).values()
    worst = machine.headline.worst.best
    assert worst.result_name == 'inner'
    banner = re.search(r'<div class="verdict".*?</div>', page, re.DOTALL).group()
    assert 'Inner race fault' in banner
    assert f'Found {worst.fault_hz:.2f} Hz, expected {worst.fault_hz_expected:.2f} Hz' in banner
    for reason in worst.reasons:
        assert html.escape(reason) in page
    # Headline, table and spectra come from one window.
    assert {s.first_sample for s in machine.headline.spectra.values()} == {worst.first_sample}
    assert page.count('<figure>') == 8
    assert 'Vibration simulated by /twin, preset incipient, inner race' in banner
    assert 'nan' not in re.sub(r'<svg.*?</svg>|<style>.*?</style>', '', page, flags=re.DOTALL)


def test_every_picture_draws_something(page):
    pictures = re.findall(r'<svg.*?</svg>', page, re.DOTALL)
    assert len(pictures) == page.count('<figure>')
    for svg in pictures:
        points = re.findall(r'[ML] (-?[\d.]+) (-?[\d.]+)', svg)
        assert len(points) > 100
        assert 'nan' not in ' '.join(re.findall(r' d="(.*?)"', svg, re.DOTALL))


def test_strips_are_pieces_of_the_recorded_waveform_over_the_whole_range(recording):
    (machine,) = machines_of(recording).values()
    whole = np.concatenate([m.decode().y for m in read_messages(recording, topics=['/vibration'])])
    assert [5.0 * step for step in sorted(machine.over_temperature.strips)] == [
        *np.arange(20.0, 111.0, 5.0)
    ]
    for step, strip in machine.over_temperature.strips.items():
        assert strip.samples.size == round(STRIP_SECONDS * 25600.0)
        assert strip.temperature == pytest.approx(5.0 * step, abs=0.6)
        places = np.flatnonzero(whole == strip.samples[0])
        assert any(
            np.array_equal(whole[k : k + strip.samples.size], strip.samples) for k in places
        )


def test_the_level_of_the_blocks_is_that_of_their_samples_about_their_mean(recording):
    (machine,) = machines_of(recording).values()
    whole = np.concatenate(
        [m.decode().y for m in read_messages(recording, topics=['/vibration'])]
    ).astype(np.float64)
    _, rms, peak = np.array(machine.vibration).T
    blocks = whole.reshape(len(rms), -1)
    assert np.allclose(rms, blocks.std(axis=1), rtol=1e-9)
    assert np.allclose(peak, np.abs(blocks - blocks.mean(axis=1)[:, None]).max(axis=1))


@pytest.mark.usefixtures('undrawn')
def test_each_namespace_is_a_machine_of_its_own(recording, tmp_path):
    end = next(read_messages(recording)).log_time + 8_000_000_000
    both = rewritten(
        recording,
        tmp_path / 'both',
        rename=lambda topic: [f'/line3/bearing_{k}{topic}' for k in (10, 9)],
        until=end,
    )
    machines = machines_of(both)
    assert list(machines) == ['/line3/bearing_9', '/line3/bearing_10']
    first, second = machines.values()
    assert first.vibration == second.vibration
    text = report_page(both)
    elements = Elements(text)
    assert len(elements.ids) == len(set(elements.ids))
    # A name may break between its parts.
    text = text.replace('<wbr>', '')
    assert 'Machine /line3/bearing_9' in text
    assert 'Machine /line3/bearing_10' in text
    # Pictures of the appendix are of the machine above them.
    appendix = text[text.index('<h1>Appendix</h1>') :]
    heads = [appendix.index(f'>Machine {name}</h2>') for name in machines]
    assert heads[0] < appendix.index('<figure>') < heads[1] < appendix.rindex('<figure>')
    # All verdicts before the first machine.
    assert text.index('>/line3/bearing_10</a>') < text.index('Machine /line3/bearing_9')


@pytest.mark.usefixtures('undrawn')
def test_the_most_urgent_machine_comes_first(tmp_path):
    from bearing_twin_msgs.msg import Diagnosis
    from rclpy.serialization import serialize_message

    healthy = Diagnosis(result_name='healthy', level=Diagnosis.LEVEL_OK, confidence=0.9)
    early = Diagnosis(result_name='inner', result=1, level=Diagnosis.LEVEL_NONE, confidence=0.99)
    early.window_result, early.window_level = early.result, Diagnosis.LEVEL_FAULT
    begun, far = (
        Diagnosis(result_name='inner', level=Diagnosis.LEVEL_FAULT, stage=stage)
        for stage in (1, 3)
    )
    windows = {'a': [healthy], 'b': [early, begun], 'c': [early, far], 'd': [early]}
    with RecordingWriter(tmp_path / 'fleet') as writer:
        for time in range(1, 7):
            for name, made in windows.items():
                writer.write(
                    f'/{name}/diagnosis', 'bearing_twin_msgs/msg/Diagnosis',
                    serialize_message(made[min(time // 4, len(made) - 1)]),
                    log_time=time,
                )  # fmt: skip
    page = report_page(tmp_path / 'fleet')
    links = re.findall(r'<tr><th><a href="#(\w+)">/(\w)</a></th>', page)
    assert [name for _, name in links] == ['c', 'b', 'd', 'a']
    # The parts of the page follow in this order, where the links lead.
    assert re.findall(r'<h2 id="(m\d)">Machine /(\w)</h2>', page) == links


@pytest.mark.usefixtures('undrawn')
def test_a_twin_beside_the_sensor_is_not_what_the_page_is_about(recording, tmp_path):
    end = next(read_messages(recording)).log_time + 8_000_000_000
    topics = {'/vibration': ['/vibration_twin', '/vibration']}
    both = rewritten(recording, tmp_path / 'both', rename=lambda t: topics.get(t, [t]), until=end)
    alone = rewritten(recording, tmp_path / 'alone', until=end)
    (machine,), (single,) = machines_of(both).values(), machines_of(alone).values()
    assert machine.vibration == single.vibration
    assert machine.sensors == {'/vibration', '/vibration_twin'}
    assert '/vibration, /vibration_twin' in report_page(both)
    topics = {'/vibration': ['/vibration', '/twin/vibration']}
    made = tmp_path / 'below'
    below = rewritten(recording, made, rename=lambda t: topics.get(t, [t]), until=end)
    (machine,) = machines_of(below).values()
    assert machine.sensors == {'/vibration', '/twin/vibration'}


@pytest.mark.parametrize(
    ('zone', 'velocity', 'decides'), [('D', 8.0, True), ('', 12.0, True), ('', 8.0, False)]
)
def test_a_velocity_that_decides_is_drawn_beside_what_decides(recording, zone, velocity, decides):
    (machine,) = machines_of(recording).values()
    for k, (time, message) in enumerate(machine.diagnoses):
        message = replace(message, iso_zone=zone, velocity_rms=velocity)
        machine.diagnoses[k] = time, message
    if zone:
        told = {'power_group': 2, 'mounting': 'rigid'}
        machine.source.parameters('/diagnosis', 'diagnosis', told)
    ((caption, deciding), (beside, other)) = drawn(machine, _evidence, _other_evidence)
    assert caption.startswith('What decides') and beside.startswith('Other')
    # In place of the level, so that the page stays two sheets.
    assert ('Velocity' in deciding, 'Velocity' in other) == (decides, not decides)
    assert ('Vibration level' in deciding, 'Vibration level' in other) == (not decides, decides)
    # Zones closer than letters are high have one mark.
    assert f'>{"B, C, D" if zone else "D"}</text>' in (deciding if decides else other)


def test_the_last_verdict_ends_with_the_recording(recording):
    (machine,) = machines_of(recording).values()
    (last, _), duration = machine.diagnoses[-1], machine.vibration[-1][0]
    assert last <= machine.end == pytest.approx(duration, abs=0.1)
    axes = Figure().subplots()
    (patch,) = _patches(axes, machine, 1.0).values()
    assert patch.get_x() + patch.get_width() == pytest.approx(machine.end)


def test_nothing_is_drawn_over_a_pause(recording):
    """A sensor that was off for ten seconds: neither a verdict nor a level of that time."""
    (machine,) = machines_of(recording).values()
    for name in ('vibration', 'diagnoses', 'measured', 'states'):
        items = getattr(machine, name)
        items[:] = [item for item in items if not 15.0 < item[0] < 25.0]
    (verdict, temperature, level) = _history(machine)[1].axes
    patches = [(p.get_x(), p.get_x() + p.get_width()) for p in verdict.patches]
    assert patches[-1][1] == pytest.approx(machine.end)
    for axes in (temperature, level):
        for line in axes.get_lines():
            time, values = line.get_data()
            joined = np.flatnonzero(np.isfinite(values[:-1] + values[1:]))
            patches += [(time[k], time[k + 1]) for k in joined]
    assert not [p for p in patches if p[0] < 17.0 and p[1] > 23.0]
    lines = _evidence(machine)[1].axes[0].get_lines()[: len(FAMILIES)]
    assert all(np.isnan(line.get_ydata()).sum() == 1 for line in lines)


@pytest.mark.parametrize('killed', [False, True])
def test_what_nobody_judged_any_more_is_said(recording, tmp_path, killed):
    """A diagnosis that ended before the vibration."""
    begin = next(iter(read_messages(recording))).log_time
    path = tmp_path / 'killed'
    with RecordingWriter(path) as writer:
        for m in read_messages(recording):
            if not (killed and m.topic == '/diagnosis' and m.log_time > begin + 20e9):
                put(writer, m, m.topic)
    assert bool(re.search(r'No verdict on the last [12]\d s\.', report_page(path))) == killed


@pytest.mark.parametrize('missing', [0, 40])
def test_snapshots_are_joined_as_a_stream_is(recording, missing):
    """A pause is what is long beside the others, not the minute from each snapshot to the next."""
    (machine,) = machines_of(recording).values()
    made = machine.diagnoses[0][1]
    machine.diagnoses = [(60.0 * k, made) for k in range(100) if not 30 < k <= 30 + missing]
    axes = Figure().subplots()
    _patches(axes, machine, 1.0)
    assert len(axes.patches) == (2 if missing else 1)


@pytest.mark.parametrize(
    ('left_out', 'caption'),
    [
        ([], 'Verdict, temperature and vibration over time'),
        (['measured', 'states'], 'Verdict and vibration over time'),
        (['measured', 'states', 'diagnoses'], 'Vibration over time'),
    ],
)
def test_the_caption_of_the_history_names_what_it_shows(recording, left_out, caption):
    (machine,) = machines_of(recording).values()
    for name in left_out:
        getattr(machine, name).clear()
    assert [name for name, _ in drawn(machine, _history)] == [caption]


@pytest.mark.parametrize(('hours', 'unit'), [(1, 'h'), (24, 'd')])
def test_a_day_is_told_in_hours_and_weeks_in_days(recording, hours, unit):
    (machine,) = machines_of(recording).values()
    verdicts = enumerate(machine.diagnoses[:24])
    machine.diagnoses = [(3600.0 * hours * k, made) for k, (_, made) in verdicts]
    (_, history), (_, deciding) = drawn(machine, _history, _evidence)
    assert f'time since the start of the recording [{unit}]' in history
    assert f'time [{unit}]' in deciding
    assert '000</text>' not in history + deciding


def test_colours_are_not_all_that_tells_verdicts_and_families_apart(recording):
    (machine,) = machines_of(recording).values()
    (_, history), (_, deciding), (_, other) = drawn(machine, _history, _evidence, _other_evidence)
    # Once in the legend, and once in the lane itself.
    assert history.count('>Inner race fault</text>') == 2
    # A marker in the legend and several in each panel, in the colour of the family.
    for family in FAMILIES:
        colour = hex_colour(family.colour)
        assert len(re.findall(f'<use [^>]*fill: {colour}', deciding)) >= 5
    assert 'crest factor green ■' in other


def test_many_machines_with_long_names_have_figures_of_a_sheet_each(recording):
    (machine,) = machines_of(recording).values()
    names = [f'/hall_{k:03d}/{"recirculation_" * 8}pump_{k:03d}' for k in range(100)]
    pictures = verdicts_over_time([replace(machine, namespace=name) for name in names])
    assert len(pictures) == 3
    heights = [float(re.search(r'height="([\d.]+)pt"', svg)[1]) for _, svg in pictures]
    assert max(heights) < 0.9 * 297.0 / 25.4 * 72.0
    shown = ''.join(svg for _, svg in pictures)
    assert all(re.search(rf'>/hall_{k:03d}/.*pump_{k:03d}</text>', shown) for k in range(100))


def test_limits_too_close_for_letters_share_a_mark():
    axes = Figure().subplots()
    axes.set_ylim(0.0, 20.0)
    _mark_limits(axes, zone_limits(2, 'rigid'))
    assert [text.get_text() for text in axes.texts] == ['B, C, D']
    axes.set_ylim(0.0, 5.0)
    _mark_limits(axes, zone_limits(2, 'rigid'))
    assert [text.get_text() for text in axes.texts[1:]] == ['B', 'C', 'D']


def test_a_level_over_baseline_has_its_limits_and_takes_no_third_sheet(recording):
    (machine,) = machines_of(recording).values()
    heights = []
    for level in (math.nan, 7.0):
        machine.diagnoses = [
            (time, replace(message, level_over_baseline=level))
            for time, message in machine.diagnoses
        ]
        [(_, deciding)] = drawn(machine, _evidence)
        heights.append(re.search(r'height="([\d.]+)pt"', deciding)[1])
    assert heights[0] == heights[1]
    marks = re.findall(r'fill: #616161"[^>]*>([^<]*)</text>', deciding)
    assert ', '.join(marks) == '5.5, 0.6, 6, 12'
    # The level is in the appendix, and a line beside the first has the name of its colour.
    assert 'Vibration level' not in deciding and 'correction red' in deciding
    [(_, other)] = drawn(machine, _other_evidence)
    assert 'Vibration level' in other


def test_only_parameters_off_their_defaults_are_listed():
    twin = {'defect': 'inner', 'late_after': 0.02, 'autostart': True, 'wait_for_subscribers': 2}
    assert off_default('twin', twin) == [
        ('defect', "inner (default 'none')"),
        ('wait_for_subscribers', '2 (default 0)'),
    ]
    recorder = {'topics': "['']", 'max_cache_size': '64', 'autostart': 'True', 'snapshot': 'True'}
    assert off_default('recorder', recorder) == [('snapshot', 'True (default False)')]
    assert off_default('diagnosis', {'of_another_version': 1}) == [('of_another_version', '1')]


@pytest.mark.parametrize('base', ['', '/plant'])
def test_a_page_says_what_a_fleet_simulated(recording, tmp_path, base):
    from bearing_twin_msgs.msg import Checkpoint
    from rclpy.serialization import serialize_message

    end = next(read_messages(recording)).log_time + 8_000_000_000
    with RecordingWriter(tmp_path / 'fleet') as writer:
        for message in read_messages(recording, end=end):
            # One of the assets has the name of the node.
            topics = [f'{base}/{name}{message.topic}' for name in ('p1', 'fleet')]
            cdr = message.cdr
            if message.topic == '/twin_checkpoint':
                values = yaml.safe_load(message.decode().configuration)
                healthy = values | {'defect': 'none', 'hardware_id': 'pump 9'}
                made = Checkpoint(node=f'{base}/fleet', kind='fleet')
                made.configuration = yaml.safe_dump({'fleet': healthy, 'p1': values})
                topics, cdr = [f'{base}/fleet/checkpoint'], serialize_message(made)
            for topic in topics:
                put(writer, message, topic, cdr)
    machines = machines_of(tmp_path / 'fleet')
    text = f'simulated by {base}/fleet, preset incipient, '
    assert machines[f'{base}/p1'].source.text.startswith(f'{text}inner race')
    assert machines[f'{base}/fleet'].source.text == f'{text}no defect'
    assert machines[f'{base}/fleet'].hardware == 'pump 9'


def test_a_fault_that_was_simulated_and_is_no_more_is_no_false_alarm(recording):
    """A defect that is switched off again, beside a verdict on when it was on."""
    (machine,) = machines_of(recording).values()
    source, now = machine.source, machine.source.text
    assert source.whole == now and 'inner race' in now
    checkpoint = next(read_messages(recording, topics=['/twin_checkpoint'])).decode()
    values = yaml.safe_load(checkpoint.configuration)
    for defect in ('outer', 'none', 'outer', 'none'):
        source.parameters('/twin', 'twin', values | {'defect': defect})
    end = 'simulated by /twin, preset incipient, no defect'
    assert source.text == end
    assert re.fullmatch(
        f'{end} at the end; before: preset incipient, outer race .* mm, and 1 more', source.whole
    )


@pytest.mark.usefixtures('undrawn')
def test_what_a_recording_says_is_never_markup(recording, tmp_path):
    begin = next(read_messages(recording)).log_time
    evil = '</td><script>alert(1)</script>'
    target = rewritten(
        recording,
        tmp_path / 'evil',
        metadata={f'bearing_twin.parameters.{evil}': {evil: evil}},
        until=begin + 6_000_000_000,
    )
    text = report_page(target)
    assert 'script' not in Elements(text).tags
    assert html.escape(evil) in text


@pytest.mark.usefixtures('undrawn')
@pytest.mark.parametrize('shaft_hz', [0.0, -25.0, math.nan])
def test_a_verdict_without_a_speed_has_no_table_of_orders(tmp_path, shaft_hz):
    from bearing_twin_msgs.msg import Diagnosis
    from rclpy.serialization import serialize_message

    # No node of ours writes it, but a file may say so.
    made = Diagnosis(result_name='inner', bpfo=76.9, bpfi=126.3, shaft_hz=shaft_hz)
    with RecordingWriter(tmp_path / 'speedless') as writer:
        cdr = serialize_message(made)
        writer.write('/diagnosis', 'bearing_twin_msgs/msg/Diagnosis', cdr, log_time=1)
    text = report_page(tmp_path / 'speedless')
    assert 'Inner race fault' in text
    assert 'significance / limit' not in text


@pytest.mark.usefixtures('undrawn')
def test_a_torn_recording_is_shown_up_to_where_it_breaks_off(recording, tmp_path):
    (source,) = recording.glob('*.mcap')
    content = source.read_bytes()
    torn = tmp_path / 'torn.mcap'
    torn.write_bytes(content[: len(content) // 2])
    (whole,) = machines_of(recording).values()
    (half,) = machines_of(torn).values()
    assert 0.3 < len(half.vibration) / len(whole.vibration) < 0.7
    assert whole.vibration[: len(half.vibration)] == half.vibration
    text = report_page(torn)
    assert 'class="bad"' in text
    assert 'Sound: nothing missing' not in text


@pytest.mark.usefixtures('undrawn')
def test_verdicts_that_cannot_be_read_are_not_passed_over(recording, tmp_path):
    target = tmp_path / 'other'
    with RecordingWriter(target) as writer:
        for message in read_messages(recording, topics=['/vibration', '/diagnosis']):
            cdr = message.cdr[:40] if message.topic == '/diagnosis' else message.cdr
            put(writer, message, cdr=cdr)
    (machine,) = machines_of(target).values()
    assert machine.unread['/diagnosis'][0] == 40
    text = report_page(target)
    assert '/diagnosis: 40 messages cannot be read' in text
    assert 'Sound: nothing missing' not in text
    # To play it to the diagnosis node is no remedy for what is there already.
    assert 'play it' not in text


def test_vibration_without_a_verdict_makes_no_statement(recording, tmp_path):
    only = tmp_path / 'only'
    with RecordingWriter(only) as writer:
        for message in read_messages(recording, topics=['/vibration']):
            put(writer, message)
    text = report_page(only)
    assert 'No diagnosis recorded' in text
    assert 'Healthy' not in text
    assert text.count('<figure>') == 2


def test_a_recording_without_a_bearing_is_refused(tmp_path, capsys):
    output = tmp_path / 'x.html'
    assert cli.main(['report', str(SCHEDULE), '-o', str(output)]) == 1
    assert 'neither vibration nor diagnosis' in capsys.readouterr().err
    assert not output.exists()
    with pytest.raises(BearingTwinError, match='does not exist'):
        report_page(tmp_path / 'missing.mcap')


def test_a_report_never_overwrites_a_recording(tmp_path, capsys):
    copy = tmp_path / 'copy.mcap'
    copy.write_bytes(SCHEDULE.read_bytes())
    assert cli.main(['report', str(copy), '-o', str(copy)]) == 2
    assert 'not called .html' in capsys.readouterr().err
    assert copy.read_bytes() == SCHEDULE.read_bytes()


def test_the_command_writes_the_page(recording, page, tmp_path, capsys):
    output = tmp_path / 'report.html'
    assert cli.main(['report', str(recording), '-o', str(output)]) == 0
    assert str(output) in capsys.readouterr().out
    assert output.read_text(encoding='utf-8') == page


def test_a_value_between_missing_ones_is_shown():
    """A width that one calibration alone tells was an empty panel."""
    panel = Panel('width', 'width [mm]', (Trend('median', 'median', LINE['blue'], 'width'),))
    values = [1.5, math.nan, 2.5, math.nan, 3.5, 4.5]
    items = [(float(at), SimpleNamespace(width=width)) for at, width in enumerate(values)]
    _, figure = _panels('', (panel,), items)
    (points,) = figure.axes[0].collections
    assert points.get_offsets().tolist() == [[0.0, 1.5], [2.0, 2.5]]


def test_a_level_keeps_clear_of_the_top_of_its_axis():
    """A margin above a level that hardly moves is next to nothing."""
    panel = next(panel for panel in DIAGNOSIS if panel.key == 'level')
    items = [(float(at), SimpleNamespace(rms=25.0 + 0.01 * at)) for at in range(10)]
    _, figure = _panels('', (panel,), items)
    low, high = figure.axes[0].get_ylim()
    assert low == 0.0 and high > 1.04 * 25.0


def test_a_strip_without_a_temperature_takes_no_colour_from_the_others():
    """A recording that began before its first temperature had a waterfall in one colour."""
    samples = np.sin(np.arange(100.0))
    strips = {k: Strip(t, 1000.0, samples) for k, t in enumerate((math.nan, 20.0, 60.0, 110.0))}
    machine = SimpleNamespace(over_temperature=SimpleNamespace(strips=strips), unit='m/s^2')
    _, figure = _waterfall(machine)
    hot, *_, cold, unknown = figure.axes[0].collections[0].get_colors()
    assert hot[0] > 0.7 > 0.1 > cold[0]
    assert unknown[0] == unknown[1] == unknown[2]
