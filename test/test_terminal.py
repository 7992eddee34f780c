# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The command as a person types it: help, completion, colours, and what fails at once."""

import contextlib
import gc
import os
from pathlib import Path
import pty
import re
import socket
import subprocess
import sys
from types import ModuleType

from bearing_twin.cli import COMMANDS, main
from bearing_twin.cli.bench import FIGURES
from bearing_twin.cli.run import NODES
from bearing_twin.cli.terminal import report_compiling
from commands import python
from forked import run_command, start_command
import numpy as np
from probe import TIMEOUT
import pytest

COMMAND = [sys.executable, '-m', 'bearing_twin']


def test_the_command_alone_prints_help(capsys):
    assert main([]) == 0
    out = capsys.readouterr().out
    assert out.startswith('usage: bearing-twin')
    # Each has its text beside it.
    listed = re.findall(r'^    ([a-z]+) +[a-z]', out, re.MULTILINE)
    assert listed == list(COMMANDS)


def test_help_loads_no_library():
    """The promise of 0.3 s holds by loading nothing: times say what else the machine does."""
    script = """
import sys
from bearing_twin.cli import main
try:
    main(['--help'])
except SystemExit:
    pass
heavy = {'numpy', 'scipy', 'numba', 'rclpy', 'rerun', 'mcap', 'matplotlib', 'argcomplete'}
sys.exit(', '.join(sorted(heavy & sys.modules.keys())) or 0)
"""
    ran = python('-c', script)
    assert ran.returncode == 0, ran.stderr


@pytest.mark.parametrize('words', [['bearings', '6205'], ['run', 'twin', '--help']])
def test_garbage_is_looked_for_from_the_work_on(words):
    """The start of the process has switched it off, for what it loads."""
    gc.disable()
    try:
        assert main(words) == 0
        assert gc.isenabled()
    finally:
        gc.enable()


def test_what_a_command_spawns_imports_nothing_from_the_working_directory(tmp_path):
    """As the pool of a calibration node, and the workers of a bench."""
    (tmp_path / 'multiprocessing.py').write_text('raise SystemExit(7)')
    script = """
import sys
sys.path[:] = filter(None, sys.path)
from multiprocessing import get_context
from bearing_twin.start import command
sys.argv[1:] = ['bearings', '6205']
command()
child = get_context('spawn').Process(target=print)
child.start()
child.join()
sys.exit(child.exitcode)
"""
    ran = subprocess.run([sys.executable, '-c', script], cwd=tmp_path, check=False)
    assert ran.returncode == 0


@pytest.mark.parametrize('node', NODES)
def test_help_of_a_node_lists_its_parameters(node, capsys):
    assert main(['run', node, '--help']) == 0
    out = capsys.readouterr().out
    assert f'usage: bearing-twin run {node} --ros-args' in out.replace('[', '').replace(']', '')
    assert max(map(len, out.splitlines())) <= 80
    names = re.findall(r'^  ([a-z0-9_.]+)  ', out, re.MULTILINE)
    assert len(names) == len(set(names)) >= 5
    expected = {'twin': 'defect', 'diagnosis': 'bearing', 'recorder': 'output', 'replay': 'loop',
                'fleet': 'assets_file', 'adapter': 'sample_rate',
                'calibration': 'bearing'}  # fmt: skip
    assert expected[node] in names


def test_a_shell_completes_commands_options_and_choices(tmp_path):
    def complete(line):
        answer = tmp_path / 'answer'
        answer.unlink(missing_ok=True)
        environment = os.environ | {
            '_ARGCOMPLETE': '1', '_ARGCOMPLETE_STDOUT_FILENAME': str(answer),
            '_ARGCOMPLETE_IFS': '\n', '_ARGCOMPLETE_SHELL': 'bash',
            'COMP_LINE': line, 'COMP_POINT': str(len(line)), 'COMP_TYPE': '9',
        }  # fmt: skip
        subprocess.run([sys.executable, '-c', 'from bearing_twin.cli import main; main()'],
                       env=environment, check=True, timeout=TIMEOUT)  # fmt: skip
        return {word.strip() for word in answer.read_text().split('\n')}

    assert {'bench', 'benchmark', 'bearings'} == complete('bearing-twin be')
    assert complete('bearing-twin run tw') == {'twin'}
    assert '--bearing' in complete('bearing-twin diagnose --be')


def in_terminal(start):
    """Return what a process writes to a terminal, given the path of that to start it."""
    ours, theirs = pty.openpty()
    start(Path(os.ttyname(theirs))).wait(TIMEOUT)
    os.close(theirs)
    text = b''
    with contextlib.suppress(OSError):
        while part := os.read(ours, 65536):
            text += part
    os.close(ours)
    return text.decode()


def test_a_terminal_is_told_of_compiling_once_it_has_begun():
    script = """
from bearing_twin.cli.terminal import report_compiling
from bearing_twin.numerics import compiled
import numba
report_compiling('info')
numba.njit(lambda x: x + 1)(1)
report_compiling('fit')
"""

    def start(terminal):
        with terminal.open('wb') as out:
            return subprocess.Popen([sys.executable, '-c', script], stdout=out, stderr=out)

    said = in_terminal(start)
    assert said.count('compiling kernels') == 1
    assert said.startswith('bearing-twin fit: compiling kernels')
    assert python('-c', script).stderr == ''


def test_a_compiler_that_is_still_being_loaded_has_compiled_nothing(monkeypatch, capsys):
    name = 'bearing_twin.numerics.compiled'
    monkeypatch.setitem(sys.modules, name, ModuleType(name))
    monkeypatch.setattr(sys.stderr, 'isatty', lambda: True)
    report_compiling('info')
    assert capsys.readouterr().err == ''


def test_colours_in_a_terminal_and_nowhere_else(tmp_path):
    from bearing_twin.bench.diagnosis import fault_signal, RATE, SHAFT_HZ

    path = tmp_path / 'inner.npz'
    np.savez(path, x=fault_signal(2.0), fs=RATE, rpm=60.0 * SHAFT_HZ)
    words = ['diagnose', path, '--bearing', '6307']

    def said(**environment):
        return in_terminal(lambda out: start_command(*words, out=out, TERM='xterm', **environment))

    assert '\x1b[1;31minner [fault]\x1b[0m' in said(NO_COLOR='')
    assert '\x1b' not in said(NO_COLOR='1')
    file = run_command(*words, NO_COLOR='', TERM='xterm')
    assert '\x1b' not in file.stdout
    assert 'inner [fault]' in file.stdout


def test_an_answer_takes_the_line_of_progress_away(tmp_path):
    for name in ('a', 'b'):
        np.savez(tmp_path / f'{name}.npz', x=np.zeros(100), fs=1000.0, rpm=600.0)
    files = [tmp_path / f'{name}.npz' for name in ('a', 'b')]
    words = ['diagnose', *files, '--bearing', '6307', '--jobs', '1']
    said = in_terminal(lambda terminal: start_command(*words, out=terminal))
    # What comes after a line without an end begins at its start, on an empty line.
    assert '1 of 2 files\x1b[K\r\x1b[K' in said
    assert said.endswith('\r2 of 2 files\x1b[K\r\n')


def test_text_is_as_narrow_as_its_terminal_and_cuts_no_word(tmp_path):
    for name in ('a', 'b'):
        np.savez(tmp_path / f'{name}.npz', x=np.zeros(100), fs=1000.0, rpm=600.0)
    files = [tmp_path / f'{name}.npz' for name in ('a', 'b')]
    for words in (['bearings', '6205'], ['diagnose', files[0]], ['diagnose', *files]):
        words += ['--bearing', '6307', '--jobs', '1'] if words[0] == 'diagnose' else []
        said = in_terminal(
            lambda out, words=words: start_command(*words, out=out, COLUMNS='60', NO_COLOR='1')
        )
        lines = re.sub(r'\x1b\[K|.*\r(?!\n)', '', said).splitlines()
        assert max(len(line) for line in lines if str(tmp_path) not in line) <= 60
        # The words are those of a file, where a line for each statement can be searched.
        file = run_command(*words, NO_COLOR='1').stdout
        assert [word for line in lines for word in line.split()][
            : len(file.split())
        ] == file.split()
    assert len(file.splitlines()) == 4


def test_a_node_that_is_not_named_is_all_that_is_missing(capsys):
    with pytest.raises(SystemExit):
        main(['run'])
    assert capsys.readouterr().err.endswith('are required: NODE\n')


def test_live_view_without_a_server_fails_at_once(capsys, monkeypatch):
    asked, connect = [], socket.create_connection

    def ask(address, **options):
        asked.append(options)
        return connect(address, **options)

    monkeypatch.setattr(socket, 'create_connection', ask)
    # A port that is bound and not listened at: nobody else gets it, and it answers at once.
    with socket.socket() as silent:
        silent.bind(('127.0.0.1', 0))
        port = silent.getsockname()[1]
        assert main(['view', '--live', str(port)]) == 1
    # It asked once, and no longer than two seconds.
    assert asked == [{'timeout': 2.0}]
    error = capsys.readouterr().err
    assert f'no Rerun server at 127.0.0.1:{port}' in error
    assert f'rerun_port:={port}' in error


def test_a_server_of_an_impossible_name_is_said_in_a_sentence(capsys):
    assert main(['view', '--live', 'a..b:9876']) == 1
    assert 'no Rerun server at a..b:9876' in capsys.readouterr().err


@pytest.mark.parametrize('command', ['info', 'recover', 'report', 'verify', 'diagnose'])
def test_what_the_system_refuses_is_said_in_a_sentence(command, capsys):
    name = 'x' * 300
    assert main([command, f'{name}.mcap']) == 1
    said = capsys.readouterr().err
    assert 'File name too long' in said
    assert name in said
    assert 'Errno' not in said


@pytest.mark.parametrize(
    ('words', 'usage', 'meant'),
    [
        (['diagnose', 'a.npz', '--sample_rate', '9'], 'bearing-twin diagnose', '--sample-rate'),
        (['fit', 'a.npz', '--shaft_hz=25'], 'bearing-twin fit', '--shaft-hz'),
        (['bearings', 'SKF', '6205'], 'bearing-twin bearings', None),
        (['--versoin'], 'bearing-twin', '--version'),
        (['diagnos', 'a.npz'], 'bearing-twin', 'diagnose'),
        (['doctor'], 'bearing-twin', None),
    ],
)
def test_an_unknown_option_is_answered_with_the_one_that_was_meant(words, usage, meant, capsys):
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith(f'usage: {usage} [-h]')
    assert ('did you mean' in said) == (meant is not None)
    assert meant is None or said.endswith(f'did you mean {meant}?\n')


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (['diagnose', 'a.npz', '--rpm', '1500,5'], "'1500,5' is not a number; write a decimal"),
        (['diagnose', 'a.npz', '--shaft-hz', '25Hz'], "'25Hz' is not a number; write a decimal"),
        (['bearings', '--order', ''], "'' is not a number"),
        (['play', 'a.npz', '--block', '1e3'], "'1e3' is not a whole number; write digits"),
        (['diagnose', ''], 'the name is empty, as of a variable that is not set'),
        (['diagnose', 'a.npz', '--plot', ''], 'the name is empty'),
        (['whatif', ''], 'the name is empty'),
        (['benchmark', ''], 'the name is empty'),
        (['recover', ''], 'the name is empty'),
        (['recover', 'a.mcap', '-o', ''], 'the name is empty'),
        (['view', 'a.mcap', ''], 'the name is empty'),
    ],
)
def test_what_is_no_number_or_no_name_is_said_with_what_to_write(words, said, capsys):
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize('command', ['info', 'recover', 'report', 'verify', 'diagnose', 'view'])
@pytest.mark.parametrize('ending', ['mcap', 'npz'])
def test_a_link_to_itself_and_a_folder_named_like_a_file_are_refused(
    command, ending, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    loop, folder = Path(f'loop.{ending}'), Path(f'folder.{ending}')
    loop.symlink_to(loop)
    folder.mkdir()
    for name in loop, folder:
        assert main([command, str(name)]) == 1
        said = capsys.readouterr().err
        assert str(name) in said
        assert "'bearing-twin diagnose'" not in said
    assert sorted(tmp_path.iterdir()) == [tmp_path / folder, tmp_path / loop]


@pytest.mark.parametrize('name', [os.fsdecode(b'latin\xff.npz'), f'{"x" * 251}.npz'])
def test_a_vibration_file_of_any_name_becomes_a_page_and_a_picture(
    name, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    x = np.random.default_rng(0).standard_normal(51200)
    np.savez(name, x=x, fs=25600.0, rpm=1500.0)
    for words in (['report', name, '-o', 'page.html'], ['view', name, '--save', 'a.rrd']):
        assert main([*words, '--bearing', '6205']) == 0, capsys.readouterr().err
    assert name[:5] in (tmp_path / 'page.html').read_text()


@pytest.mark.parametrize('topic', ['-1', 'a b', '/a//b', '/a/', '5x', '\x1b[31m', '\udcff'])
def test_a_topic_is_one_that_ros_takes(topic, tmp_path, capsys):
    for command in ['schedule', '-o', str(tmp_path / 'run')], ['play', 'x.wav']:
        assert main([*command, f'--topic={topic}']) == 2
        assert f'--topic {topic!r}: letters' in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ('status', 'words', 'text'),
    [
        (1, ['--web', '--web-port=99999'], '127.0.0.1:99999 cannot be served'),
        (1, ['--web', '--address=\udcff'], ':9090 cannot be served'),
        (2, ['--screenshot=x', '--size=00x00'], "--size '00x00': give WIDTHxHEIGHT, each 10 to"),
        (2, ['--screenshot=x', '--size=9000x10'], "--size '9000x10'"),
        (2, ['--screenshot=x', '--size=\uff11\uff12x10'], 'give WIDTHxHEIGHT'),
    ],
)
def test_what_cannot_be_shown_is_refused(status, words, text, tmp_path, capsys):
    pytest.importorskip('rerun_cli', reason='Rerun is not installed')
    (tmp_path / 'a.rrd').touch()
    assert main(['view', str(tmp_path / 'a.rrd'), *words]) == status
    assert text in capsys.readouterr().err


@pytest.mark.parametrize('encoding', ['ascii', 'latin-1'])
def test_a_name_that_the_terminal_cannot_show_is_escaped(tmp_path, encoding):
    path = tmp_path / 'w\u00e9\u2192.mcap'
    assert main(['schedule', '-o', str(path)]) == 0
    ran = subprocess.run(
        [*COMMAND, 'info', str(path)],
        capture_output=True,
        env=os.environ | {'PYTHONIOENCODING': encoding},
    )
    assert (ran.returncode, ran.stderr) == (0, b'')
    assert b'\\u2192.mcap' in ran.stdout


@pytest.mark.parametrize('words', [[], ['6307'], ['NU209'], ['NICE'], ['--order', '5.4']])
def test_bearings_fit_a_terminal_of_80_columns(words, capsys):
    assert main(['bearings', *words]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


def test_what_is_in_a_recording_fits_a_terminal_of_80_columns(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    topic = f'/a_{"long" * 10}_temperature'
    assert main(['schedule', '-o', 'demo/bag', '--topic', topic]) == 0
    capsys.readouterr()
    # The folder of a demo stands for the bag in it.
    assert main(['info', 'demo']) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    row = next(k for k, line in enumerate(lines) if topic in line)
    assert lines[row].split() == ['401', '0.100', 's', topic]
    assert lines[row + 1].split() == ['sensor_msgs/msg/Temperature']


def test_what_cannot_be_said_is_no_success():
    ran = subprocess.run(
        ['sh', '-c', '"$@" >&-', 'sh', *COMMAND, 'bearings', '6205'], stderr=subprocess.PIPE
    )
    said = b'bearing-twin bearings: standard output: Bad file descriptor\n'
    assert (ran.returncode, ran.stderr) == (1, said)
    ran = subprocess.run(
        ['sh', '-c', '"$@" 2>&-', 'sh', *COMMAND, 'info', 'nowhere'], stdout=subprocess.PIPE
    )
    assert (ran.returncode, ran.stdout) == (1, b'')
    ran = subprocess.run(
        ['sh', '-c', '"$@" <&-', 'sh', *COMMAND, 'whatif', '-'], stderr=subprocess.PIPE
    )
    assert ran.returncode == 1
    assert ran.stderr.startswith(b'bearing-twin whatif: - holds no fit; write one')


@pytest.mark.parametrize('fit', ['/dev/zero', '-'])
def test_what_has_no_end_is_no_fit(fit, monkeypatch, capsys):
    with Path('/dev/zero').open() as zeros:
        monkeypatch.setattr(sys, 'stdin', zeros)
        assert main(['whatif', fit]) == 1
    said = f'bearing-twin whatif: {fit} holds no fit (more than 67108864 characters); write one'
    assert capsys.readouterr().err.startswith(said)


@pytest.mark.parametrize(
    ('words', 'where', 'status', 'said'),
    [
        ('bearings 6205', '> /dev/full', 1, 'bearings: standard output: No space left on device'),
        (
            'bearings --json',
            '> /dev/full',
            1,
            'bearings: standard output: No space left on device',
        ),
        ('bearings 6205', '| true', 141, ''),
        ('bearings nothing', '> /dev/full', 1, "bearings: no bearing 'nothing'"),
        ('bearings --help', '> /dev/full', 0, ''),
    ],
)
def test_output_that_ends_is_one_sentence(words, where, status, said):
    environment = {key: v for key, v in os.environ.items() if key != 'PYTHONUNBUFFERED'}
    # The pipe has no reader any more when the command prints.
    script = f'set -o pipefail; {{ sleep 0.2; "$@" {words}; }} {where}'
    ran = subprocess.run(
        ['bash', '-c', script, 'bash', *COMMAND], env=environment, capture_output=True, text=True
    )
    assert ran.returncode == status
    lines = ran.stderr.splitlines()
    assert len(lines) == bool(said)
    assert not said or lines[0].startswith(f'bearing-twin {said}')


@pytest.mark.parametrize('seconds', ['0', '-5', 'nan', '1e9'])
def test_a_schedule_has_two_readings_at_least(seconds, tmp_path, capsys):
    target = tmp_path / 'run'
    assert main(['schedule', f'--duration={seconds}', '-o', str(target)]) == 2
    assert f'a schedule of {float(seconds):g} s: give 0.1 to 100000 s' in capsys.readouterr().err
    assert not target.exists()


@pytest.mark.parametrize('seconds', ['nan', 'inf', '-1', '4', '1e9'])
def test_a_live_run_has_an_end(seconds, capsys):
    assert main(['bench', '--live', f'--seconds={seconds}']) == 2
    said = capsys.readouterr().err
    assert f'--seconds {float(seconds):g}: a live run takes 5 to 86400 s' in said


def test_bench_says_what_a_figure_is(capsys, monkeypatch):
    monkeypatch.setenv('NO_COLOR', '1')
    assert main(['bench', 'diagnosis']) == 0
    out = capsys.readouterr().out
    assert 'diagnosis (1 of 1): time per verdict' in out
    (row,) = [line for line in out.splitlines() if line.startswith('diagnosis_ms ')]
    assert row.split()[2] == 'ms'
    assert '< 1000' in row
    assert FIGURES['diagnosis_ms'].meaning in ' '.join(out.split())
    assert max(map(len, out.splitlines())) <= 80
