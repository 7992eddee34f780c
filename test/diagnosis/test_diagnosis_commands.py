# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""diagnose, benchmark and bench on files of every kind, good and bad, alone and on a cluster."""

import argparse
import base64
from dataclasses import fields
import functools
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import zlib

from bearing_twin.bearing import fault_frequencies, fault_orders, find_bearing, own_bearing
from bearing_twin.bench.diagnosis import fault_signal, measure, RATE, SHAFT_HZ
from bearing_twin.cli import diagnose, main
from bearing_twin.cli.diagnose import configure, diagnose_file, Task
from bearing_twin.diagnosis import DiagnosisSettings
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording import dataset
from bearing_twin.recording.foreign import read_signal
from commands import python
import numpy as np
import pytest

KEYS = {
    'file', 'channel', 'source', 'bearing', 'result', 'faults', 'level', 'confidence', 'shaft_hz',
    'slip', 'evidence', 'reasons', 'next_step',
}  # fmt: skip


@pytest.fixture(scope='module')
def good(tmp_path_factory):
    """Npz file of an inner race fault of a 6307."""
    path = tmp_path_factory.mktemp('good') / 'inner.npz'
    np.savez(path, x=fault_signal(4.0), fs=RATE, rpm=60.0 * SHAFT_HZ)
    return path


def _lines(capsys):
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_json_line_of_a_fault(good, capsys):
    assert main(['diagnose', str(good), '--bearing', '6307', '--json']) == 0
    (answer,) = _lines(capsys)
    assert set(answer) == KEYS
    assert (answer['result'], answer['faults'], answer['level']) == ('inner', ['inner'], 'fault')
    assert answer['shaft_hz'] == pytest.approx(SHAFT_HZ, rel=0.002)
    evidence = answer['evidence']
    assert evidence['fault_hz'] == pytest.approx(evidence['fault_hz_expected'], rel=0.005)
    assert evidence['fault_code'] == 'BEARING_INNER_RACE'


def test_bad_files_get_an_answer_and_stop_no_other(good, tmp_path, capsys):
    rng = np.random.default_rng(0)
    x = rng.standard_normal(102_400)
    bad = {
        'empty.npz': b'',
        'text.mat': b'not a matrix',
        'torn.npz': good.read_bytes()[:500],
        'header.csv': b'time,x\n',
    }
    for name, data in bad.items():
        (tmp_path / name).write_bytes(data)
    cases = {
        'constant': (np.full(102_400, 2.0), 'constant'),
        'nan': (np.where(np.arange(102_400) == 77, np.nan, x), 'NaN'),
        'clipped': (np.clip(3.0 * x, -1.0, 1.0), 'clipped'),
        'dropped': (np.where(np.arange(102_400) < 51_200, 0.0, x), 'repeat one value'),
        'short': (x[:800], 'turns'),
    }
    for name, (values, _) in cases.items():
        np.savez(tmp_path / f'{name}.npz', x=values, fs=RATE, rpm=60.0 * SHAFT_HZ)
    names = [*bad, 'missing.wav', *(f'{name}.npz' for name in cases)]
    files = [str(tmp_path / name) for name in names] + [str(good)]
    status = main(['diagnose', *files, '--bearing', '6307', '--json', '--jobs', '1'])
    out, err = capsys.readouterr()
    answers = [json.loads(line) for line in out.splitlines()]
    assert status == 1
    assert [answer['file'] for answer in answers] == files
    assert answers[-1]['result'] == 'inner'
    unread = [*bad, 'missing.wav']
    assert 'is empty' in answers[0]['error'] and 'does not exist' in answers[len(bad)]['error']
    for name, answer in zip(unread, answers, strict=False):
        # What cannot be read is an error, no verdict.
        assert set(answer) == {'file', 'error'}
        assert str(tmp_path / name) in answer['error']
        assert f'bearing-twin diagnose: {answer["error"]}\n' in err
    for answer in answers[len(unread) : -1]:
        assert (answer['result'], answer['level']) == ('insufficient', 'none')
        assert answer['reasons'][0]
    for answer, (_, word) in zip(answers[len(unread) : -1], cases.values(), strict=True):
        assert word in answer['reasons'][0]


def test_record_with_a_speed_at_each_sample_is_taken_over_angle(tmp_path):
    """Impulses at the angles of the outer race of a 6205 while the shaft runs up by a quarter."""
    rng = np.random.default_rng(3)
    n = int(5 * RATE)
    shaft = np.linspace(20.0, 25.0, n)
    turns = np.cumsum(shaft) / RATE
    x = rng.standard_normal(n)
    ring = np.exp(-600 * np.arange(400) / RATE) * np.sin(2 * np.pi * 4500 * np.arange(400) / RATE)
    hits = np.zeros(n)
    hits[np.searchsorted(turns, np.arange(1.0, turns[-1] * 3.585) / 3.585)] = 8.0
    np.savez(tmp_path / 'up.npz', x=x + np.convolve(hits, ring)[:n], fs=RATE, rpm=60.0 * shaft)
    bearing = own_bearing('9,7.94,39.04,0')
    said = diagnose_file(Task(path=str(tmp_path / 'up.npz'), bearing=bearing))
    assert said['faults'] == ['outer'], said['reasons']
    # As one number the speed smears its lines.
    blurred = diagnose_file(Task(path=str(tmp_path / 'up.npz'), bearing=bearing, shaft_hz=22.5))
    assert blurred['level'] != 'fault'
    np.savez(tmp_path / 'stop.npz', x=x, fs=RATE, shaft_hz=np.maximum(shaft - 21.0, 0.0))
    stopped = diagnose_file(Task(path=str(tmp_path / 'stop.npz'), bearing=bearing))
    assert 'turns' in stopped['reasons'][0] or 'stood still' in stopped['reasons'][0]


def test_missing_file_is_an_error_and_no_verdict(tmp_path, capsys):
    assert main(['diagnose', str(tmp_path / 'no.npz'), '--bearing', '6205']) == 1
    out, err = capsys.readouterr()
    assert out == ''
    assert err == f'bearing-twin diagnose: {tmp_path / "no.npz"} does not exist\n'


@pytest.mark.parametrize('command', ['info', 'verify', 'recover'])
def test_commands_for_recordings_say_what_reads_vibration_files(command, good, tmp_path, capsys):
    assert main([command, str(good)]) != 0
    assert "'bearing-twin diagnose' reads vibration files" in capsys.readouterr().err
    (tmp_path / 'snapshots').mkdir()
    shutil.copy(good, tmp_path / 'snapshots')
    assert main([command, str(tmp_path / 'snapshots')]) != 0
    assert '--series' in capsys.readouterr().err


def test_folder_and_table_of_snapshots_point_to_a_series(good, tmp_path, capsys):
    """A trend file of a run, with statistics and temperatures, holds no vibration to judge."""
    assert main(['diagnose', str(good.parent), '--bearing', '6307']) == 1
    err = capsys.readouterr().err
    assert f"'bearing-twin diagnose {good.parent}/*.npz' judges each" in err
    assert f"'bearing-twin diagnose --series {good.parent}'" in err
    np.savez(tmp_path / 'table.npz', x=np.ones((9, 2560)), fs=RATE, rpm=1800.0)
    np.savez(tmp_path / 'trend.npz', temp_C=np.sin(np.arange(90e3)), fs=RATE, rpm=1800.0)
    for name, words in (('table', '--series'), ('trend', 'no array of numbers')):
        assert main(['diagnose', str(tmp_path / f'{name}.npz'), '--bearing', '6307']) == 1
        assert words in capsys.readouterr().err


def test_page_for_a_person(good, capsys, monkeypatch):
    monkeypatch.setenv('NO_COLOR', '1')
    assert main(['diagnose', str(good), '--bearing', '6307', '--unit', 'g', '--power-group', '2',
                 '--mounting', 'rigid']) == 0  # fmt: skip
    text = capsys.readouterr().out
    rows = {line.partition(' ')[0]: line for line in text.splitlines()}
    assert 'inner [fault]' in rows['Verdict']
    assert '6307: 8 balls of 14 mm on 57.5 mm' in rows['Bearing']
    # As the report says it.
    assert f'{SHAFT_HZ:.2f} Hz ({60.0 * SHAFT_HZ:.0f} rpm)' in rows['Shaft']
    assert 'mm/s rms, ISO 20816-3 zone' in rows['Velocity']
    assert '; confidence' in rows['Stage'] and f'{SHAFT_HZ:g} Hz' in rows['Speed']
    assert max(map(len, text.splitlines()[1:])) <= 80
    expected = fault_frequencies(find_bearing('6307'), SHAFT_HZ)
    for place, hertz in (('inner', expected.bpfi), ('outer', expected.bpfo),
                         ('ball', 2.0 * expected.bsf), ('cage', expected.ftf)):  # fmt: skip
        (row,) = [line for line in text.splitlines() if line.strip().startswith(f'{place} ')]
        assert f'{hertz:.2f}' in row.split()
        assert row.rstrip().endswith('<-') == (place == 'inner')
    assert f'line of the envelope at {expected.bpfi:.0f}'[:-1] in text
    assert 'eplace the bearing' in rows['Next']
    assert '\x1b' not in text


def test_healthy_without_zone_or_baseline_says_what_is_not_judged(tmp_path, capsys):
    noise = np.random.default_rng(1).normal(size=round(5 * RATE))
    np.savez(tmp_path / 'sound.npz', x=noise, fs=RATE, shaft_hz=SHAFT_HZ)
    asked = ['diagnose', str(tmp_path / 'sound.npz'), '--bearing', '6307']
    assert main(asked) == 0
    text = capsys.readouterr().out
    assert 'healthy [ok]' in text and 'not judged: wear without impacts' in text
    main([*asked, '--unit', 'm/s^2', '--power-group', '2', '--mounting', 'rigid'])
    assert 'not judged' not in capsys.readouterr().out


def test_speed_in_turns_a_minute(good, tmp_path, capsys):
    bare = tmp_path / 'bare.npz'
    np.savez(bare, x=fault_signal(4.0), fs=RATE)
    args = ['diagnose', str(bare), '--bearing', '6307', '--json']
    assert main([*args, '--rpm', str(60.0 * SHAFT_HZ)]) == 0
    assert main([*args, '--shaft-hz', str(SHAFT_HZ)]) == 0
    by_rpm, by_hz = _lines(capsys)
    assert by_rpm == by_hz
    assert by_rpm['result'] == 'inner'
    assert main([*args, '--rpm', '-3']) == 1
    with pytest.raises(SystemExit):
        main([*args, '--rpm', '1500', '--shaft-hz', '25'])


def test_channel_by_any_unambiguous_name(tmp_path, capsys):
    path = tmp_path / 'rig.npz'
    noise = np.random.default_rng(1).standard_normal(len(fault_signal(4.0)))
    np.savez(path, DE_time=fault_signal(4.0), FE_time=noise, fs=RATE, rpm=60.0 * SHAFT_HZ)
    args = ['diagnose', str(path), '--bearing', '6307']
    for name in ('DE_time', 'de_time', 'DE', 'de'):
        assert main([*args, '--channel', name, '--json']) == 0
        (answer,) = _lines(capsys)
        assert 'DE_time' in answer['source']
        assert answer['result'] == 'inner'
    assert main([*args, '--channel', 'time']) == 1
    assert "channel 'time' may be any of DE_time, FE_time" in capsys.readouterr().err
    assert main([*args, '--channel', 'BA']) == 1
    assert "no channel 'BA'; it has DE_time, FE_time" in capsys.readouterr().err
    assert main([*args, '--channels']) == 0
    assert capsys.readouterr().out.split() == [f'{path}:', 'DE_time', 'FE_time']


def test_shaft_and_sample_rate_of_an_mfpt_file(tmp_path):
    """MFPT files: sr samples a second, a shaft that turns rate times, both in a struct."""
    path = tmp_path / 'baseline.npz'
    np.savez(path, gs=fault_signal(4.0), sr=RATE, rate=SHAFT_HZ, load=270.0)
    said = diagnose_file(Task(path=str(path), bearing=find_bearing('6307')))
    assert said['evidence']['shaft_hz_given'] == pytest.approx(SHAFT_HZ)
    assert said['result'] == 'inner'


@pytest.fixture(scope='module')
def parquet_set(tmp_path_factory):
    """Return a data set of three signals as bearing-datasets 0.3 writes it (layout 2)."""
    import pyarrow as pa
    from pyarrow import parquet

    folder = tmp_path_factory.mktemp('root') / 'rig'
    (folder / 'signals').mkdir(parents=True)
    noise = np.random.default_rng(2).standard_normal(len(fault_signal(4.0)))
    signals = {'r0/DE': fault_signal(4.0), 'r0/FE': noise, 'r1/DE': noise[::-1]}
    table = pa.table(
        {
            'signal_id': list(signals),
            'signal': pa.array([x.astype(np.float32) for x in signals.values()],
                               pa.list_(pa.float32())),
        }
    )  # fmt: skip
    parquet.write_table(
        table, folder / 'signals' / 'part-float32.parquet', compression='zstd', row_group_size=2
    )
    orders = fault_orders(find_bearing('6307'))._asdict()
    labels = ['inner', 'inner', 'normal']
    columns = {
        'dataset': ['rig'] * 3, 'signal_id': list(signals), 'recording_id': ['r0', 'r0', 'r1'],
        'native_label': labels, 'channel': ['DE', 'FE', 'DE'], 'sensor_location': ['base'] * 3,
        'fs': [RATE] * 3, 'n_samples': [len(noise)] * 3, 'fault_type': labels,
        'fault_location': ['test_bearing', 'test_bearing', 'none'],
        'sensor_at_fault': [False] * 3,
        'signal_file': ['part-float32.parquet'] * 3, 'signal_row_group': [0, 0, 1],
        'signal_row': [0, 1, 0], 'quantity': ['acceleration'] * 3, 'unit': ['g', 'g', 'V'],
        'sensitivity': ['none', 'none', '10 V/g'],
        'speed_profile': ['constant', 'constant', 'increasing'],
        'speed_rpm': [60.0 * SHAFT_HZ] * 3, 'bearing_model': ['of our own'] * 3,
        **{name: [round(order, 5)] * 3 for name, order in orders.items()},
        # Python has no such times without pandas.
        'start': pa.array([1, 2, 3], pa.timestamp('ns')),
    }  # fmt: skip
    parquet.write_table(pa.table(columns), folder / 'metadata.parquet')
    manifest = {'dataset': 'rig', 'schema_version': 2, 'n_recordings': 2, 'n_signals': 3}
    (folder / 'manifest.json').write_text(json.dumps(manifest))
    return folder


def test_parquet_form_of_bearing_datasets(parquet_set, capsys):
    assert main(['diagnose', str(parquet_set), '--json', '--jobs', '1']) == 0
    answers = _lines(capsys)
    assert [answer['result'] for answer in answers] == ['inner', 'healthy', 'insufficient']
    assert [answer['channel'] for answer in answers] == ['r0/DE', 'r0/FE', 'r1/DE']
    assert {answer['evidence']['severity']['unit'] for answer in answers} == {'g'}
    assert 'the shaft speed is unknown' in answers[2]['reasons'][0]
    assert main(['diagnose', str(parquet_set), '--jobs', '1']) == 0
    assert 'rig, r0/FE: healthy' in capsys.readouterr().out
    assert main(['diagnose', str(parquet_set), '--channel', 'r0/DE']) == 0
    assert 'rig, r0/DE' in capsys.readouterr().out
    assert main(['diagnose', str(parquet_set), '--channels']) == 0
    assert capsys.readouterr().out.split()[1:] == ['r0/DE', 'r0/FE', 'r1/DE']
    assert main(['benchmark', str(parquet_set), '--full', '--jobs', '1']) == 0
    said = capsys.readouterr()
    assert '| rig | 2 | 1 |  |  |  |  | 1 |' in said.out
    assert '1 signals are left out: they are without a fault of ours or a constant' in said.err
    (parquet_set.parent / 'bad').mkdir()
    (parquet_set.parent / 'bad' / 'metadata.parquet').write_bytes(b'PAR1 no')
    assert main(['diagnose', str(parquet_set.parent / 'bad')]) == 1
    assert 'cannot be read as Parquet' in capsys.readouterr().err


@pytest.mark.parametrize(
    ('column', 'values', 'why'),
    [
        ('signal_row_group', [None, 0, 1], 'has no signal r0/DE in row 0 of group None'),
        ('signal_row', ['a', '1', '0'], 'has no signal r0/DE in row a of group 0'),
        ('signal_id', ['r0/DE', 'r0/DE', 'r1/DE'], 'has one signal_id twice'),
    ],
)
def test_a_parquet_set_that_contradicts_itself(parquet_set, tmp_path, capsys, column, values, why):
    import pyarrow as pa
    from pyarrow import parquet

    shutil.copytree(parquet_set, tmp_path / 'rig')
    table = parquet.read_table(parquet_set / 'metadata.parquet')
    index = table.column_names.index(column)
    parquet.write_table(
        table.set_column(index, column, pa.array(values)), tmp_path / 'rig' / 'metadata.parquet'
    )
    assert main(['diagnose', str(tmp_path / 'rig'), '--jobs', '1']) == 1
    assert why in capsys.readouterr().err


@pytest.mark.parametrize('said', ['1.2.3 mV/g', '. V/g', '0.0 V/g', '10 V/(mm/s)', 'none', None])
def test_volts_of_a_sensitivity_that_tells_no_acceleration_have_no_unit(said):
    assert dataset._physical({'unit': 'V', 'sensitivity': said}) == (1.0, '')


def test_one_signal_of_a_parquet_set_is_shown_as_a_file_is(parquet_set, tmp_path, capsys):
    page = tmp_path / 'page.html'
    assert main(['report', str(parquet_set), '--channel', 'r0/DE', '-o', str(page)]) == 0
    assert 'Inner race fault' in page.read_text()
    assert main(['report', str(parquet_set), '-o', str(page)]) == 1
    assert 'r0/DE, r0/FE, r1/DE' in capsys.readouterr().err


def test_parquet_form_is_what_the_package_itself_reads(parquet_set):
    bearing_datasets = pytest.importorskip('bearing_datasets', reason='pip install it')
    from bearing_datasets.schema import validate

    theirs = bearing_datasets.open('rig', root=parquet_set.parent)
    validate(theirs.metadata(), {'start': 'a column that only this set has'})
    for name in ('r0/DE', 'r1/DE'):
        ours = read_signal(parquet_set, channel=name)
        np.testing.assert_allclose(ours.x, theirs.signal(name, unit='g'), rtol=1e-14)


def test_parquet_of_newer_writers_is_read():
    """Arrow from 19.0.1 on leaves out the counts of levels that plain columns do not have."""
    from pyarrow import parquet

    # A column 'signal_id' with one value 'a', by Arrow 26.
    written = (
        'eNpNTzsKwkAUnF3ComKhgReysEUalxRJMIJWNvYW4gVk0aABP3Hj50oe0xcri2lmhvlsVtuSAhrQYE2SEAICgCNQ'
        'SGHG1IgUKbNAKlws3HjMquwghAQFOpsjVu3+VF0cMTGcyLjf1serO+/qwwRrw95IaqONhaGhnkON9J+FWI185G1h'
        'e/8tOuNV6CLBEySWHKK0/XWzX9pe5JEmjfP3Z/XI902TO+9v7+RV+ba+XZPZopgWpTbdgA9jw0e/sXIlhQ=='
    )
    table = parquet.read_table(io.BytesIO(zlib.decompress(base64.b64decode(written))))
    assert table.to_pydict() == {'signal_id': ['a']}


def test_many_files_on_all_cores_in_order(good, capsys):
    files = [str(good)] * 5
    args = ['diagnose', *files, '--geometry', '8,14,57.5,0', '--json', '--jobs', '2']
    assert main(args) == 0
    answers = _lines(capsys)
    assert len(answers) == 5
    assert all(answer == answers[0] for answer in answers)
    assert answers[0]['result'] == 'inner'


def test_pictures(good, tmp_path, capsys):
    args = ['diagnose', str(good), '--bearing', '6307', '--plot', str(tmp_path / 'plots')]
    assert main(args) == 0
    (picture,) = (tmp_path / 'plots').iterdir()
    assert picture.read_bytes().startswith(b'\x89PNG')
    assert 'inner [fault]' in capsys.readouterr().out


@pytest.mark.parametrize('command', ['diagnose', 'fit'])
def test_a_picture_that_cannot_be_written_ends_no_batch(command, good, tmp_path, capsys):
    files, plots = [str(good)] * 2, tmp_path / 'file'
    plots.write_text('')
    args = [command, *files, '--bearing', '6307', '--json', '--plot', str(plots)]
    assert main(args) == 1
    answers = _lines(capsys)
    assert len(answers) == 2
    assert all(f'{plots}/' in answer['error'] for answer in answers)


@pytest.mark.parametrize('command', ['diagnose', 'fit'])
def test_without_a_picture_there_is_no_folder(command, tmp_path):
    assert main([command, 'missing.wav', '--plot', str(tmp_path / 'plots')]) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('text', ['', '9', 'a,b,c', '9,40,39,0', '9,7.9,39,95', '2,7.9,39'])
def test_bad_geometry(text):
    with pytest.raises(BearingTwinError):
        own_bearing(text)


@pytest.mark.parametrize(
    'extra',
    [['--shaft-hz', '-1'], ['--speed-tolerance', '3'], ['--jobs', '0'], ['--bearing', 'x']],
)
def test_bad_arguments(good, capsys, extra):
    assert main(['diagnose', str(good), *extra]) == 1
    assert 'Traceback' not in capsys.readouterr().err


def test_unknown_bearing_and_speed_are_said(tmp_path):
    path = tmp_path / 'bare.npz'
    np.savez(path, x=fault_signal(1.0), fs=RATE)
    assert '--bearing' in diagnose_file(Task(path=str(path)))['error']
    bearing = own_bearing('8,14,57.5,0')
    said = diagnose_file(Task(path=str(path), bearing=bearing))
    assert 'speed is unknown' in said['reasons'][0]


def test_benchmark_of_a_small_folder(good, tmp_path, capsys):
    index = {
        'bearings': {
            'B': {'n_elements': 8, 'element_d_mm': 14.0, 'pitch_d_mm': 57.5, 'contact_deg': 0.0}
        },
        'records': [
            {'id': 'a', 'dataset': 'd', 'file': str(good), 'label': 'inner', 'rpm': 1500.0,
             'bearing_name': 'B', 'sr2015_grade_12kDE': 'Y1'},
            {'id': 'b', 'dataset': 'd', 'file': str(good), 'label': 'outer', 'rpm': 1500.0,
             'bearing_name': 'B', 'sr2015_grade_12kDE': 'Y2'},
        ],
    }  # fmt: skip
    (tmp_path / 'index.json').write_text(json.dumps(index))
    assert main(['benchmark', str(tmp_path), '--full', '--jobs', '1']) == 0
    text = capsys.readouterr().out
    assert '| Y1 and Y2 together | 2 | 1 | 1 |' in text
    assert '- b, outer: wrong (inner: inner)' in text
    assert '| all | 2 |' in text  # of the confidence
    assert main(['benchmark', str(tmp_path), '--misled', '--jobs', '1']) == 0
    rows = [line.split(' | ') for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[:3] for row in rows] == [
        ['| wrong bearing', 'damaged', '24'],
        ['| speed 3 and 5 % off', 'damaged', '8'],
    ]
    assert main(['benchmark', str(tmp_path), '--full', '--jobs', '1', '--json']) == 0
    pieces = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [piece['groups']['grade'] for piece in pieces] == ['d Y1', 'd Y2']
    assert main(['benchmark', str(tmp_path / 'nowhere')]) == 1
    # A bearing of the catalogue needs no entry; a misspelt one is replaced by no other.
    del index['bearings']['B']
    for record in index['records']:
        record['bearing_name'] = '6307'
    (tmp_path / 'index.json').write_text(json.dumps(index))
    assert main(['benchmark', str(tmp_path), '--full', '--jobs', '1']) == 0
    capsys.readouterr()
    index['records'][1]['bearing_name'] = '63O7'
    (tmp_path / 'index.json').write_text(json.dumps(index))
    assert main(['benchmark', str(tmp_path), '--full', '--jobs', '1']) == 1
    assert "record b: no bearing '63O7' in the catalogue; the closest" in capsys.readouterr().err


@pytest.mark.parametrize('command', ['diagnose', 'bearings', 'replay'])
def test_every_command_refuses_an_unknown_bearing(good, tmp_path, capsys, command):
    recording = tmp_path / 'schedule.mcap'
    assert main(['schedule', '-o', str(recording)]) == 0
    capsys.readouterr()
    arguments = {
        'diagnose': [str(good), '--bearing', '63O6'],
        'bearings': ['63O6'],
        'replay': [str(recording), '--offline', '-o', str(tmp_path / 'o'),
                   '--twin', 'bearing=63O6'],
    }[command]  # fmt: skip
    assert main([command, *arguments]) == 1
    assert (
        "no bearing '63O6' in the catalogue; the closest names: 6306," in capsys.readouterr().err
    )


def test_bench_figures():
    figures = measure()
    assert figures['diagnosis_ms'] > 0.0
    if 'kurtogram_ms' in figures:
        ratio = figures['diagnosis_ms'] / figures['kurtogram_ms']
        assert figures['kurtogram_ratio'] == pytest.approx(ratio)


def test_a_file_that_kills_its_process_takes_no_other_with_it(good, tmp_path, capsys, monkeypatch):
    @functools.wraps(diagnose.diagnose_file)
    def killed_by_one(task):
        if task.path.endswith('2.npz'):
            os.kill(os.getpid(), signal.SIGKILL)
        return original(task)

    original = diagnose.diagnose_file
    monkeypatch.setattr(diagnose, 'diagnose_file', killed_by_one)
    paths = [tmp_path / f'{number}.npz' for number in range(6)]
    for path in paths:
        path.write_bytes(good.read_bytes())
    words = ['diagnose', *map(str, paths), '--bearing', '6307', '--shaft-hz', '25.4', '--json']
    assert main([*words, '--jobs', '2']) == 1
    answers = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [answer['file'] for answer in answers] == list(map(str, paths))
    assert ['error' in answer for answer in answers] == [False, False, True, False, False, False]


@pytest.mark.parametrize('command', ['diagnose', 'benchmark'])
def test_fewer_processes_than_one_are_refused(command, good, tmp_path, capsys):
    record = {
        'id': 'a', 'file': 'a.npz', 'dataset': 'ours', 'label': 'healthy', 'bearing_name': '6307',
        'rpm': 1500.0,
    }  # fmt: skip
    (tmp_path / 'index.json').write_text(json.dumps({'bearings': {}, 'records': [record]}))
    word = str(good) if command == 'diagnose' else str(tmp_path)
    assert main([command, word, '--jobs', '-1']) == 1
    assert '--jobs -1' in capsys.readouterr().err


def test_a_shaft_that_stands_is_not_unknown(good, tmp_path, capsys):
    np.savez(tmp_path / 'a.npz', x=np.load(good)['x'], fs=RATE, rpm=0.0)
    assert main(['diagnose', str(tmp_path / 'a.npz'), '--bearing', '6307']) == 0
    text = capsys.readouterr().out
    assert 'Shaft      standing' in text
    assert 'the shaft stands still: measure while it turns' in text
    assert 'Next step  Measure while the shaft turns.' in text


def test_a_benchmark_of_no_records_is_an_error(tmp_path, capsys):
    (tmp_path / 'index.json').write_text('{"bearings": {}, "records": []}')
    assert main(['benchmark', str(tmp_path)]) == 1
    assert 'has no record with a label of inner, outer, ball, cage' in capsys.readouterr().err


@pytest.mark.parametrize(
    'text',
    [
        '[]',
        '{"bearings": {"a": 1}, "records": []}',
        '{"bearings": {}, "records": [1]}',
        '[' * 99_999,
    ],
)
def test_an_index_of_another_form_is_refused_in_words(text, tmp_path, capsys):
    (tmp_path / 'index.json').write_text(text)
    assert main(['benchmark', str(tmp_path)]) == 1
    assert 'cannot be used' in capsys.readouterr().err


def test_every_file_is_answered_although_a_dask_worker_is_killed(good, tmp_path, capsys):
    pytest.importorskip('distributed', reason="pip install 'bearing_twin[dask]'")
    from distributed import Client

    address_file = tmp_path / 'scheduler.json'
    scheduler = [sys.executable, '-m', 'distributed.cli.dask_scheduler', '--port', '0',
                 '--no-dashboard', '--host', '127.0.0.1',
                 '--scheduler-file', str(address_file)]  # fmt: skip
    worker = [sys.executable, '-m', 'distributed.cli.dask_worker', '--no-dashboard', '--no-nanny',
              '--nthreads', '1', '--scheduler-file', str(address_file),
              '--local-directory', str(tmp_path)]  # fmt: skip
    environment = os.environ | {'PYTHONPATH': os.pathsep.join(sys.path), 'OMP_NUM_THREADS': '1'}
    processes = []

    def start(command):
        processes.append(
            subprocess.Popen(
                command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT
            )
        )
        return processes[-1]

    try:
        start(scheduler)
        deadline = time.monotonic() + 180.0
        while not address_file.exists():
            assert time.monotonic() < deadline, 'no scheduler'
            time.sleep(0.1)
        victim = start(worker)
        start(worker)
        address = json.loads(address_file.read_text())['address']
        with Client(address) as client:
            client.wait_for_workers(2, timeout=180)
        paths = []
        for number in range(24):
            paths.append(tmp_path / f'{number}.npz')
            paths[-1].write_bytes(good.read_bytes())
        command = [sys.executable, '-m', 'bearing_twin', 'diagnose', *map(str, paths),
                   '--bearing', '6307', '--json', '--dask', address]  # fmt: skip
        job = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        processes.append(job)
        first = job.stdout.readline()
        victim.send_signal(signal.SIGKILL)
        rest, _ = job.communicate(timeout=300)
        answers = [json.loads(line) for line in [first, *rest.splitlines()]]
        assert job.returncode == 0
        assert [answer['file'] for answer in answers] == [str(path) for path in paths]
        assert {answer['result'] for answer in answers} == {'inner'}
    finally:
        for process in processes:
            process.kill()
            process.wait()


FILES_OF_A_WORKER = """
import resource, sys
from bearing_twin.bearing import find_bearing
from bearing_twin.cli.diagnose import Task, _diagnose_files
tasks = [Task(path=sys.argv[1], bearing=find_bearing('6307'))] * 4
faults = []
for _ in range(2):
    _diagnose_files(tasks)
    faults.append(resource.getrusage(resource.RUSAGE_SELF).ru_minflt)
print(faults[1] - faults[0])
"""


def test_a_dask_worker_keeps_the_memory_that_it_freed(good):
    # The setting with which Dask starts its workers: each page of an array is a fault again.
    environment = os.environ | {'MALLOC_TRIM_THRESHOLD_': '65536'}
    ran = python('-c', FILES_OF_A_WORKER, good, env=environment, check=True)
    assert int(ran.stdout) < 1000


def test_each_setting_is_an_option_or_left_out_on_purpose():
    parser = argparse.ArgumentParser()
    configure(parser)
    options = set(vars(parser.parse_args(['file.npz'])))
    # Those of a sliding window and of a series, which a whole record has not; a speed in a file
    # has its own.
    left_out = {
        'window', 'update_interval', 'memory', 'hold_updates', 'baseline_windows',
        'measured_speed_tolerance', 'series_cycle', 'series_hold', 'series_snapshot',
    }  # fmt: skip
    assert {quantity.name for quantity in fields(DiagnosisSettings)} - options == left_out
