# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many files over processes and a Dask cluster, and scored against their labels."""

import functools
import json
import os
import signal
import subprocess
import sys
import time

from bearing_twin.bearing import catalogue
from bearing_twin.cli import main
from bearing_twin.cli.diagnose import file
from commands import json_lines, python
import psutil
import pytest


def test_many_files_on_all_cores_in_order(good, capsys):
    files = [str(good)] * 5
    args = ['diagnose', *files, '--geometry', '8,14,57.5,0', '--json', '--jobs', '2']
    assert main(args) == 0
    answers = json_lines(capsys)
    assert len(answers) == 5
    assert all(answer == answers[0] for answer in answers)
    assert answers[0]['result'] == 'inner'


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
    # All of the catalogue but 6307, whose geometry is that of the machine, and those alike.
    assert 0.95 * len(catalogue()) < int(rows[0][2]) / 2 < len(catalogue())
    assert [row[:2] for row in rows] == [
        ['| wrong bearing', 'damaged'],
        ['| speed 3 and 5 % off', 'damaged'],
    ]
    assert rows[1][2] == '8'
    assert main(['benchmark', str(tmp_path), '--full', '--jobs', '1', '--json']) == 0
    pieces = json_lines(capsys)
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


def test_a_file_that_kills_its_process_takes_no_other_with_it(good, tmp_path, capsys, monkeypatch):
    @functools.wraps(file.diagnose_file)
    def killed_by_one(task):
        if task.path.endswith('2.npz'):
            os.kill(os.getpid(), signal.SIGKILL)
        return original(task)

    original = file.diagnose_file
    monkeypatch.setattr(file, 'diagnose_file', killed_by_one)
    paths = [tmp_path / f'{number}.npz' for number in range(6)]
    for path in paths:
        path.write_bytes(good.read_bytes())
    words = ['diagnose', *map(str, paths), '--bearing', '6307', '--shaft-hz', '25.4', '--json']
    assert main([*words, '--jobs', '2']) == 1
    answers = json_lines(capsys)
    assert [answer['file'] for answer in answers] == list(map(str, paths))
    assert ['error' in answer for answer in answers] == [False, False, True, False, False, False]


@pytest.mark.parametrize('leaves', ['its reader', 'an interrupt'])
def test_an_end_in_between_diagnoses_no_further_file(leaves, good, tmp_path):
    words = ['diagnose', *[str(good)] * 2000, '--bearing', '6307', '--shaft-hz', '25.4']
    words += ['--json', '--jobs', '2']
    command = [sys.executable, '-m', 'bearing_twin', *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert json.loads(process.stdout.readline())['result'] == 'inner'
        began = time.monotonic()
        if leaves == 'its reader':
            process.stdout.close()
            assert process.wait(60.0) == 141
        else:
            process.send_signal(signal.SIGINT)
            process.stdout.read()
            assert process.wait(60.0) == 130
        # Each of the others would take 20 ms of a core and more.
        assert time.monotonic() - began < 5.0


def test_a_killed_diagnosis_leaves_no_process(good):
    words = ['diagnose', *[str(good)] * 2000, '--bearing', '6307', '--shaft-hz', '25.4']
    command = [sys.executable, '-m', 'bearing_twin', *words, '--json', '--jobs', '2']
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        others = psutil.Process(process.pid).children()
        assert len(others) == 2
        process.kill()
    end = time.monotonic() + 30.0
    # Where nobody takes the status of orphans, it stays as a zombie.
    while any(other.is_running() and other.status() != psutil.STATUS_ZOMBIE for other in others):
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.parametrize('command', ['diagnose', 'benchmark'])
def test_fewer_processes_than_one_are_refused(command, good, tmp_path, capsys):
    record = {
        'id': 'a', 'file': 'a.npz', 'dataset': 'ours', 'label': 'healthy', 'bearing_name': '6307',
        'rpm': 1500.0,
    }  # fmt: skip
    (tmp_path / 'index.json').write_text(json.dumps({'bearings': {}, 'records': [record]}))
    word = str(good) if command == 'diagnose' else str(tmp_path)
    assert main([command, word, '--jobs', '-1']) == 2
    assert '--jobs -1' in capsys.readouterr().err


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
        answers = [json.loads(line) for line in (first, *job.stdout)]
        assert job.wait() == 0
        assert [answer['file'] for answer in answers] == [str(path) for path in paths]
        assert {answer['result'] for answer in answers} == {'inner'}
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_who_gives_files_to_a_cluster_loads_no_diagnosis():
    code = 'import bearing_twin.cli.diagnose, sys; print(*{"numba", "scipy"} & set(sys.modules))'
    assert python('-c', code, check=True).stdout.split() == []


FILES_OF_A_WORKER = """
import resource, sys
from bearing_twin.bearing import find_bearing
from bearing_twin.cli.diagnose.spread import _diagnose_files
from bearing_twin.cli.diagnose.task import Task
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
