# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A recording of another version, with other fields in a message, is refused in one sentence."""

from dataclasses import replace
import re

from bearing_twin import cli
from bearing_twin.offline.run import run_offline
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.temperature import paper_schedule, write_temperature_recording
from bearing_twin.recording.writer import RecordingWriter
import pytest


@pytest.mark.usefixtures('undrawn')
def test_messages_with_other_fields_are_refused_by_name(tmp_path, capsys):
    pytest.importorskip('bearing_twin_msgs', reason='the message package is not built')
    pytest.importorskip('rerun', reason='the picture is drawn by Rerun')
    write_temperature_recording(tmp_path / 'source', *paper_schedule(3.0), source='test')
    run_offline(tmp_path / 'source', tmp_path / 'run')
    older = str(tmp_path / 'older')
    with RecordingWriter(tmp_path / 'older') as writer:
        for message in read_messages(tmp_path / 'run'):
            schema = re.sub(r'(?m)^\S+ (rule|kappa)\b.*\n', '', message.channel.schema)
            writer.copy(message._replace(channel=replace(message.channel, schema=schema)))
    verdicts, states = (
        f'{topic} has another bearing_twin_msgs/msg/{name} than this version knows: unlike in '
        f'{field}; use the version that recorded it'
        for topic, name, field in (
            ('/diagnosis', 'Diagnosis', 'rule'), ('/twin_state', 'TwinState', 'kappa'),
        )
    )  # fmt: skip
    assert cli.main(['verify', older]) == 1
    assert states in capsys.readouterr().err
    assert cli.main(['view', older, '--save', str(tmp_path / 'picture.rrd')]) == 0
    said = capsys.readouterr().err
    assert verdicts in said and states in said
    # The vibration has all its fields, and is shown.
    assert cli.main(['report', older, '-o', str(tmp_path / 'page.html')]) == 0
    page = (tmp_path / 'page.html').read_text()
    assert verdicts in page and states in page and 'Vibration simulated by' in page
    with RecordingWriter(tmp_path / 'new') as writer:
        for message in read_messages(tmp_path / 'run', topics=['/vibration']):
            schema = message.channel.schema.replace('uint8 source', 'uint8 origin')
            writer.copy(message._replace(channel=replace(message.channel, schema=schema)))
    assert cli.main(['info', str(tmp_path / 'new')]) == 1
    said = ' '.join(capsys.readouterr().out.split())
    why = '/vibration has another bearing_twin_msgs/msg/Vibration than this version knows'
    assert f'messages cannot be read ({why}: unlike in source, origin; use the version' in said
