# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature recordings, and the schedule of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.topics import TEMPERATURE
from bearing_twin.recording.writer import whole_recording
from bearing_twin.stamps import NANO, split_ns
import numpy as np
from rosbags.typesys import get_typestore, Stores

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


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
        raise BearingTwinError(f'a schedule of {duration:g} s: give 0.1 to 100000 s')
    times = np.arange(round(duration * 10.0) + 1) / 10.0
    return times, 20.0 + 90.0 * times / times[-1]


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
