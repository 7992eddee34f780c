# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature recordings: the schedule of the paper, and measurements from real machines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.signals.npz import read_npz, temperature_readings
from bearing_twin.recording.topics import TEMPERATURE
from bearing_twin.recording.writer import whole_recording
from bearing_twin.stamps import NANO, split_ns
import numpy as np
from rosbags.typesys import get_typestore, Stores

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


_SHORTEST = 1e-6
"""Shortest time between two readings that can be asked for, s."""
START = 1_577_836_800 * NANO
"""Stamp of undated data, 2020-01-01 00:00 UTC, so that a command always writes the same file."""


def is_undated(start: int) -> bool:
    """
    Return whether a recording that begins at ``start`` (ns) is undated: times count from START.

    Examples
    --------
    >>> is_undated(START), is_undated(START + 3600 * NANO)
    (True, False)

    """
    return START <= start < START + 60 * NANO


def paper_schedule(duration: float = 40.0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Return times (s) and temperatures (degC) of a linear rise from 20 to 110 degC.

    Parameters
    ----------
    duration
        Time from 20 to 110 degC, s.

    Returns
    -------
    times, temperatures
        Ten readings a second, shape ``(round(10 * duration) + 1,)``.

    Raises
    ------
    BearingTwinError
        If there would be fewer than two readings, or more than a million.

    """
    if not 0.1 <= duration <= 1e5:
        msg = f'a schedule of {duration:g} s: give 0.1 to 100000 s'
        raise BearingTwinError(msg)
    times = np.arange(round(duration * 10.0) + 1) / 10.0
    return times, 20.0 + 90.0 * times / times[-1]


def load_trend(
    path: Path, *, until: float | None, every: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Read a measured temperature from an ``.npz`` file with ``temp_t_s`` and ``temp_C``.

    Return times (s from the start) and temperatures (degC) up to ``until`` (s), at most one
    reading per ``every`` (s); with None all readings.

    Raises
    ------
    BearingTwinError
        If the file lacks these arrays, their lengths differ, the times do not rise, or fewer than
        two readings remain.

    """
    arrays = read_npz(path, ('temp_t_s', 'temp_C'))
    missing = {'temp_t_s', 'temp_C'} - arrays.keys()
    if missing:
        msg = f'{path} has no array {" and no ".join(sorted(missing))}; both are needed (s, degC)'
        raise BearingTwinError(msg)
    times, temperatures = temperature_readings(path, arrays)
    if times.size < 2:
        msg = f'{path}: temp_t_s has {times.size} values; at least two are needed'
        raise BearingTwinError(msg)
    if not np.all(np.isfinite(times)) or np.any(np.diff(times) < 0):
        msg = f'{path}: temp_t_s does not rise'
        raise BearingTwinError(msg)
    times = times - times[0]
    taken = np.ones(times.size, dtype=bool) if until is None else times <= until
    if every is not None:
        if not every >= _SHORTEST:
            msg = f'every={every} s: give {_SHORTEST:g} s or more'
            raise BearingTwinError(msg)
        taken &= np.diff(np.floor(times / every), prepend=-1.0) > 0.0
    if np.count_nonzero(taken) < 2:
        msg = f'{path}: fewer than two readings with {until=} s and {every=} s; take more'
        raise BearingTwinError(msg)
    return times[taken], temperatures[taken]


def write_temperature_recording(
    path: Path,
    times: NDArray[np.float64],
    temperatures: NDArray[np.float64],
    *,
    source: str,
    topic: str = '/temperature',
) -> None:
    """
    Write times (s from the start) and temperatures (degC) as ``sensor_msgs/Temperature``.

    Raises
    ------
    BearingTwinError
        If the path exists or cannot be written.

    """
    store = get_typestore(Stores.ROS2_KILTED)
    temperature, header, time = (
        store.types[name]
        for name in (TEMPERATURE, 'std_msgs/msg/Header', 'builtin_interfaces/msg/Time')
    )
    qos = sensor_qos()
    with whole_recording(path) as writer:
        writer.metadata('bearing_twin.source', {'source': source, 'unit': 'degC'})
        for second, value in zip(times, temperatures, strict=True):
            ns = START + round(float(second) * NANO)
            sec, nanosec = split_ns(ns)
            message = temperature(
                header=header(stamp=time(sec=sec, nanosec=nanosec), frame_id='bearing_housing'),
                temperature=float(value),
                variance=0.0,
            )
            cdr = bytes(store.serialize_cdr(message, TEMPERATURE))
            writer.write(topic, TEMPERATURE, cdr, log_time=ns, publish_time=ns, qos=qos)
