# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The Dockerfile does what the README says, and hadolint finds nothing in it."""

from pathlib import Path
import re
import shutil
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[1]
FILE = ROOT / 'Dockerfile'


def test_it_installs_what_the_readme_says():
    readme, text = (path.read_text(encoding='utf-8') for path in (ROOT / 'README.md', FILE))
    wanted = re.search(r'sudo apt-get install (.*)', readme)[1].split()
    installed = re.search(r'--no-install-recommends -y (.*) ', text)[1].split()
    assert set(wanted) <= set(installed)
    assert 'pip install ./msg_defs .' in readme
    assert 'install --no-cache-dir ./msg_defs .' in text
    # What it copies is there, whatever it leaves out.
    left_out = (ROOT / '.dockerignore').read_text().split()
    assert not {'msg_defs', 'setup.py', 'package.xml', 'requirements.txt'} & set(left_out)


def test_hadolint_finds_nothing():
    beside = str(Path(sys.executable).parent)
    hadolint = shutil.which('hadolint') or shutil.which('hadolint', path=beside)
    if hadolint is None:
        pytest.skip('hadolint is not installed (requirements-release.txt)')
    ran = subprocess.run([hadolint, str(FILE)], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout) == (0, '')
