# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Adapter node: an accelerometer in another message type to vibration blocks."""

from __future__ import annotations

from collections.abc import Mapping
import math
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.messages import floats, message_header
from bearing_twin.assets.parameters.shared import HARDWARE_ID
from bearing_twin.assets.parameters.spec import fixed
from bearing_twin.errors import BearingTwinError
from bearing_twin.repeats import RepeatCheck, REPEATED
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import ManagedNode
from bearing_twin.ros.topics.qos import advertise, SENSOR, STREAM
from bearing_twin.ros.topics.subscribing import subscribe, with_mismatch_reasons
from bearing_twin.stamps import NANO, samples_ns, stamp_ns
from bearing_twin.streams.samplerate import RateMeter, REFUSED
from bearing_twin.streams.sampling import (
    BlockBuilder,
    SequenceTracker,
    split_channels,
    StampTracker,
)
from bearing_twin.streams.vibration_input import (
    Intake,
    SEVERAL_SOURCES,
    SILENT_AFTER,
)
from bearing_twin_msgs.msg import Vibration
import numpy as np
from sensor_msgs.msg import Imu
from std_msgs.msg import Float32MultiArray, Float64MultiArray, Int16MultiArray, Int32MultiArray

if TYPE_CHECKING:
    from bearing_twin.streams.sampling import SampledBlock
    from rclpy.subscription import MessageInfo
    from std_msgs.msg import MultiArrayLayout


SHOWN = 10.0
"""Time for which NaN samples, and stamps that were too near to each other, are reported, s."""
ARRAYS = {
    'float32_multi_array': Float32MultiArray,
    'float64_multi_array': Float64MultiArray,
    'int16_multi_array': Int16MultiArray,
    'int32_multi_array': Int32MultiArray,
}
"""Message types with a block of samples, by source."""
IMU = 'imu'
REMEDIES = {
    f'std_msgs/msg/{kind.__name__}': f'set source to {source}' for source, kind in ARRAYS.items()
}
"""What to do if another type is published, by type."""

SPECS = (
    fixed('source', 'float32_multi_array',
          'Message type of the accelerometer; topic samples, or imu.', choices=(*ARRAYS, IMU)),
    fixed('sample_rate', 0.0, 'Sample rate; 0: estimated from the stamps (imu only).',
          'Hz', 0.0, 1_000_000.0),
    fixed('channels', 1, 'Channels in one array.', '', 1, 16),
    fixed('interleaved', True, 'Whether the array holds a sample of every channel first, then the '
          'next.'),
    fixed('channel_x', -1, 'Channel that becomes x; of an imu 0, 1, 2 are x, y, z; -1: none.',
          '', -1, 15),
    fixed('channel_y', 0, 'Channel that becomes y, which the diagnosis uses first; -1: none.',
          '', -1, 15),
    fixed('scale', 1.0, 'Factor from the values received to unit, e.g. 9.81 from V of a 1 V/g '
          'sensor.', '', -1e6, 1e6),
    fixed('unit', 'm/s^2', 'Unit of the samples published.', choices=('m/s^2', 'g')),
    fixed('block_size', 1024, 'Samples per published block.', '', 64, 65536),
    fixed('frame_id', '', "Frame of the sensor; '' for that of the message received, or the name "
          'of its topic where it has none.'),
    HARDWARE_ID,
)  # fmt: skip


class AdapterNode(ManagedNode):
    """
    Convert samples from other drivers to vibration blocks for the diagnosis.

    ``std_msgs/Float32MultiArray``, or an array of another type of numbers, holds many samples and
    no stamp; the time of publishing is used as the time of the last sample. Gaps are detected by
    the message numbers of the middleware, and by pauses of more than 2 s; samples that the driver
    omits for a shorter time are not noticed.
    Pauses longer than the messages, such as those between snapshots, are not used to measure the
    sample rate. ``sensor_msgs/Imu`` holds one sample; time and gaps come from its stamps.
    In simulated time, messages without a stamp are ignored before the first ``/clock``.
    """

    def __init__(self) -> None:
        super().__init__('adapter', SPECS)

    def check(self, values: Mapping[str, Any]) -> None:
        """
        Refuse parameters that contradict each other.

        Raises
        ------
        BearingTwinError
            If no channel is chosen, a chosen one does not exist, the sample rate is missing, or
            the scale is 0.

        """
        count = 3 if values['source'] == IMU else values['channels']
        chosen = (values['channel_x'], values['channel_y'])
        if max(chosen) < 0:
            raise BearingTwinError('channel_x and channel_y are both -1: choose at least one')
        if max(chosen) >= count:
            raise BearingTwinError(
                f'channel {max(chosen)} does not exist: {values["source"]} has {count}, from 0 on'
            )
        if values['source'] != IMU and not values['sample_rate']:
            msg = f'sample_rate=0: a {values["source"]} does not tell its rate; set it in Hz'
            raise BearingTwinError(msg)
        if values['scale'] == 0.0:
            msg = 'scale=0 would silence the sensor; give the factor from its values to unit'
            raise BearingTwinError(msg)

    def setup(self) -> None:
        """Create the publisher and the status."""
        p = self.parameters
        self._intake, self._repeat = Intake(), RepeatCheck()
        self._sequence = SequenceTracker()
        self._stamps = StampTracker(p['sample_rate'])
        self._builder = BlockBuilder(p['block_size'])
        self._meter = RateMeter()
        self._heard = self._sent = 0
        self._source: object = None
        self._name = IMU if p['source'] == IMU else 'samples'
        self._topic = self.resolve_topic_name(self._name).removeprefix('/')
        self._frame = p['frame_id'] or self._topic
        self._lost = 0
        self._restarts = 0
        self._untimed = 0
        self._unusable = 0
        self._crowded = self._spoilt = self._empty = math.nan
        self._until = 0
        self._vibration = advertise(self, Vibration, 'vibration', STREAM)
        self.health = Health(self, p['hardware_id'] or self.get_namespace())
        self.health.add('accelerometer input', self._input_status)

    def start(self) -> None:
        """Subscribe to the accelerometer."""
        kind = ARRAYS.get(self.parameters['source'], Imu)
        take = self._on_imu if kind is Imu else self._on_array
        self._input = subscribe(self, kind, self._name, take, SENSOR, refused=self._refuse)
        self.get_logger().info(f'listening to {self._input.topic_name}')

    def _on_array(self, message: Any, info: MessageInfo) -> None:
        former = self._intake.arrived
        if not self._accept(info):
            return
        p = self.parameters
        rate = p['sample_rate']
        try:
            check_layout(
                message.layout, len(message.data), p['channels'], interleaved=p['interleaved']
            )
            samples = split_channels(
                np.asarray(message.data), p['channels'], interleaved=p['interleaved']
            )
        except BearingTwinError as error:
            self._refuse(str(error))
            return
        count = samples.shape[1]
        if not count:
            # No sample has arrived. The message still has its number.
            self._empty, self._intake.arrived = self._intake.arrived, former
            self._sequence.missing(info.get('publisher_gid'), info['publication_sequence_number'])
            return
        published = self._published(info)
        if not published:
            self._untimed += count
            return
        elapsed, length = (published - self._until) / NANO, count / rate
        again = self._repeat.repeats(samples)
        if again:
            self._refuse(REPEATED)
            if elapsed > 0.75 * length:
                # The driver hangs: the samples are missing in the index of the next block. One
                # that is asked twice a block repeats each after half of its length.
                return
        missing = self._sequence.missing(
            info.get('publisher_gid'), info['publication_sequence_number']
        )
        if again:
            return
        if missing:
            self._gap(missing * count)
        elif self._until and elapsed > length + SILENT_AFTER:
            # The driver was silent; the number of missing samples is unknown.
            self._gap(-1)
            if elapsed > 2.0 * length + SILENT_AFTER:
                # Shorter pauses count in the measured rate: long messages with a wrong
                # sample_rate cause them.
                self._meter = RateMeter()
        self._intake.use(length)
        self._until = published
        self._measure(count * (1 + max(0, missing)), published)
        stamp = published - samples_ns(count, rate)
        self._publish(self._builder.push(samples, stamp=stamp, rate=rate), rate)

    def _on_imu(self, message: Imu, info: MessageInfo) -> None:
        if not self._accept(info):
            return
        if message.linear_acceleration_covariance[0] == -1.0:
            # sensor_msgs/Imu: 'if your sensor doesn't produce an estimate for one of the data'.
            self._refuse('the Imu says that it measures no acceleration (covariance -1)')
            return
        self._frame = self.parameters['frame_id'] or message.header.frame_id or self._topic
        stamp = stamp_ns(message.header.stamp) or self._published(info)
        if not stamp:
            self._untimed += 1
            return
        former, self._source = self._source, info.get('publisher_gid')
        if former not in (None, self._source):
            self._begin_anew()
        self._measure(1, stamp)
        missing = self._stamps.missing(stamp)
        rate = self._stamps.rate
        if not rate:
            return
        if missing and not self.parameters['sample_rate'] and self._runs_at_another_rate():
            self._begin_anew()
            return
        if missing:
            self._gap(missing)
        if self._stamps.crowded:
            self._crowded = self._intake.arrived
        acceleration = message.linear_acceleration
        axes = acceleration.x, acceleration.y, acceleration.z
        sample = split_channels(np.array(axes), len(axes), interleaved=True)
        self._publish(self._builder.push(sample, stamp=stamp, rate=rate), rate)

    def _accept(self, info: MessageInfo) -> bool:
        """Return whether a message of this publisher is to be used."""
        self._intake.arrived = time.monotonic()
        return self._intake.sources.accept(info.get('publisher_gid'), self._intake.arrived)

    def _published(self, info: MessageInfo) -> int:
        """Return the time of publishing of a message without a stamp, ns; 0 if unknown."""
        simulated = self.get_parameter('use_sim_time').value
        known = 0 if simulated else info['source_timestamp']
        return int(known or self.get_clock().now().nanoseconds)

    def _measure(self, count: int, stamp: int) -> None:
        """Add ``count`` samples to the measured rate; ``stamp`` (ns) is that of the last one."""
        self._heard += count
        self._meter.take(self._heard, stamp)

    def _begin_anew(self) -> None:
        """Restart the estimate of the sample rate, after a change of the source or its rate."""
        if not self.parameters['sample_rate']:
            self._gap(-1)
            self._stamps.restart()
            self._meter = RateMeter()

    def _runs_at_another_rate(self) -> bool:
        """Return whether the source has another rate than expected, and not because of losses."""
        rate = self._stamps.rate
        wrong = self._meter.problem(rate)
        if wrong is None or not wrong.refused:
            return False
        # The usual rate is NaN if no steps are known; that counts as another rate.
        return self._meter.rate > rate or not abs(self._stamps.usual_rate / rate - 1.0) <= REFUSED

    def _gap(self, missing: int) -> None:
        self._lost += max(0, missing)
        self._restarts += missing < 0
        self._publish(self._builder.gap(missing), self._stamps.rate)

    def _publish(self, blocks: list[SampledBlock], rate: float) -> None:
        p = self.parameters
        for block in blocks:
            self._sent += block.samples.shape[1]
            with np.errstate(over='ignore'):
                # What becomes infinite is counted below.
                values = block.samples * np.float32(p['scale'])
            channels = p['channel_x'], p['channel_y']
            chosen = values[[c for c in channels if c >= 0]]
            if unusable := int((~np.isfinite(chosen)).any(axis=0).sum()):
                self._unusable += unusable
                self._spoilt = self._intake.arrived
            x, y = (values[c] if c >= 0 else values[0, :0] for c in channels)
            self._vibration.publish(
                Vibration(
                    header=message_header(block.stamp, self._frame),
                    sample_rate=rate,
                    first_sample=block.first_sample,
                    source=Vibration.SOURCE_MEASURED,
                    unit=p['unit'],
                    shaft_hz=math.nan,
                    x=floats(x),
                    y=floats(y),
                )
            )

    def _refuse(self, problem: str) -> None:
        self._intake.arrived = time.monotonic()
        self._intake.refuse(problem)
        self.get_logger().warning(f'message refused: {problem}', throttle_duration_sec=10.0)

    def _input_status(self) -> Status:
        level, message = self._input_level()
        return Status(
            level,
            message,
            {
                'age_s': time.monotonic() - self._intake.arrived,
                'sample_rate_hz': self._stamps.rate,
                'sample_rate_measured_hz': self._meter.rate,
                'samples_published': self._sent,
                'samples_lost': self._lost,
                'samples_not_finite': self._unusable,
                'samples_before_clock': self._untimed,
                'source_restarts': self._restarts,
                'messages_refused': self._intake.refused,
                'messages_of_other_sources': self._intake.sources.ignored,
            },
        )

    def _input_level(self) -> tuple[Level, str]:
        """Return level and message of the input: those of the first problem, if any."""
        now, rate, intake = time.monotonic(), self._stamps.rate, self._intake
        age = now - intake.arrived
        empty = ''
        if now - self._empty <= SILENT_AFTER:
            empty = ': the arrays received are empty, check sensor and driver'
        if math.isnan(age):
            text = 'no samples yet'
            if self.active:
                text = with_mismatch_reasons(self, self._input, text, REMEDIES)
            return Level.STALE, f'{text}{empty}'
        if age > intake.silent_after:
            return Level.STALE, f'no samples for {age:.1f} s{empty}'
        if trouble := intake.trouble(now):
            return Level.ERROR, f'message refused: {trouble}'
        if intake.sources.contested(now):
            return Level.ERROR, SEVERAL_SOURCES
        if self._untimed and not self._builder.next_sample:
            return (
                Level.WARN,
                'samples without a stamp, and no /clock yet (use_sim_time): left out',
            )
        if not rate:
            return Level.WARN, 'estimating the sample rate'
        if wrong := self._meter.problem(rate):
            if wrong.refused and not self._runs_at_another_rate():
                return Level.ERROR, (
                    f'{self._meter.rate:.5g} of {rate:.5g} samples a second arrive, others are '
                    'lost'
                )
            return Level.ERROR if wrong.refused else Level.WARN, wrong.text
        if intake.arrived - self._spoilt < SHOWN:
            return Level.WARN, (
                f'{self._unusable} samples are NaN or infinite, which gives no verdict: check '
                'sensor and driver'
            )
        if intake.arrived - self._crowded < SHOWN:
            return Level.WARN, (
                'stamps are late and then too near to each other, so that samples count as lost: '
                'stamp them where the sensor is read, or send blocks in an array'
            )
        return Level.OK, 'samples are fresh'


def check_layout(
    layout: MultiArrayLayout, values: int, channels: int, *, interleaved: bool
) -> None:
    """
    Refuse an array whose layout contradicts its data or the parameters; it may be empty.

    Parameters
    ----------
    layout
        Layout of the message.
    values
        Number of values in the message.
    channels, interleaved
        Parameters of the node.

    Raises
    ------
    BearingTwinError
        If the dimensions are not as many values as there are, or not the samples and channels of
        the parameters, or if there is a data offset.

    """
    if layout.data_offset:
        msg = f'data_offset={layout.data_offset}: arrays whose data begin at 0 are taken'
        raise BearingTwinError(msg)
    sizes = [each.size for each in layout.dim]
    told = ' x '.join(map(str, sizes))
    if sizes and math.prod(sizes) != values:
        msg = f'the message says {told} values and has {values}: correct its layout, or omit it'
        raise BearingTwinError(msg)
    if len(sizes) > 1 and sizes[-1 if interleaved else 0] != channels:
        if sizes[0 if interleaved else -1] == channels > 1:
            remedy = f'interleaved to {str(not interleaved).lower()}'
        else:
            remedy = f'channels to {sizes[-1 if interleaved else 0]}'
        raise BearingTwinError(f'the message says {told}, not {channels} channels: set {remedy}')


NODE = AdapterNode
