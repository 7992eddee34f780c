# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""diagnose on files of every kind, good and bad: its answers, pages, pictures and refusals."""

import argparse
from dataclasses import fields
import json
from pathlib import Path
import re
import shutil

from bearing_twin.bearing import fault_frequencies, fault_orders, find_bearing, own_bearing
from bearing_twin.bench.diagnosis import fault_signal, measure, RATE, SHAFT_HZ
from bearing_twin.cli import main
from bearing_twin.cli.diagnose.command import configure
from bearing_twin.cli.diagnose.file import diagnose_file
from bearing_twin.cli.diagnose.task import Task
from bearing_twin.diagnosis import DiagnosisSettings
from bearing_twin.errors import BearingTwinError
from commands import json_lines
import numpy as np
import pytest

KEYS = {
    'file', 'channel', 'source', 'bearing', 'result', 'faults', 'level', 'confidence', 'claim',
    'shaft_hz', 'slip', 'evidence', 'reasons', 'next_step',
}  # fmt: skip


def test_json_line_of_a_fault(good, capsys):
    assert main(['diagnose', str(good), '--bearing', '6307', '--json']) == 0
    (answer,) = json_lines(capsys)
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
    by_rpm, by_hz = json_lines(capsys)
    assert by_rpm == by_hz
    assert by_rpm['result'] == 'inner'
    assert main([*args, '--rpm', '-3']) == 2
    with pytest.raises(SystemExit):
        main([*args, '--rpm', '1500', '--shaft-hz', '25'])


def test_channel_by_any_unambiguous_name(tmp_path, capsys):
    path = tmp_path / 'rig.npz'
    noise = np.random.default_rng(1).standard_normal(len(fault_signal(4.0)))
    np.savez(path, DE_time=fault_signal(4.0), FE_time=noise, fs=RATE, rpm=60.0 * SHAFT_HZ)
    args = ['diagnose', str(path), '--bearing', '6307']
    for name in ('DE_time', 'de_time', 'DE', 'de'):
        assert main([*args, '--channel', name, '--json']) == 0
        (answer,) = json_lines(capsys)
        assert 'DE_time' in answer['source']
        assert answer['result'] == 'inner'
    assert main([*args, '--channel', 'time']) == 1
    assert "channel 'time' may be any of DE_time, FE_time" in capsys.readouterr().err
    assert main([*args, '--channel', 'BA']) == 1
    assert "no channel 'BA'; it has DE_time, FE_time" in capsys.readouterr().err
    assert main([*args, '--channels']) == 0
    assert capsys.readouterr().out.split() == [f'{path}:', 'DE_time', 'FE_time']
    # A file that cannot be read keeps no other from being listed.
    assert main(['diagnose', 'missing.wav', *args[1:], '--channels', '--json']) == 1
    said = capsys.readouterr()
    assert (json.loads(said.out), said.err) == (
        {str(path): ['DE_time', 'FE_time']},
        'bearing-twin diagnose: missing.wav does not exist\n',
    )


def test_shaft_and_sample_rate_of_an_mfpt_file(tmp_path):
    """MFPT files: sr samples a second, a shaft that turns rate times, both in a struct."""
    path = tmp_path / 'baseline.npz'
    np.savez(path, gs=fault_signal(4.0), sr=RATE, rate=SHAFT_HZ, load=270.0)
    said = diagnose_file(Task(path=str(path), bearing=find_bearing('6307')))
    assert said['evidence']['shaft_hz_given'] == pytest.approx(SHAFT_HZ)
    assert said['result'] == 'inner'


def test_pictures(good, tmp_path, capsys):
    args = ['diagnose', str(good), '--bearing', '6307', '--plot', str(tmp_path / 'plots')]
    assert main(args) == 0
    (picture,) = (tmp_path / 'plots').iterdir()
    assert picture.read_bytes().startswith(b'\x89PNG')
    assert 'inner [fault]' in capsys.readouterr().out


def test_every_file_has_a_picture_of_its_own(good, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = ['a/b_c.npz', 'a_b/c.npz', 'a_b_c.npz']
    for name in files:
        Path(name).parent.mkdir(exist_ok=True)
        shutil.copy(good, name)
    args = ['diagnose', *files, '--bearing', '6307', '--plot', 'plots', '--jobs', '1']
    assert main(args) == 0
    names = sorted(path.name for path in (tmp_path / 'plots').iterdir())
    assert names == ['a_b_c.npz.png', 'a_b_c.npz_2.png', 'a_b_c.npz_3.png']


def test_a_record_without_a_spectrum_says_that_it_has_no_picture(good, tmp_path, capsys):
    short, plots = tmp_path / 'short.npz', tmp_path / 'plots'
    np.savez(short, x=fault_signal(0.2), fs=RATE, rpm=60.0 * SHAFT_HZ)
    args = ['diagnose', str(short), str(good), '--bearing', '6307', '--plot', str(plots)]
    assert main([*args, '--json', '--jobs', '1']) == 0
    said, error = capsys.readouterr()
    assert error == (
        f'bearing-twin diagnose: {short}: no picture, as it has no spectrum: see the reasons of '
        'its verdict\n'
    )
    assert len(list(plots.iterdir())) == 1
    # Not a part of the answer.
    assert all('drawn' not in json.loads(line) for line in said.splitlines())


def test_verdicts_are_printed_whose_picture_cannot_be_written(good, tmp_path, capsys):
    plots = tmp_path / 'file'
    plots.write_text('')
    args = ['--bearing', '6307', '--plot', str(plots)]
    assert main(['diagnose', str(good), str(good), *args, '--json']) == 1
    answers = json_lines(capsys)
    assert len(answers) == 2
    assert all(set(answer) == {*KEYS, 'error'} for answer in answers)
    assert all(f'{plots}/' in answer['error'] for answer in answers)
    assert main(['diagnose', str(good), *args]) == 1
    said, error = capsys.readouterr()
    assert 'inner' in said
    assert error.startswith(f'bearing-twin diagnose: {good}: {plots}/')


@pytest.mark.parametrize('command', ['diagnose', 'fit'])
def test_without_a_picture_there_is_no_folder(command, tmp_path):
    assert main([command, 'missing.wav', '--plot', str(tmp_path / 'plots')]) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ('text', 'said'),
    [('', 'is not Z,D_BALL_MM'), ('9', 'is not Z,D_BALL_MM'), ('a,b,c', 'is not Z,D_BALL_MM'),
     ('9,40,39,0', 'the ball comes first'), ('9,7.9,39,95', 'below 90'), ('2,7.9,39', '3..100'),
     ('BPFO=3.585', 'give both'), ('BPFO=5.4,BPFI=3.6', 'the smaller one is BPFO'),
     ('BPFO=3.6,BPFI=5.4,BSF', 'is not BPFO='), ('BPFO=3.6,BPFO=3.6,BPFI=5.4', 'is not BPFO='),
     ('BPFO=3.6,BPFI=5.4,speed=3', 'is not BPFO='), ('BPFO=x,BPFI=5.4', 'is not BPFO='),
     ('BPFO=3.6,BPFI=5.4,FTF=0.6', 'FTF=0.4;'), ('BPFO=3.6,BPFI=5.4,FTF=nan', 'FTF=0.4;'),
     # The frequency with which a defect of a ball strikes, which some makers print.
     ('BPFO=3.6,BPFI=5.4,BSF=4.71', 'at most 2.4 '), ('BPFO=3.6,BPFI=5.4,BSF=nan', 'no bearing'),
     ('BPFO=3.6,BPFI=5.2', 'no bearing'), ('BPFO=inf,BPFI=inf', 'give both')],
)  # fmt: skip
def test_bad_geometry(text, said):
    with pytest.raises(BearingTwinError, match=re.escape(said)):
        own_bearing(text)


def test_the_orders_that_a_maker_prints_do_for_a_geometry(good, capsys):
    """With two decimals, in any sequence; but a fit needs the size."""
    orders = fault_orders(find_bearing('6307'))
    text = f'bsf={orders.bsf:.2f}, BPFI={orders.bpfi:.2f}, BPFO={orders.bpfo:.2f}'
    assert main(['diagnose', str(good), '--geometry', text, '--json']) == 0
    (found,) = json_lines(capsys)
    assert found['bearing'] == f'{text}: 8 rolling elements, of size unknown'
    assert main(['diagnose', str(good), '--bearing', '6307', '--json']) == 0
    (by_name,) = json_lines(capsys)
    assert (found['result'], found['level']) == (by_name['result'], by_name['level'])
    fault_hz = by_name['evidence']['fault_hz']
    assert found['evidence']['fault_hz'] == pytest.approx(fault_hz, rel=1e-4)
    assert main(['fit', str(good), '--geometry', text]) == 1
    assert 'do not tell the size' in capsys.readouterr().err


@pytest.mark.parametrize(
    'extra',
    [['--shaft-hz', '-1'], ['--speed-tolerance', '3'], ['--jobs', '0'], ['--bearing', 'x']],
)
def test_bad_arguments(good, capsys, extra):
    assert main(['diagnose', str(good), *extra]) == 2
    assert 'Traceback' not in capsys.readouterr().err


def test_unknown_bearing_and_speed_are_said(tmp_path):
    path = tmp_path / 'bare.npz'
    np.savez(path, x=fault_signal(1.0), fs=RATE)
    assert '--bearing' in diagnose_file(Task(path=str(path)))['error']
    bearing = own_bearing('8,14,57.5,0')
    said = diagnose_file(Task(path=str(path), bearing=bearing))
    assert 'speed is unknown' in said['reasons'][0]


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
    assert main([command, *arguments]) == (1 if command == 'bearings' else 2)
    assert (
        "no bearing '63O6' in the catalogue; the closest names: 6306," in capsys.readouterr().err
    )


def test_bearings_that_strike_at_an_order(capsys):
    assert main(['bearings', '620', '--order', '5.401']) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    assert {row[0]: row[-1] for row in rows} == dict.fromkeys(
        ('6205', '6206', '6207', '6208', '6209'), 'inner'
    )
    assert main(['bearings', '6205', '--order', '4.72', '--json']) == 0
    assert json.loads(capsys.readouterr().out)['strikes'] == 'ball'
    assert main(['bearings', '6205', '--order', '3']) == 1
    assert 'strikes 3 times a turn (within 0.01)' in capsys.readouterr().err


def test_bench_figures():
    figures = measure()
    assert figures['diagnosis_ms'] > 0.0
    if 'kurtogram_ms' in figures:
        ratio = figures['diagnosis_ms'] / figures['kurtogram_ms']
        assert figures['kurtogram_ratio'] == pytest.approx(ratio)


def test_a_shaft_that_stands_is_not_unknown(good, tmp_path, capsys):
    np.savez(tmp_path / 'a.npz', x=np.load(good)['x'], fs=RATE, rpm=0.0)
    assert main(['diagnose', str(tmp_path / 'a.npz'), '--bearing', '6307']) == 0
    text = capsys.readouterr().out
    assert 'Shaft      standing' in text
    assert 'the shaft stands still: measure while it turns' in text
    assert 'Next step  Measure while the shaft turns.' in text


def test_each_setting_is_an_option_or_left_out_on_purpose():
    parser = argparse.ArgumentParser()
    configure(parser)
    options = set(vars(parser.parse_args(['file.npz'])))
    # Those of a sliding window and of a series, which a whole record has not; a speed in a file
    # has its own.
    left_out = {
        'window', 'update_interval', 'memory', 'hold_updates', 'baseline_windows',
        'measured_speed_tolerance', 'series_cycle', 'longest_hold', 'series_snapshot',
    }  # fmt: skip
    assert {quantity.name for quantity in fields(DiagnosisSettings)} - options == left_out
