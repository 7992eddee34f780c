# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""diagnose, benchmark and bench on files of every kind, good and bad, alone and on a cluster."""

import json
import os
import signal
import subprocess
import sys
import time

from bearing_twin.bearing import own_bearing
from bearing_twin.bench.diagnosis import fault_signal, measure, RATE, SHAFT_HZ
from bearing_twin.cli import main
from bearing_twin.cli.diagnose import diagnose_file, Task
from bearing_twin.errors import BearingTwinError
import numpy as np
import pytest

KEYS = {
    'file', 'result', 'faults', 'level', 'confidence', 'shaft_hz', 'slip', 'evidence', 'reasons',
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
        'short': (x[:800], 'turns'),
    }
    for name, (values, _) in cases.items():
        np.savez(tmp_path / f'{name}.npz', x=values, fs=RATE, rpm=60.0 * SHAFT_HZ)
    names = [*bad, 'missing.wav', *(f'{name}.npz' for name in cases)]
    files = [str(tmp_path / name) for name in names] + [str(good)]
    status = main(['diagnose', *files, '--bearing', '6307', '--json', '--jobs', '1'])
    answers = _lines(capsys)
    assert status == 1
    assert [answer['file'] for answer in answers] == files
    assert answers[-1]['result'] == 'inner'
    for answer in answers[:-1]:
        assert (answer['result'], answer['level']) == ('insufficient', 'none')
        assert answer['reasons'][0]
    for answer, (_, word) in zip(answers[-5:-1], cases.values(), strict=True):
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


def test_missing_and_empty_files_are_said_to_be_such(tmp_path):
    assert 'does not exist' in diagnose_file(Task(path=str(tmp_path / 'no.csv')))['reasons'][0]
    (tmp_path / 'no.mat').touch()
    assert 'is empty' in diagnose_file(Task(path=str(tmp_path / 'no.mat')))['reasons'][0]


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
    assert '--bearing' in diagnose_file(Task(path=str(path)))['reasons'][0]
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
    assert main(['benchmark', str(tmp_path / 'nowhere')]) == 1


def test_bench_figures():
    figures = measure()
    assert figures['diagnosis_ms'] > 0.0
    if 'kurtogram_ms' in figures:
        ratio = figures['diagnosis_ms'] / figures['kurtogram_ms']
        assert figures['kurtogram_ratio'] == pytest.approx(ratio)


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
        deadline = time.monotonic() + 60.0
        while not address_file.exists():
            assert time.monotonic() < deadline, 'no scheduler'
            time.sleep(0.1)
        victim = start(worker)
        start(worker)
        address = json.loads(address_file.read_text())['address']
        with Client(address) as client:
            client.wait_for_workers(2, timeout=60)
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
        rest, _ = job.communicate(timeout=120)
        answers = [json.loads(line) for line in [first, *rest.splitlines()]]
        assert job.returncode == 0
        assert [answer['file'] for answer in answers] == [str(path) for path in paths]
        assert {answer['result'] for answer in answers} == {'inner'}
    finally:
        for process in processes:
            process.kill()
            process.wait()
