# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Layouts for other people's viewers: what they name exists, and Grafana's queries find data."""

import json
import math
from pathlib import Path
import re
import shutil
import subprocess
import time
from urllib.parse import urlencode
from urllib.request import urlopen
from xml.etree import ElementTree

from bearing_twin.bearing import find_bearing
from bearing_twin.recording.mcap.schema import message_schema, store_from_text
from bearing_twin.recording.topics import OWN_TOPICS
import numpy as np
import pytest

CONFIG = Path(__file__).resolve().parents[1] / 'config'
TOPICS = {**OWN_TOPICS, 'diagnostics': 'diagnostic_msgs/msg/DiagnosticArray'}
PER_FAMILY = [f'{name}[{k}]' for name in ('score', 'modulation_index') for k in range(4)]
DECIDING = (*PER_FAMILY, 'rms', 'velocity_rms', 'level_over_baseline', 'fault_hz')
"""Fields of a verdict that decide."""
ELEMENT = re.compile(r'\[(:|\d+)\]$')


def assert_plotted(topic, field):
    """Assert that a topic of ours has a field that a plot can show."""
    kind = TOPICS[topic]
    fields = store_from_text(kind, message_schema(kind).text).fielddefs[kind][1]
    of = dict(fields)
    bare = ELEMENT.sub('', field)
    assert bare in of, f'{topic} has no {bare}'
    node, inside = of[bare]
    assert (node.name == 'BASE') == (bare == field), f'{topic}: {field}'
    base = inside if node.name == 'BASE' else inside[0][1]
    assert base[0] not in ('string', 'wstring')


def leaves(layout):
    """Return the panels of a mosaic."""
    if isinstance(layout, str):
        return [layout]
    return leaves(layout['first']) + leaves(layout['second'])


def test_foxglove_shows_fields_that_there_are():
    layout = json.loads((CONFIG / 'foxglove_layout.json').read_text())
    panels = layout['configById']
    assert sorted(leaves(layout['layout'])) == sorted(panels)
    plotted = [
        path['value']
        for panel in panels.values()
        for path in (*panel.get('paths', ()), *filter(None, [panel.get('xAxisPath')]))
    ]
    assert {'/vibration.y[:]', '/envelope_spectrum.values[:]'} <= set(plotted)
    assert {f'/diagnosis.{field}' for field in DECIDING} <= set(plotted)
    for path in plotted:
        assert_plotted(*path.lstrip('/').split('.'))
    others = [p.get('topicToRender') or p.get('topicPath') for p in panels.values()]
    assert {topic.lstrip('/') for topic in others if topic} <= TOPICS.keys()


def test_plotjuggler_shows_fields_that_there_are():
    root = ElementTree.parse(CONFIG / 'plotjuggler_layout.xml').getroot()
    splitters = root.findall('.//DockSplitter')
    for splitter in splitters:
        count = int(splitter.get('count'))
        assert count == len(splitter) == len(splitter.get('sizes').split(';'))
    curves = [curve.get('name') for curve in root.iter('curve')]
    assert {f'/diagnosis/{field}' for field in DECIDING} <= set(curves)
    for name in curves:
        assert_plotted(*name.lstrip('/').split('/'))


def line(node, part, values, time_ns):
    """
    Return a status as diagnostic_remote_logging 4.4 sends it, by what its source does.

    Blanks of names and keys are escaped, numbers go as they are, all else between double quotes.
    """

    def sent(value):
        return value if re.fullmatch(r'[-+]?\d+(\.\d*)?([eE][-+]?\d+)?', value) else f'"{value}"'

    def escaped(text):
        return text.replace(' ', r'\ ')

    fields = ''.join(f',{escaped(key)}={sent(value)}' for key, value in values)
    return (
        f'{escaped(node)},name={escaped(part)},hardware_id=fan_7 level=0,message="fine"{fields} '
        f'{time_ns}'
    )


def asked(url, query, **words):
    """Return what an InfluxDB answers to a query."""
    # Sent as a form: a query in the address may not change anything.
    with urlopen(f'{url}/query', data=urlencode({'q': query, **words}).encode()) as answer:
        [result] = json.load(answer)['results']
    return result


@pytest.fixture
def influxdb(tmp_path):
    """Return the address of an InfluxDB of its own with a database."""
    if shutil.which('influxd') is None:
        pytest.skip('influxdb is not installed (Debian: apt-get install influxdb)')
    # Ports are the system's choice, and the database is waited for: a port found free beforehand
    # may be another server's by then, and its "not found" would look like one of InfluxDB.
    (tmp_path / 'influxdb.conf').write_text(
        'reporting-disabled = true\nbind-address = "127.0.0.1:0"\n'
        f'[meta]\n  dir = "{tmp_path}/meta"\n'
        f'[data]\n  dir = "{tmp_path}/data"\n  wal-dir = "{tmp_path}/wal"\n'
        '[http]\n  bind-address = "127.0.0.1:0"\n'
    )
    log = tmp_path / 'log'
    with log.open('wb') as sink:
        server = subprocess.Popen(
            ['influxd', '-config', str(tmp_path / 'influxdb.conf')], stdout=sink, stderr=sink
        )
    try:
        deadline, listening = time.monotonic() + 60.0, r'Listening on HTTP.* addr=(127\S+:\d+)'
        while not (address := re.search(listening, log.read_text())):
            assert server.poll() is None and time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
        url = f'http://{address[1]}'
        while 'series' not in (said := asked(url, 'SHOW RETENTION POLICIES ON bearings')):
            assert time.monotonic() < deadline, (said, log.read_text())
            asked(url, 'CREATE DATABASE bearings')
        yield url
    finally:
        server.terminate()
        server.wait(30)


def statuses():
    """Return the values of the statuses of a machine, at three moments of its life."""
    from bearing_twin.diagnosis import diagnose_record
    from bearing_twin.diagnosis.result import insufficient
    from bearing_twin.nodes.diagnosis_topics import verdict_status
    from bearing_twin.nodes.twin_topics import temperature_status
    from bearing_twin.thermal.gate import TemperatureGate

    gate, bearing = TemperatureGate(start=20.0, timeout=5.0), find_bearing('6205')
    yield temperature_status(gate.at(0.0)), verdict_status(insufficient([], bearing), '6205', 0.0)
    gate.offer(60.0, stamp=1, now=1.0)
    noise = np.random.default_rng(0).standard_normal(4 * 25600)
    found = diagnose_record(noise, 25600.0, bearing, 25.0, unit='m/s^2')
    yield temperature_status(gate.at(1.0)), verdict_status(found, '6205', 0.0)
    gate.offer(math.nan, stamp=2, now=2.0)
    yield temperature_status(gate.at(2.0)), verdict_status(found, 'NU 205', 0.0)


@pytest.mark.ros
def test_the_queries_of_grafana_find_what_is_sent_to_influxdb(influxdb):
    pytest.importorskip('rclpy')
    from bearing_twin.ros.health import _text, known

    now = time.time_ns()
    for k, (temperature, verdict) in enumerate(statuses()):
        rows = [
            line(node, part, [(key, _text(value)) for key, value in known(status.values)], now + k)
            for node, part, status in (
                ('fan_7/twin', 'temperature input', temperature),
                ('fan_7/diagnosis', 'bearing', verdict),
            )
        ]
        # A field that were a number once and a text another time would be refused.
        with urlopen(f'{influxdb}/write?db=bearings', data='\n'.join(rows).encode()) as answer:
            assert answer.status == 204
    dashboard = json.loads((CONFIG / 'grafana_dashboard.json').read_text())
    found = set()
    for panel in dashboard['panels']:
        [target] = panel['targets']
        query = target['query'].replace('$timeFilter', 'time > now() - 1h')
        query = query.replace('$__interval', '10s').replace('/^$machine$/', '/^.*$/')
        result = asked(influxdb, query, db='bearings')
        assert 'error' not in result, f'{panel["title"]}: {result}'
        for series in result.get('series', ()):
            assert series['tags'] == {'hardware_id': 'fan_7'}
            for row in series['values']:
                found |= {k for k, v in zip(series['columns'], row, strict=True) if v is not None}
    wanted = {'verdict_level', 'result', 'score_inner', 'score_cage', 'temperature_used_degc'}
    assert wanted <= found, found


def test_the_keys_of_grafana_are_documented():
    """Each field that a panel asks for is a number of the status that it filters by."""
    document = (CONFIG.parent / 'docs' / 'nodes.md').read_text(encoding='utf-8')
    dashboard = json.loads((CONFIG / 'grafana_dashboard.json').read_text())
    for panel in dashboard['panels']:
        query = panel['targets'][0]['query']
        part = re.search(r'\(\^\| \)([a-z ]+)\$', query)[1]
        numbers = ' '.join(re.findall(rf'(?m)^\| `{part}` \| (.*?) \|', document))
        for field in re.findall(r'last\("(\w+)"\)', query):
            assert f'`{field}`' in numbers, f'{part}: {field}'
