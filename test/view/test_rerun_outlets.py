# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where pictures go: files, ports and servers, and what is no such place."""

import os
from pathlib import Path
import signal
import socket
import subprocess
import sys
from urllib.parse import parse_qs, urlsplit
from urllib.request import urlopen

from bearing_twin import cli
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.finding import find_recording
from bearing_twin.recording.reader import read_messages
from bearing_twin.view.rerun.logger import RerunLogger
from bearing_twin.view.rerun.viewer import listening, live_url, LOOPBACK
import pytest


def test_a_client_that_never_reads_holds_nothing_up(recording, tmp_path):
    before = set(listening(os.getpid()))
    messages = [
        (m.topic, m.type_name, m.decode(), m.log_time)
        for m in read_messages(recording, topics=['/vibration'])
    ][:250]
    with (
        RerunLogger(
            recording_id='deaf', serve=(LOOPBACK, 0), memory_limit='1MB', full_samples=True
        ) as logger,
        socket.create_connection((LOOPBACK, *set(listening(os.getpid())) - before)) as deaf,
    ):
        deaf.sendall(b'PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n')
        for _ in range(8):
            for message in messages:
                logger.log(*message)
    assert logger.problems == {}
    assert logger.failed == 0


@pytest.mark.skipif(not Path('/proc/net/if_inet6').exists(), reason='this machine has no IPv6')
def test_a_recorder_serves_at_an_ipv6_address():
    before = set(listening(os.getpid()))
    with RerunLogger(recording_id='ipv6', serve=('::1', 0)):
        (port,) = set(listening(os.getpid())) - before
        socket.create_connection(('::1', port)).close()


def test_files_and_ports_in_use_are_refused(tmp_path):
    rrd = tmp_path / 'a.rrd'
    rrd.write_bytes(b'precious')
    with pytest.raises(BearingTwinError, match='not overwritten'):
        RerunLogger(recording_id='a', rrd=rrd)
    assert rrd.read_bytes() == b'precious'
    with pytest.raises(BearingTwinError, match='no folder'):
        RerunLogger(recording_id='a', rrd=tmp_path / 'none' / 'a.rrd')
    with socket.socket() as taken:
        taken.bind((LOOPBACK, 0))
        taken.listen()
        with pytest.raises(BearingTwinError, match='port'):
            RerunLogger(recording_id='a', serve=(LOOPBACK, taken.getsockname()[1]))


@pytest.mark.parametrize(
    ('text', 'url'),
    [
        ('9876', 'rerun+http://127.0.0.1:9876/proxy'),
        ('10.0.0.5:80', 'rerun+http://10.0.0.5:80/proxy'),
        ('rerun+http://a:1/proxy', 'rerun+http://a:1/proxy'),
    ],
)
def test_servers_are_named_in_three_ways(text, url):
    assert live_url(text) == url


@pytest.mark.parametrize(
    'text', ['', '0', '70000', 'host', 'http://x', 'a b:1', 'rerun+http://x:y/', 'rerun://[::1']
)
def test_what_is_no_server_is_refused(text):
    with pytest.raises(BearingTwinError, match='no Rerun server'):
        live_url(text)


def test_a_folder_stands_for_the_bag_in_it(recording, tmp_path):
    run = tmp_path / 'demo'
    run.mkdir()
    (run / 'bag').symlink_to(recording, target_is_directory=True)
    (run / 'view.rrd').touch()
    assert find_recording(run) == run / 'bag'
    assert find_recording(run / 'view.rrd') == run / 'view.rrd'
    with pytest.raises(BearingTwinError, match='does not exist'):
        find_recording(tmp_path / 'nothing')
    (tmp_path / 'empty').mkdir()
    with pytest.raises(BearingTwinError, match='no recording'):
        find_recording(tmp_path / 'empty')


def test_the_command_says_what_is_wrong(tmp_path, capsys):
    assert cli.main(['view']) == 2
    assert '--live' in capsys.readouterr().err
    torn = tmp_path / 'x.mcap'
    torn.write_bytes(b'no mcap at all')
    assert cli.main(['view', str(torn), '--save', str(tmp_path / 'x.rrd')]) == 1
    assert 'Traceback' not in capsys.readouterr().err


def test_a_process_that_draws_many_pictures_keeps_none_of_their_threads(tmp_path):
    tasks = Path('/proc/self/task')
    if not tasks.is_dir():
        pytest.skip('the threads of a process are counted on Linux')
    counts = []
    for k in range(12):
        with RerunLogger(recording_id=f'p{k}', rrd=tmp_path / f'{k}.rrd'):
            pass
        counts.append(len(list(tasks.iterdir())))
    assert counts[-1] <= counts[2] + 2


@pytest.mark.parametrize('address', ['127.0.0.1', '::1'])
def test_a_browser_finds_the_page_and_the_data_that_it_names(tmp_path, address):
    rrd = tmp_path / 'page.rrd'
    with RerunLogger(recording_id='page', rrd=rrd):
        pass
    if ':' in address and not Path('/proc/net/if_inet6').exists():
        pytest.skip('this machine has no IPv6')
    command = [sys.executable, '-m', 'bearing_twin', 'view', str(rrd), '--web', '--web-port', '0']
    command += ['--address', address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewing:
        try:
            url = urlsplit(viewing.stdout.readline().strip())
            with urlopen(f'http://{url.netloc}') as page:
                assert page.headers['content-type'] == 'text/html'
            data = urlsplit(parse_qs(url.query)['url'][0])
            assert (data.scheme, data.path) == ('rerun+http', '/proxy')
            socket.create_connection((data.hostname, data.port)).close()
        finally:
            viewing.send_signal(signal.SIGINT)
    assert viewing.returncode == 0
