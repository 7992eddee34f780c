# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the adapter node."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.assets.shared_specs import HARDWARE_ID
from bearing_twin.assets.spec import Spec
from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ['ARRAY', 'IMU', 'SPECS', 'check_adapter']

ARRAY = 'float32_multi_array'
IMU = 'imu'

SPECS = (
    Spec(
        name='source',
        default=ARRAY,
        description='Message type of the accelerometer; topic samples, or imu.',
        choices=(ARRAY, IMU),
        running=False,
    ),
    Spec(
        name='sample_rate',
        default=0.0,
        description='Sample rate; 0: estimated from the stamps (imu only).',
        unit='Hz',
        low=0.0,
        high=1_000_000.0,
        running=False,
    ),
    Spec(
        name='channels',
        default=1,
        description='Channels in one Float32MultiArray.',
        low=1,
        high=16,
        running=False,
    ),
    Spec(
        name='interleaved',
        default=True,
        description='Whether the array holds a sample of every channel first, then the next.',
        running=False,
    ),
    Spec(
        name='channel_x',
        default=-1,
        description='Channel that becomes x; of an imu 0, 1, 2 are x, y, z; -1: none.',
        low=-1,
        high=15,
        running=False,
    ),
    Spec(
        name='channel_y',
        default=0,
        description='Channel that becomes y, which the diagnosis uses first; -1: none.',
        low=-1,
        high=15,
        running=False,
    ),
    Spec(
        name='scale',
        default=1.0,
        description='Factor from the values received to unit, e.g. 9.81 from V of a 1 V/g sensor.',
        low=-1e6,
        high=1e6,
        running=False,
    ),
    Spec(
        name='unit',
        default='m/s^2',
        description='Unit of the samples published.',
        choices=('m/s^2', 'g'),
        running=False,
    ),
    Spec(
        name='block_size',
        default=1024,
        description='Samples per published block.',
        low=64,
        high=65536,
        running=False,
    ),
    Spec(
        name='frame_id',
        default='',
        description="Frame of the sensor; '' for that of the message received.",
        running=False,
    ),
    HARDWARE_ID,
)


def check_adapter(values: Mapping[str, Any]) -> None:
    """
    Refuse parameters that do not fit together.

    Raises
    ------
    BearingTwinError
        If no channel is chosen, a chosen one does not exist, or a sample rate is missing.

    """
    count = 3 if values['source'] == IMU else values['channels']
    chosen = (values['channel_x'], values['channel_y'])
    if max(chosen) < 0:
        msg = 'channel_x and channel_y are both -1: choose at least one'
        raise BearingTwinError(msg)
    if max(chosen) >= count:
        msg = f'channel {max(chosen)} does not exist: {values["source"]} has {count}, from 0 on'
        raise BearingTwinError(msg)
    if values['source'] == ARRAY and not values['sample_rate']:
        msg = 'sample_rate=0: a Float32MultiArray does not tell its rate; set it in Hz'
        raise BearingTwinError(msg)
    if values['scale'] == 0.0:
        msg = 'scale=0 would silence the sensor; give the factor from its values to unit'
        raise BearingTwinError(msg)
