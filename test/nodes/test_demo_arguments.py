# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo refuses what cannot work before it starts or writes anything; what its table says."""

import dataclasses
from pathlib import Path

from bearing_twin.cli import main
from bearing_twin.cli.demo.summary import Summary
import pytest

SUMMARY = Summary(
    temperature_low=20.0,
    temperature_high=110.0,
    defect='inner',
    preset='paper',
    amplitude_by_temperature={25.0: 172.0, 105.0: 157.0},
    amplitude_change=-0.09,
    result='inner',
    verdicts={'inner': 9},
    false_alarms=0,
    confidence=0.95,
    fault_hz=124.0,
    fault_hz_expected=125.3,
    fault_hz_twin=124.1,
    blocks_published=100,
    blocks_recorded=99,
    blocks_late=2,
    blocks_dropped=3,
    samples_lost_by_diagnosis=0,
    samples_lost_by_recorder=0,
    sent_before_recorder=0,
    lateness_max_ms=1.0,
    files={},
    open_with='bearing-twin view x',
)


def test_no_change_has_no_minus():
    nothing = dataclasses.replace(SUMMARY, amplitude_change=-1e-5, fault_hz_twin=124.0 + 1e-4)
    text = ' '.join(nothing.to_text().split())
    assert '; +0.0 % from' in text
    assert '(+0.00 %)' in text


@pytest.mark.ros
@pytest.mark.parametrize(
    ('words', 'text', 'status'),
    [
        (['--rate', '0'], 'rate', 2),
        (['--rate', 'nan'], 'rate', 2),
        (['--defect', 'foo'], "'foo'", 2),
        (['--recording', 'missing.mcap'], 'missing.mcap', 1),
    ],
)
def test_refused_before_anything_is_written(tmp_path, capsys, ros_domain, words, text, status):
    out = tmp_path / 'runs'
    assert main(['demo', '--out', str(out), *words]) == status
    assert text in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.ros
def test_a_file_is_no_folder(tmp_path, capsys, ros_domain):
    out = tmp_path / 'file'
    out.write_text('')
    assert main(['demo', '--out', str(out)]) == 1
    assert str(out) in capsys.readouterr().err


def test_two_demos_of_one_second_have_a_folder_each(tmp_path):
    from bearing_twin.cli.demo.command import make_folder

    made = {make_folder(tmp_path) for _ in range(3)}
    assert len(made) == 3
    assert all(isinstance(path, Path) and path.is_dir() for path in made)


def test_slip_is_no_error_and_losses_are_counted():
    good = dataclasses.replace(SUMMARY, blocks_dropped=0, blocks_recorded=100)
    assert good.good
    assert '(-0.08 %)' in ' '.join(good.to_text().split())
    assert '100 published, 2 late, 0 lost' in good.to_text()
    assert '100 published, 2 late, 4 lost' in SUMMARY.to_text()
    assert not SUMMARY.good


def test_a_false_alarm_on_the_way_is_not_good():
    good = dataclasses.replace(SUMMARY, blocks_dropped=0, blocks_recorded=100)
    assert not dataclasses.replace(good, false_alarms=1).good
