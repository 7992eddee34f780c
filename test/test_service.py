# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The service of the docs is one that systemd takes, and its retention keeps what it should."""

import os
from pathlib import Path
import re
import shutil
import subprocess
import time

from bearing_twin.assets.parameters.recorder import SPECS
import pytest
import yaml

PAGE = (Path(__file__).resolve().parents[1] / 'docs' / 'service.md').read_text(encoding='utf-8')
DAY = 86400.0


def block(language, after=''):
    """Return the first block of a language, of those behind a text."""
    return re.search(rf'(?s)```{language}\n(.*?)```', PAGE[PAGE.index(after) :])[1]


@pytest.mark.skipif(not shutil.which('systemd-analyze'), reason='systemd is not installed')
def test_systemd_takes_the_unit(tmp_path):
    unit = tmp_path / 'bearing-twin@.service'
    unit.write_text(block('ini'))
    verified = subprocess.run(
        ['systemd-analyze', 'verify', '--man=no', '--recursive-errors=no', str(unit)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (verified.returncode, verified.stderr) == (0, '')
    # It does find what is wrong.
    unit.write_text(block('ini').replace('ExecStart=/bin/bash', 'ExecStart=/bin/no_such_shell'))
    command = ['systemd-analyze', 'verify', '--man=no', '--recursive-errors=no', str(unit)]
    assert subprocess.run(command, capture_output=True, check=False).returncode != 0


@pytest.mark.skipif(not shutil.which('systemd-tmpfiles'), reason='systemd is not installed')
def test_old_recordings_go_and_baselines_stay(tmp_path):
    rule = block('', 'bearing_twin.conf').replace('/var/lib/bearing_twin', str(tmp_path))
    (tmp_path / 'rule.conf').write_text(rule)
    ages = {
        'fan_7/recordings/fan_7/fan_7_0.mcap': 15,
        'fan_7/recordings/fan_7_2/fan_7_2_0.mcap': 15,
        'fan_7/recordings/fan_7_2/fan_7_2_1.mcap': 13,
        'fan_7/bearing_twin/fan_7.state': 100,
    }
    for name, days in ages.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
        os.utime(path, (time.time() - days * DAY,) * 2)
    for folder in (tmp_path / 'fan_7' / 'recordings').iterdir():
        os.utime(folder, (time.time() - 15 * DAY,) * 2)
    command = ['systemd-tmpfiles', '--clean', str(tmp_path / 'rule.conf')]
    cleaned = subprocess.run(command, capture_output=True, text=True, check=False)
    assert cleaned.returncode == 0, cleaned.stderr
    kept = {name for name in ages if (tmp_path / name).exists()}
    assert kept == {'fan_7/recordings/fan_7_2/fan_7_2_1.mcap', 'fan_7/bearing_twin/fan_7.state'}
    assert not (tmp_path / 'fan_7/recordings/fan_7').exists()


def test_the_parameters_are_those_of_the_recorder():
    [(node, parameters)] = yaml.safe_load(block('yaml')).items()
    assert node == '/**/recorder'
    assert parameters['ros__parameters'].keys() <= {spec.name for spec in SPECS}
