# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of another version, whose messages lack fields of ours, are read without them."""

import re

from bearing_twin import cli
from bearing_twin.offline.run import run_offline
from bearing_twin.recording.mcap.schema import message_schema, store_from_text
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.view import trends
from copies import raw_recording
import numpy as np
import pytest

STATE = 'bearing_twin_msgs/msg/TwinState'
SECOND = 1_000_000_000


def without(schema, *fields):
    """Return the text of a schema without these fields."""
    for field in fields:
        schema, count = re.subn(rf'(?m)^\S+ {field}\b.*\n', '', schema)
        assert count == 1, field
    return schema


def record(path, schema):
    """Write 50 twin states of another definition, as a twin of that version would."""
    types = store_from_text(STATE, schema)
    fields = [name for name, _ in types.fielddefs[STATE][1]]
    time_type, header_type = (
        types.types[name] for name in ('builtin_interfaces/msg/Time', 'std_msgs/msg/Header')
    )
    with raw_recording(path) as writer:
        channel = writer.register_channel(
            '/twin_state', 'cdr', writer.register_schema(STATE, 'ros2msg', schema.encode())
        )
        for k in range(50):
            time = 1000 * SECOND + k * SECOND // 10
            stamp = time_type(sec=time // SECOND, nanosec=time % SECOND)
            values = dict.fromkeys(fields, 0) | {
                'header': header_type(stamp=stamp, frame_id=''),
                'bearing': '6307',
                'thermal_mode': 'paper',
                'defect': 'none',
                'temperature_used': 20.0 + k,
                'kappa': 2.0 - 0.01 * k,
                'k_b': 1e10,
                'radial_clearance': 1e-5,
                'ball_force': np.zeros(8, np.float32),
            }
            values = {name: values[name] for name in fields}
            cdr = bytes(types.serialize_cdr(types.types[STATE](**values), STATE))
            writer.add_message(channel, time, cdr, time)
    return path


PLOTTED = [trend.field for panel in trends.TWIN_STATE for trend in panel.trends]


@pytest.mark.parametrize(
    'lacking', [['kappa'], ['temperature_status', 'k_b'], PLOTTED, ['bearing', 'blocks_published']]
)
def test_report_and_rerun_show_what_an_older_recording_has(tmp_path, lacking):
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    reader = pytest.importorskip('rerun.chunk').RrdReader
    schema = without(message_schema(STATE).text, *lacking)
    recording = record(tmp_path / 'older.mcap', schema)
    assert cli.main(['report', str(recording), '-o', str(tmp_path / 'page.html')]) == 0
    page = (tmp_path / 'page.html').read_text()
    assert ('The twin over time' in page) == (lacking is not PLOTTED)
    assert ('Viscosity ratio kappa' in page) == ('kappa' not in lacking)
    assert cli.main(['view', str(recording), '--save', str(tmp_path / 'picture.rrd')]) == 0
    drawn = {str(chunk.entity_path) for chunk in reader(tmp_path / 'picture.rrd').stream()}
    drawn = {path.removeprefix('/twin_state/') for path in drawn}
    assert ('kappa/kappa' in drawn) == ('kappa' not in lacking)
    assert ('beta0/beta0' in drawn) == (lacking is not PLOTTED)
    # Three dimensions ask for the whole pose.
    assert ('bearing/balls' in drawn) == (lacking == ['kappa'])
    assert 'bearing' in drawn


LATER = {
    'bearing_twin_msgs/msg/Vibration': ['source'],
    'bearing_twin_msgs/msg/Diagnosis': ['stage', 'window_result', 'rule', 'strongest_score'],
}
"""Fields that these types did not always have."""


def older(recording, target):
    """Write a recording again as an older version would have."""
    with raw_recording(target) as writer:
        known = {}
        for message in read_messages(recording):
            name, topic = message.channel.type_name, message.topic
            if topic not in known:
                schema = without(message.channel.schema, *LATER.get(name, []))
                number = writer.register_schema(name, 'ros2msg', schema.encode())
                channel = writer.register_channel(topic, 'cdr', number)
                known[topic] = channel, store_from_text(name, schema)
            (channel, types), decoded = known[topic], message.decode()
            fields = [field for field, _ in types.fielddefs[name][1]]
            again = types.types[name](**{field: getattr(decoded, field) for field in fields})
            cdr = bytes(types.serialize_cdr(again, name))
            writer.add_message(channel, message.log_time, cdr, message.publish_time)
    return target


@pytest.mark.usefixtures('undrawn')
def test_vibration_and_verdicts_of_an_older_version_are_read(tmp_path, capsys):
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    pytest.importorskip('rerun', reason='the picture is drawn by Rerun')
    schedule, run = tmp_path / 'schedule.mcap', tmp_path / 'run.mcap'
    write_temperature_recording(schedule, *paper_schedule(5.0), source='test')
    run_offline(schedule, run, twin={'defect': 'inner'})
    recording = str(older(run, tmp_path / 'older.mcap'))
    assert cli.main(['diagnose', recording, '--bearing', '6307']) == 0
    assert 'inner race' in capsys.readouterr().out.lower()
    assert cli.main(['report', recording, '-o', str(tmp_path / 'page.html')]) == 0
    assert 'Vibration source not stated' in (tmp_path / 'page.html').read_text()
    assert cli.main(['view', recording, '--save', str(tmp_path / 'picture.rrd')]) == 0
    assert cli.main(['replay', '--offline', recording, '-o', str(tmp_path / 'again.mcap')]) == 0
    # A message of another version has other bytes: verify names the fields.
    assert cli.main(['verify', recording]) == 1
    assert 'without source' in capsys.readouterr().out
