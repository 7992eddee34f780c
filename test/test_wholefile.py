# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that are there as a whole or not at all."""

import errno
import os
from pathlib import Path

from bearing_twin.errors import BearingTwinError
from bearing_twin.wholefile import given_path, output_file, whole_file
import pytest


@pytest.mark.parametrize('new', [True, False])
def test_two_writers_of_one_name_do_not_mix(tmp_path, new):
    path = tmp_path / 'a'
    first, second = whole_file(path, new=new), whole_file(path, new=new)
    first.__enter__().write(b'first')
    second.__enter__().write(b'second')
    first.__exit__(None, None, None)
    assert path.read_bytes() == b'first'
    if new:
        with pytest.raises(FileExistsError):
            second.__exit__(None, None, None)
    else:
        second.__exit__(None, None, None)
    assert path.read_bytes() == (b'first' if new else b'second')
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_written_is_named(tmp_path, monkeypatch):
    def full(_):
        # As of a disk: it names no file.
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, 'fsync', full)
    for path in tmp_path / 'a.png', tmp_path / 'plots' / 'a.png':
        with (
            pytest.raises(BearingTwinError, match=r'a\.png cannot be written \(No space left'),
            output_file(path, folder=True) as file,
        ):
            file.write(b'picture')
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('name', ['.', '/', '..'])
def test_a_folder_is_no_file_to_write(name):
    with (
        pytest.raises(BearingTwinError, match=r'(is a folder|cannot be written)'),
        output_file(Path(name)),
    ):
        pass


def test_a_home_folder_is_found_and_an_unknown_one_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    assert given_path('~/a') == tmp_path / 'a'
    with pytest.raises(BearingTwinError, match=r'~nobody_9/a: there is no such home folder'):
        given_path('~nobody_9/a')
