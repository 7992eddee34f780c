# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages and views of a picture: which there are, and which one is shown first."""

from dataclasses import replace
from pathlib import Path
import re
import runpy
from types import SimpleNamespace

from bearing_twin.recording.reader import read_messages
from bearing_twin.view.rerun.blueprint import layout
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.style import PAGES
from drawn import view_names
import pytest
from rerun.chunk import RrdReader


@pytest.mark.parametrize(('zone', 'views'), [('', 1), ('D', 2)])
def test_a_velocity_with_a_zone_is_on_the_first_page_too(recording, tmp_path, zone, views):
    rrd = tmp_path / 'zone.rrd'
    told = '{power_group: 2, mounting: rigid}' if zone else '{}'
    checkpoint = SimpleNamespace(
        node='/diagnosis', kind='diagnosis', version='0', configuration=told
    )
    with RerunLogger(recording_id='zone', rrd=rrd) as logger:
        first = next(read_messages(recording)).log_time
        kind = 'bearing_twin_msgs/msg/Checkpoint'
        logger.log('/diagnosis_checkpoint', kind, checkpoint, first)
        for message in read_messages(recording, topics=['/diagnosis']):
            made = replace(message.decode(), iso_zone=zone, velocity_rms=8.0)
            logger.log(message.topic, message.type_name, made, message.log_time)
    assert logger.problems == {}
    assert sum(name.startswith('Velocity') for name in view_names(rrd)) == views
    entities = {str(chunk.entity_path) for chunk in RrdReader(rrd).stream()}
    limits = {name.rpartition('/')[2] for name in entities if 'velocity/limit' in name}
    assert limits == ({'0', '1.4', '2.8', '4.5'} if zone else {'0', '7.1', '11'})


def test_a_twin_beside_its_machine_is_no_second_bearing(recording, tmp_path):
    rrd = tmp_path / 'beside.rrd'
    names = ['/diagnosis', '/twin_state', '/vibration']
    with RerunLogger(recording_id='beside', rrd=rrd) as logger:
        for k, message in enumerate(read_messages(recording, topics=names)):
            both = ['', '/twin'] if message.topic == '/vibration' else ['']
            for name in both:
                topic = f'/fan{name}{message.topic}'
                logger.log(topic, message.type_name, message.decode(), message.log_time)
            if k > 200:
                break
    names = view_names(rrd)
    assert 'Vibration: /fan/twin' in names
    assert 'All bearings' not in names
    assert 'Verdict' in names


def test_the_page_asked_for_is_that_of_a_bearing_that_has_it(recording, tmp_path):
    with RerunLogger(recording_id='page', rrd=tmp_path / 'page.rrd') as logger:
        for message in read_messages(recording, topics=['/diagnosis', '/twin_state']):
            bearing = {'/twin_state': '/fan', '/diagnosis': '/pump'}[message.topic]
            logger.log(
                bearing + message.topic, message.type_name, message.decode(), message.log_time
            )
    scenes = {namespace: scene for (_, namespace), scene in logger._scenes.items()}
    for page, bearing in (('Twin', '/fan'), ('Evidence', '/pump')):
        tabs = layout(scenes, timeline='ros_time', page=page).root_container
        assert tabs.contents[tabs.active_tab].name == bearing


def test_vibration_alone_has_no_page_of_a_verdict(recording, tmp_path):
    with RerunLogger(recording_id='bare', rrd=tmp_path / 'bare.rrd') as logger:
        for message in read_messages(recording, topics=['/vibration', '/temperature']):
            logger.log(message.topic, message.type_name, message.decode(), message.log_time)
    (scene,) = logger._scenes.values()
    tabs = layout({'': scene}, timeline='ros_time').root_container
    pages = {page.name: page for page in tabs.contents}
    assert list(pages) == ['Vibration', 'Temperature']
    # A waterfall as high as the page would be cut off at its sides.
    left, _ = pages['Temperature'].contents
    assert [view.name for view in left.contents] == [
        'Waveform over temperature',
        'Temperature [°C]',
    ]


def test_before_the_first_vibration_the_log_of_the_nodes_is_in_front(recording, tmp_path):
    said = SimpleNamespace(name='diagnosis', level=30, msg='no vibration yet')
    with RerunLogger(recording_id='early', rrd=tmp_path / 'early.rrd') as logger:
        logger.log('/rosout', 'rcl_interfaces/msg/Log', said, 0)
        assert logger.problems == {}
        (scene,) = logger._scenes.values()
        (nodes,) = layout({'': scene}, timeline='ros_time').root_container.contents
        assert nodes.name == 'Nodes'
        message = next(read_messages(recording, topics=['/temperature']))
        logger.log(message.topic, message.type_name, message.decode(), message.log_time)
    front, nodes = layout({'': scene}, timeline='ros_time').root_container.contents
    assert [view.name for view in front.contents] == ['Temperature [°C]']
    assert nodes.name == 'Nodes'


def test_the_end_of_a_long_name_is_above_its_card(recording, tmp_path):
    rrd = tmp_path / 'long.rrd'
    with RerunLogger(recording_id='long', rrd=rrd) as logger:
        for message in read_messages(recording, topics=['/diagnosis']):
            for bearing in (
                '/plant/line_1/conveyor_bearing_7',
                '/plant/line_1/conveyor_bearing_8',
            ):
                logger.log(
                    bearing + message.topic, message.type_name, message.decode(), message.log_time
                )
    assert {'Verdict: …e_1/conveyor_bearing_7', 'Verdict: …e_1/conveyor_bearing_8'} <= set(
        view_names(rrd)
    )


def test_namespaces_are_scenes_of_their_own(recording, tmp_path, monkeypatch):
    rrd, laid_out = tmp_path / 'fleet.rrd', []

    def noted(scenes, **options):
        laid_out.append(list(scenes))
        return layout(scenes, **options)

    monkeypatch.setattr('bearing_twin.view.rerun.logger.layout', noted)
    with RerunLogger(recording_id='fleet', rrd=rrd) as logger:
        for k, message in enumerate(read_messages(recording, topics=['/diagnosis', '/vibration'])):
            for bearing in ('/line3/bearing_10', '/line3/bearing_9'):
                logger.log(
                    bearing + message.topic, message.type_name, message.decode(), message.log_time
                )
            if k > 100:
                break
    entities = {str(chunk.entity_path) for chunk in RrdReader(rrd).stream()}
    for bearing in ('/line3/bearing_10', '/line3/bearing_9'):
        assert f'{bearing}/diagnosis/verdict' in entities
        assert f'{bearing}/vibration/samples/y' in entities
        # On the page of all, and on that of its own.
        assert {f'Verdict: {bearing}', 'Verdict'} <= set(view_names(rrd))
    # They were heard in another order.
    assert laid_out[-1] == ['/line3/bearing_9', '/line3/bearing_10']


def test_a_bearing_that_was_never_heard_is_on_the_page_of_all(recording, tmp_path):
    """Its sensor is not connected; the page would otherwise look complete."""
    status = SimpleNamespace(
        name='fleet: line2/gearbox bearing', level=3, message='no verdict yet'
    )
    health = 'diagnostic_msgs/msg/DiagnosticArray', SimpleNamespace(status=[status])
    with RerunLogger(recording_id='fleet', rrd=tmp_path / 'fleet.rrd') as logger:
        for message in read_messages(recording, topics=['/diagnosis']):
            logger.log('/diagnostics', *health, message.log_time)
            for bearing in ('/line1/pump', '/line2/fan'):
                logger.log(
                    bearing + message.topic, message.type_name, message.decode(), message.log_time
                )
    scenes = {namespace: scene for (_, namespace), scene in logger._scenes.items()}
    front, *_ = layout(scenes, timeline='ros_time').root_container.contents
    assert front.name == 'All bearings'
    lanes, _ = front.contents
    assert lanes.contents == [
        '/line1/pump/diagnosis/verdict',
        '/line2/fan/diagnosis/verdict',
        '/diagnostics/fleet_line2_gearbox_bearing',
    ]


def test_the_pictures_of_the_docs_can_be_taken_anew():
    """What takes them (``make screenshots``) runs for ten minutes: here it is loaded alone."""
    script = Path(__file__).resolve().parents[2] / 'docs' / 'screenshots.py'
    assert callable(runpy.run_path(str(script))['main'])
    pages = set(re.findall(r"page='(.*?)'", script.read_text(encoding='utf-8')))
    assert pages and pages <= set(PAGES)
