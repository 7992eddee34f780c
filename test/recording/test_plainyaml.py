# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""YAML inside of recordings and messages: no text of some hundred characters takes all memory."""

from __future__ import annotations

import json
from pathlib import Path
import time

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain, LONGEST
from bearing_twin.recording.qos import read_qos
from bearing_twin.recording.reader import recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.recording.writer import RecordingWriter
import pytest
from recording_samples import TEMPERATURE, temperature_cdr

MERGES = 'a0: &a0 {k: v}\n' + ''.join(
    f'a{i}: &a{i} {{<<: [{",".join([f"*a{i - 1}"] * 10)}]}}\n' for i in range(1, 12)
)
"""Unpacked by a trusting reader: 10^11 entries."""
LISTS = 'a0: &a0 [x]\n' + ''.join(
    f'a{i}: &a{i} [{",".join([f"*a{i - 1}"] * 10)}]\n' for i in range(1, 12)
)


@pytest.fixture(scope='module')
def of_many_parts() -> float:
    """Return the processor time for a text of nearly as many parts as are read, s."""
    text = json.dumps(list(range(90_000)))
    began = time.process_time()
    load_plain(text, 'it')
    return time.process_time() - began


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        (MERGES, 'refers to another part'),
        (LISTS, 'refers to another part'),
        ('[' * 50_000, 'nested deeper'),
        ('x: ' + '1' * 50_000, '4300 digits'),
        ('x: 2001-99-99', 'month'),
        ('{[a]: b}', 'constructing'),
        ('!!python/object/apply:os.system ["true"]', 'constructor'),
        ('[' + '[],' * 300_000 + ']', 'more than 100000 parts'),
        ('a: ' + 'b' * LONGEST, f'at most {LONGEST}'),
    ],
)
def test_refused_at_once(text: str, reason: str, of_many_parts: float) -> None:
    began = time.process_time()
    with pytest.raises(BearingTwinError, match=reason):
        load_plain(text, 'it')
    # Up to 0.2 of it.
    assert time.process_time() - began < of_many_parts
    assert read_qos(text) == []


def test_the_configuration_of_a_thousand_bearings_is_read() -> None:
    """That of a fleet has 47 parts an asset."""
    names = [f'parameter{k}' for k in range(22)]
    assets = {f'line{k}/pump': dict.fromkeys(names, 1.0) for k in range(1000)}
    assert load_plain(json.dumps(assets), 'it') == assets


def test_the_configuration_of_hundreds_of_bearings_is_read() -> None:
    assets = {f'line{k}/pump': {'bearing': '6307', 'load': 500.0, 'why': 'x' * 800}
              for k in range(359)}  # fmt: skip
    assert load_plain(json.dumps(assets), 'it') == assets


def test_a_recording_with_hostile_qos_is_read_and_recovered(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / 'run.mcap') as writer:
        for number, text in enumerate((MERGES, LISTS, 'x: 2001-99-99', '{[a]: b}')):
            cdr = temperature_cdr(5, 1.0)
            writer.write(f'/t{number}', TEMPERATURE, cdr, log_time=5, qos=text)
    report = recover(tmp_path / 'run.mcap', tmp_path / 'saved')
    assert report.kept == 4
    assert recording_info(tmp_path / 'saved').count == 4
