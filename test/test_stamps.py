# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Stamps and nanoseconds are converted in one module."""

from pathlib import Path
from types import SimpleNamespace

from bearing_twin import stamps
from hypothesis import given
from hypothesis import strategies as st


@given(st.integers(0, stamps.LATEST))
def test_a_stamp_comes_back_as_it_was(ns):
    sec, nanosec = stamps.split_ns(ns)
    assert nanosec < stamps.NANO
    assert sec < 2**31
    assert stamps.stamp_ns(SimpleNamespace(sec=sec, nanosec=nanosec)) == ns


@given(st.integers(-(2**70), 2**70))
def test_a_time_that_no_stamp_carries_becomes_the_nearest(ns):
    sec, nanosec = stamps.split_ns(ns)
    nearest = stamps.stamp_ns(SimpleNamespace(sec=sec, nanosec=nanosec))
    assert nearest == max(0, min(ns, stamps.LATEST))


def test_nobody_else_writes_the_constant_down():
    package = Path(stamps.__file__).parent
    writing = [p for p in package.rglob('*.py') if '1_000_000_000' in p.read_text()]
    assert writing == [Path(stamps.__file__)]
