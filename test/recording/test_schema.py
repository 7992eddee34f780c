# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Schemas and hashes, against those that rosidl generates."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
import sys

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.mcap.schema import (
    canonical_cdr,
    message_schema,
    store_from_text,
)
import pytest
from recording_samples import VIBRATION, vibration_cdr

TYPES = [
    'sensor_msgs/msg/Temperature',
    'sensor_msgs/msg/JointState',
    'sensor_msgs/msg/Imu',
    'diagnostic_msgs/msg/DiagnosticArray',
    'std_msgs/msg/Float64MultiArray',
    'rcl_interfaces/msg/ParameterEvent',
    'lifecycle_msgs/msg/TransitionEvent',
    'geometry_msgs/msg/AccelWithCovarianceStamped',
    'bearing_twin_msgs/msg/Vibration',
    'bearing_twin_msgs/msg/TwinState',
    'bearing_twin_msgs/msg/Diagnosis',
    'bearing_twin_msgs/msg/Spectrum',
    'bearing_twin_msgs/msg/Checkpoint',
]


@pytest.mark.parametrize('type_name', TYPES)
def test_hash_is_that_of_rosidl(type_name: str) -> None:
    package, kind, name = type_name.split('/')
    prefixes = [*os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep), sys.prefix]
    paths = [Path(p) / 'share' / package / kind / f'{name}.json' for p in prefixes if p]
    path = next((p for p in paths if p.exists()), None)
    if path is None:
        pytest.skip(f'{package} is not installed with its type descriptions')
    hashes = {
        entry['type_name']: entry['hash_string']
        for entry in json.loads(path.read_text())['type_hashes']
    }
    assert message_schema(type_name).type_hash == hashes[type_name]


def test_schema_keeps_the_comments_with_the_units() -> None:
    text = message_schema(VIBRATION).text
    assert "unit of x and y: 'm/s^2' (REP 145)" in text
    assert text.count('=' * 80) == 2
    assert 'MSG: builtin_interfaces/Time' in text


def test_schema_without_any_installed_package(monkeypatch: pytest.MonkeyPatch) -> None:
    installed = message_schema('sensor_msgs/msg/Temperature').type_hash
    own = message_schema(VIBRATION).type_hash
    monkeypatch.setenv('AMENT_PREFIX_PATH', '/nowhere')
    monkeypatch.setattr(sys, 'prefix', '/nowhere')
    message_schema.cache_clear()
    try:
        assert message_schema('sensor_msgs/msg/Temperature').type_hash == installed
        assert message_schema(VIBRATION).type_hash == own
    finally:
        message_schema.cache_clear()


@pytest.mark.parametrize(
    'text', ['', 'float64', 'float64 a\nfloat64 a\nnonsense nonsense', 'x/y z', '\x00', 'T[] self']
)
def test_damaged_schemas_are_refused(text: str) -> None:
    if text == '':
        # A message without fields is a legal one.
        store_from_text('a/msg/Empty', text)
        return
    with pytest.raises(BearingTwinError, match='cannot be read'):
        store_from_text('a/msg/T', text)


def test_a_schema_cannot_run_code(tmp_path: Path) -> None:
    target = tmp_path / 'made'
    inject = f"__import__('pathlib').Path({str(target)!r}).touch()"
    for text in (
        f'string X="{inject}"\nfloat64 a\n',
        f"string X='''+{inject}+'''\nfloat64 a\n",
        f'float64 a {inject}\n',
        f'float64 a # \\\n{inject}\n',
        f'int32 X=0);{inject};(\nfloat64 a\n',
    ):
        for name in ('a/msg/T', f'a/msg/T;{inject}', f"a/msg/T'+{inject}+'"):
            with contextlib.suppress(BearingTwinError):
                store_from_text(name, text)
            assert not target.exists()


def test_canonical_bytes_differ_in_padding_only() -> None:
    schema = message_schema(VIBRATION)
    cdr = vibration_cdr(3)
    # Header: 4 + stamp 8 + length 4 + 'sensor\0' 7 = 23; the next float64 stands at 4 + 24.
    dirty = bytearray(cdr)
    assert dirty[23:28] == bytes(5)
    dirty[23:28] = b'dirty'
    assert canonical_cdr(VIBRATION, schema.text, bytes(dirty)) == cdr
    changed = bytearray(cdr)
    changed[28] ^= 1
    assert canonical_cdr(VIBRATION, schema.text, bytes(changed)) != cdr
