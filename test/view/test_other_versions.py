# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of another version, whose TwinState lacks fields of ours, are drawn without them."""

import doctest
import re

from bearing_twin import cli
from bearing_twin.recording.schema import message_schema, store_from_text
from bearing_twin.view import trends
from mcap.writer import Writer
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


def record(path, schema, count=50):
    """Write twin states of another definition, as a twin of that version would."""
    types = store_from_text(STATE, schema)
    fields = [name for name, _ in types.fielddefs[STATE][1]]
    time_type, header_type = (
        types.types[name] for name in ('builtin_interfaces/msg/Time', 'std_msgs/msg/Header')
    )
    with path.open('wb') as file:
        writer = Writer(file)
        writer.start(profile='ros2')
        channel = writer.register_channel(
            '/twin_state', 'cdr', writer.register_schema(STATE, 'ros2msg', schema.encode())
        )
        for k in range(count):
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
        writer.finish()
    return path


PLOTTED = [trend.field for panel in trends.TWIN_STATE for trend in panel.trends]


def test_examples_hold():
    assert doctest.testmod(trends) == (0, 3)


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
