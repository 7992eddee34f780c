# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read channels of TDMS files of National Instruments, by npTDMS (extra ``files``)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.reading import (
    distinct,
    library,
    readable,
    refuse_large,
    TORN,
)
from bearing_twin.recording.signals.timecolumn import is_time, nominal_rate, rate_of_times
import numpy as np

UNITS = ('unit_string', 'NI_UnitDescription', 'unit', 'Unit')
"""Properties of a channel with its unit, the usual one first."""


def read_tdms(path: Path) -> dict[str, Any]:
    """
    Return the channels of a TDMS file by name, and in ``each`` the description of each.

    The sample rate is that of ``wf_increment``, or else of a channel of times in the same group.
    Numbers and texts among the properties of file, group and channel (``rpm``, for instance) are
    the rest of the description.

    Raises
    ------
    BearingTwinError
        If npTDMS is missing, the file is damaged, too large, or has no waveform over time.

    """
    nptdms = library('nptdms', path)
    # Its warnings would print bytes of damaged files.
    nptdms.log.log_manager.set_level('CRITICAL')
    found: dict[str, Any] = {}
    each: dict[str, dict[str, Any]] = {}
    left = []
    # As a file: npTDMS would read the index beside a path, which may be of another file.
    with readable(path, '.tdms', 'is it complete?'), path.open('rb') as opened:
        file = nptdms.TdmsFile.open(opened)
        groups = [(group, channel) for group in file.groups() for channel in group.channels()]
        names = [channel.name for _, channel in groups]
        if len(set(names)) < len(names):
            names = distinct([f'{group.name}/{channel.name}' for group, channel in groups])
        refuse_large(path, sum(len(channel) for _, channel in groups))
        times: dict[str, dict[str, Any]] = {}
        for name, (group, channel) in zip(names, groups, strict=True):
            said = {**file.properties, **group.properties, **channel.properties}
            if not len(channel) or channel.dtype.kind not in 'fiuM':
                left.append(f'{name} has {len(channel)} values of type {channel.dtype}')
            elif said.get('wf_xunit_string') == 'Hz':
                left.append(f'{name} is a spectrum, over Hz')
            elif is_time(channel.name) or channel.dtype.kind == 'M':
                times[group.name] = _rate(channel)
            else:
                found[name] = channel[:]
                each[name] = {'group': group.name, **_described(said)}
        torn = file.file_status.incomplete_final_segment
    for about in each.values():
        # Those of the channel go before those of a channel of times.
        about.update({**times.get(about['group'], {}), **about})
    if not found:
        msg = f'{path} has no waveform over time: {"; ".join(left[:10]) or "it has no channel"}'
        raise BearingTwinError(f'{msg}; export the time record')
    return {**found, 'each': each, 'remark': TORN if torn else ''}


def tdms_start(path: Path) -> float | None:
    """Return the earliest ``wf_start_time`` of a channel, s since 1970; None if none is stated."""
    nptdms = library('nptdms', path)
    with readable(path, '.tdms', 'is it complete?'), path.open('rb') as opened:
        groups = nptdms.TdmsFile.read_metadata(opened).groups()
        said = [
            channel.properties.get('wf_start_time') for g in groups for channel in g.channels()
        ]
    stamps = [v.astype('M8[us]').astype(float) / 1e6 for v in said if isinstance(v, np.datetime64)]
    # One that was never set is the begin of the year 1904.
    return min((stamp for stamp in stamps if stamp > 0.0), default=None)


def _described(said: Mapping[str, Any]) -> dict[str, Any]:
    """Return sample rate, unit, and further numbers and texts of the properties of a channel."""
    plain = {key: np.array(v) for key, v in said.items() if isinstance(v, (int, float, str))}
    step = said.get('wf_increment', 0.0)
    if isinstance(step, float) and step > 0.0:
        plain['fs'] = np.array(nominal_rate(1.0 / step))
    return plain | {'unit': next((plain[key] for key in UNITS if key in plain), np.array(''))}


def _rate(channel: Any) -> dict[str, Any]:
    """Return the sample rate of a channel of times or of dates."""
    times = channel[:]
    if times.dtype.kind == 'M':
        return rate_of_times('time', (times - times[0]) / np.timedelta64(1, 's'))
    return rate_of_times(channel.name, times)
