# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The command on the snapshots of a machine in files: the FEMTO runs, Parquet sets, folders."""

import itertools
import json

from bearing_twin.cli import main
from bearing_twin.diagnosis.machine.level import SUSPECT_DB
from bearing_twin.diagnosis.rules.table import TELLS
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.snapshots import read_snapshots
from bearing_twin.view.verdict import LOUDER
from cases import in_proofs
from commands import json_lines
from coupling import coupling_snapshot, GIVEN_HZ
import numpy as np
import pytest
from scipy.io import wavfile

RATE = 25600.0
COUNT = 1280
OTHERS = ('Bearing1_1_H', 'Bearing1_2_H', 'Bearing1_2_V', 'Bearing2_5_H', 'Bearing3_1_V')


# The shortest life, and the one whose level rises latest: for the last 16 of 911 snapshots.
@pytest.mark.parametrize('run', ['Bearing3_1_H', 'Bearing2_1_H', *in_proofs(*OTHERS)])
def test_femto_runs_to_failure(data_dir, capsys, run):
    folder = data_dir / 'femto'
    files = [folder / f'femto_{run}.npz', folder / f'femto_{run[:-1]}trend.npz']
    assert main(['diagnose', '--series', *map(str, files), '--json']) == 0
    *points, summary = json_lines(capsys)
    times = np.array([point['time'] for point in points])
    levels = [point['level'] for point in points]
    # The end is worn out: the rig was stopped. The first half of a life is taken as healthy.
    assert summary['level'] in ('suspect', 'fault')
    assert levels[-1] == summary['level']
    assert not {'suspect', 'fault'} & set(np.array(levels)[times < 0.5 * times[-1]])
    # A comb may be an alarm before the level rises.
    alarm = next(point for point in points if point['level'] in ('suspect', 'fault'))
    by_comb = alarm['over_baseline'] < SUSPECT_DB
    assert by_comb or summary['change_s'] <= summary['first_alarm_s']
    assert points[-1]['temperature'] is not None
    # A level that becomes known is no change of it.
    changed = times[1:][[a not in (b, 'none') for a, b in itertools.pairwise(levels)]]
    assert summary['level_changes'] == len(changed)
    assert all(np.sum((changed >= at) & (changed < at + 3600.0)) <= 2 for at in changed)


def test_series_of_a_parquet_set(tmp_path, capsys):
    """Two runs of two channels in one folder, rows not in order of time."""
    pa = pytest.importorskip('pyarrow')
    from pyarrow import parquet

    rng = np.random.default_rng(8)
    names = [
        f'{run}_{number}/{channel}'
        for number in (*range(20, 40), *range(20))
        for run in ('A', 'B')
        for channel in ('horizontal', 'vertical')
    ]
    parts = [name.replace('/', '_').split('_') for name in names]
    runs, numbers, channels = zip(*parts, strict=True)
    # One sensor of one run gets loud.
    loud = [run == 'B' and int(number) >= 30 for run, number in zip(runs, numbers, strict=True)]
    signals = [(8.0 if is_loud else 1.0) * rng.standard_normal(2560) for is_loud in loud]
    (tmp_path / 'signals').mkdir()
    table = pa.table({'signal_id': names, 'signal': pa.array(signals, pa.list_(pa.float64()))})
    parquet.write_table(table, tmp_path / 'signals' / 'part.parquet')
    columns = {
        'signal_id': names, 'run_id': runs, 'channel': channels, 'fs': [RATE] * len(names),
        'time_s': [10.0 * int(number) for number in numbers], 'unit': ['g'] * len(names),
        'signal_file': ['part.parquet'] * len(names), 'signal_row_group': [0] * len(names),
        'signal_row': list(range(len(names))), 'speed_rpm': [1800.0] * len(names),
    }  # fmt: skip
    parquet.write_table(pa.table(columns), tmp_path / 'metadata.parquet')
    command = ['diagnose', '--series', str(tmp_path), '--json', '--baseline', '20', '--channel']
    assert main([*command, 'A_ vertical']) == 0
    *points, summary = json_lines(capsys)
    assert [point['time'] for point in points] == [10.0 * number for number in range(40)]
    assert summary['level'] == 'ok'
    assert main([*command, 'B_ horizontal']) == 0
    summary = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert summary['level'] == 'fault'
    assert summary['change_s'] == 300.0
    assert main([*command, 'horizontal']) == 1
    assert '2 sensors (A horizontal, B horizontal)' in capsys.readouterr().err


def test_series_of_many_files_in_a_folder(tmp_path, capsys):
    rng = np.random.default_rng(4)
    for number in range(40):
        height = 1.0 if number < 30 else 8.0
        x = height * rng.standard_normal(COUNT)
        np.savetxt(tmp_path / f'acc_{number}.csv', x, header='fs = 25600, rpm = 1800')
    args = ['diagnose', '--series', str(tmp_path), '--bearing', '6205', '--baseline', '10']
    assert main([*args, '--cycle', '600']) == 0
    text = capsys.readouterr().out
    rows = {line.split(maxsplit=1)[0]: line for line in text.splitlines()}
    assert 'fault' in rows['level']
    assert rows['change'].split(maxsplit=1)[1] == '5 h'
    assert '40 snapshots in 6 h 30 min' in ' '.join(text.split())
    assert rows['speed'].split(maxsplit=1)[1] == '30 Hz'
    assert 'outer 3.585 orders, 107.5 Hz' in text
    assert 'Find the cause of the high vibration' in rows['next']
    # A path has no place to be broken.
    assert max(len(line) for line in text.splitlines() if str(tmp_path) not in line) <= 80
    assert main(args) == 1
    assert 'give --cycle SECONDS' in capsys.readouterr().err
    for absurd in ('-1', '0', 'nan', 'inf', '1e308'):
        assert main([*args, f'--cycle={absurd}']) == 2
        assert f'--cycle {float(absurd):g}: give a time above 0 s' in capsys.readouterr().err
    # More digits than Python makes a number of.
    wavfile.write(tmp_path / 'a.wav', 1000, np.zeros(50, np.int16))
    assert main(['diagnose', str(tmp_path / 'a.wav'), '--channel', '9' * 5000]) == 1
    assert 'does not exist' in capsys.readouterr().err
    (tmp_path / 'empty').mkdir()
    assert main(['diagnose', '--series', str(tmp_path / 'empty')]) == 1
    assert 'no file ends in' in capsys.readouterr().err


def test_files_in_any_order_with_one_that_cannot_be_read(tmp_path, capsys):
    rng = np.random.default_rng(4)
    for number in range(40):
        x = (1.0 if number < 30 else 8.0) * rng.standard_normal(COUNT)
        said = {'x': x, 'fs': RATE, 'rpm': 1800.0, 'time_s': 600.0 * number}
        np.savez(tmp_path / f's{17 * number % 40}.npz', **said)
    (tmp_path / 's17.npz').write_bytes(b'PK torn')
    args = ['diagnose', '--series', str(tmp_path), '--bearing', '6205', '--baseline', '10']
    assert main([*args, '--json']) == 1
    text = capsys.readouterr()
    summary = json.loads(text.out.splitlines()[-1])
    assert (summary['level'], summary['snapshots'], summary['change_s']) == ('fault', 39, 18000.0)
    assert 'left out: ' in text.err
    assert 's17.npz' in text.err
    assert main([*args, '--channel', 'nothing']) == 1
    assert "no channel 'nothing'" in capsys.readouterr().err


def test_page_of_a_risen_level_asks_for_its_cause(tmp_path, capsys):
    rng = np.random.default_rng(4)
    for number in range(40):
        x = (1.0 if number < 25 else 2.4) * rng.standard_normal(COUNT)
        np.savez(tmp_path / f's{number}.npz', x=x, fs=RATE, rpm=1800.0)
    args = ['diagnose', '--series', str(tmp_path), '--bearing', '6205', '--baseline', '10']
    assert main([*args, '--cycle', '600']) == 0
    page = ' '.join(capsys.readouterr().out.split())
    assert 'level suspect' in page
    assert page.endswith(f'next step {LOUDER[0].upper()}{LOUDER[1:]}')


def test_page_of_ambiguous_snapshots_says_what_tells(tmp_path, capsys):
    rng = np.random.default_rng(9)
    for number in range(5):
        said = {'fs': RATE, 'rpm': 60.0 * GIVEN_HZ, 'time_s': 600.0 * number}
        np.savez(tmp_path / f's{number}.npz', x=coupling_snapshot(rng), **said)
    args = ['diagnose', '--series', str(tmp_path), '--bearing', '6203']
    assert main(args) == 0
    page = ' '.join(capsys.readouterr().out.split())
    why = '5 of them are ambiguous (outer: What strikes a whole number of times a turn'
    assert f'5 of the last 5 snapshots alone say fault; {why}' in page
    tells = TELLS['whole_turns']
    assert page.endswith(f'next step {tells[0].upper()}{tells[1:]}')
    assert main([*args, '--json']) == 0
    summary = json_lines(capsys)[-1]
    assert (summary['level'], summary['place'], summary['doubt']) == ('fault', None, 'whole_turns')


def test_a_fault_held_from_ambiguous_snapshots_orders_no_bearing(tmp_path, capsys):
    """Five snapshots of a coupling, then noise; a fault is held until nine answers are lower."""
    rng = np.random.default_rng(9)
    tells = TELLS['whole_turns']
    args = ['diagnose', '--series', str(tmp_path), '--bearing', '6203', '--baseline', '10']
    pages = {}
    for number in range(5 + 13):
        x = coupling_snapshot(rng) if number < 5 else rng.standard_normal(round(2.5 * RATE))
        said = {'fs': RATE, 'rpm': 60.0 * GIVEN_HZ, 'time_s': 600.0 * number}
        np.savez(tmp_path / f's{number:02}.npz', x=x, **said)
        if number in (13, 17):
            assert main(args) == 0
            pages[number] = ' '.join(capsys.readouterr().out.split())
    assert '9 of the last 9 snapshots alone say ok ' in pages[13]
    assert 'level fault' in pages[13]
    assert 'fault held: What strikes a whole number of times a turn' in pages[13]
    assert pages[13].endswith(f'next step {tells[0].upper()}{tells[1:]}')
    assert 'level none' in pages[17] and 'fault held' not in pages[17]


def test_times_in_the_names_of_files(tmp_path):
    days = ['2004.02.28', '2004.02.29', '2004.02.30', '20040301']
    files = [tmp_path / f'{day}.10.32.39.csv' for day in days]
    for path in files:
        np.savetxt(path, np.arange(9) % 4, header='fs = 1000')
    times = [snapshot.time for snapshot in read_snapshots([files[3], files[0], files[1]])]
    assert np.diff(times).tolist() == [86400.0, 86400.0]
    assert [snap.time for snap in read_snapshots(files, cycle=5.0)] == [0.0, 5.0, 10.0, 15.0]
    with pytest.raises(BearingTwinError, match=r'02\.30.*does not say when'):
        list(read_snapshots(files))


@pytest.mark.parametrize(
    ('first', 'second', 'seconds'),
    [
        ('2026-11-30 10:00:00,1', '2026-11-30 10:00:00.001,2', 1796032800.0),
        ('2026-11-30T11:00:00.5+01:00;1', '2026-11-30T11:00:00.501+01:00;2', 1796032800.5),
        ('2026-11-30T10:00:00Z,1', '2026-11-30T10:00:00.001Z,2', 1796032800.0),
        ('30.11.2026 10:00:00;1', '30.11.2026 10:00:00.001;2', 1796032800.0),
        ('30.11.2026;10:00:00,25;1,5', '30.11.2026;10:00:00,251;2,5', 1796032800.25),
        ('11/30/2026 2:00:00 PM,1', '11/30/2026 2:00:00.001 PM,2', 1796047200.0),
        ('2026/11/30\t10:00:00\t1', '2026/11/30\t10:00:00.001\t2', 1796032800.0),
        ('time,acc\n1796032800.0,1', '1796032800.001,2', 1796032800.0),
        ('acc;time (ms)\n1,5;1796032800250', '2,5;1796032800251', 1796032800.25),
        ('time;acc\n1796032800,25;1,5', '1796032800,251;2,5', 1796032800.25),
    ],
)
def test_times_in_the_first_row_of_a_text(tmp_path, first, second, seconds):
    path = tmp_path / 'a.csv'
    path.write_text(f'{first}\n{second}\n')
    (snapshot,) = read_snapshots([path], sample_rate=1000.0)
    assert (snapshot.time, len(snapshot.signal.x)) == (seconds, 2)


@pytest.mark.parametrize(
    'rows',
    [
        '11/12/2026 10:00:00,1\n11/12/2026 10:00:00.001,2',
        '10:00:00,1\n10:00:00.001,2',
        'time,acc\n0.000,1\n0.001,2',
    ],
    ids=['day or month', 'no date', 'from a start'],
)
def test_rows_that_tell_no_date(tmp_path, rows):
    path = tmp_path / 'a.csv'
    path.write_text(f'{rows}\n')
    with pytest.raises(BearingTwinError, match='does not say when'):
        list(read_snapshots([path], sample_rate=1000.0))


def test_times_may_be_a_column(tmp_path):
    np.savez(tmp_path / 'a.npz', x=np.ones((2, 200)), fs=1000.0, t_s=[[5.0], [6.0]])
    assert [snapshot.time for snapshot in read_snapshots([tmp_path / 'a.npz'])] == [5.0, 6.0]


@pytest.mark.parametrize(
    ('said', 'reason'),
    [
        ({'time_s': 'soon'}, "its time holds <U4, e.g. 'soon'"),
        ({'temp_t_s': np.arange(4.0), 'temp_C': np.arange(3.0)}, 'has 4 values and temp_C has 3'),
        ({'temp_t_s': ['a', 'b'], 'temp_C': np.arange(2.0)}, "temp_t_s holds <U1, e.g. 'a'"),
    ],
)
def test_times_and_temperatures_are_numbers_in_pairs(tmp_path, said, reason):
    np.savez(tmp_path / 'a.npz', x=np.arange(200.0) % 4, fs=1000.0, **said)
    with pytest.raises(BearingTwinError, match=reason):
        list(read_snapshots([tmp_path / 'a.npz'], cycle=5.0))
