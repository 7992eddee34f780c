# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin play``: publish a vibration file as a sensor would, in real time."""

from __future__ import annotations

import argparse
from collections.abc import Callable
import contextlib
from dataclasses import dataclass
from functools import partial
import math
from pathlib import Path
import time
from typing import Any, TYPE_CHECKING

from bearing_twin.cli.arguments import refuse_topic
from bearing_twin.cli.signal_arguments import UNITS
from bearing_twin.errors import BearingTwinError, UsageError
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.stamps import samples_ns
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.recording.signals.signalfile import Signal
    from rclpy.publisher import Publisher


TOPICS = {'float32_multi_array': 'samples', 'imu': 'imu', 'vibration': 'vibration'}
"""Message types, and the topics on which adapter and diagnosis listen to them."""
SINGLE_PERIOD = 0.01
"""Messages of one sample each are sent together at this period, s."""
LISTENER_WAIT = 3.0
"""Time after which a missing subscriber is reported, s."""
LONGEST_ACK = 10.0
"""Longest wait at the end for subscribers that have not taken the last samples, s."""
LONGEST_SLEEP = 0.5


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('file', type=Path, help='a file as diagnose reads')
    parser.add_argument(
        '--channel', metavar='NAME', help='name, number or topic, or any part that only one has'
    )
    parser.add_argument(
        '--as',
        dest='kind',
        choices=TOPICS,
        default='float32_multi_array',
        help='message type (default float32_multi_array): blocks without a stamp, one sample a '
        'message (in x), or blocks as the diagnosis takes them',
    )
    parser.add_argument(
        '--rate', '--sample-rate', type=float, metavar='HZ', help='sample rate, if not in the file'
    )
    parser.add_argument('--topic', help='default: samples, imu or vibration')
    parser.add_argument('--loop', action='store_true', help='start again at the end')
    parser.add_argument(
        '--speed', type=float, default=1.0, help='signal seconds a second (default 1)'
    )
    parser.add_argument(
        '--block', type=int, default=1024, metavar='N', help='samples a message (default 1024)'
    )
    parser.add_argument('--unit', choices=UNITS, help='unit of the vibration, if not in the file')
    parser.add_argument('--frame-id', default='accelerometer', help='default accelerometer')


def run(args: argparse.Namespace) -> int:
    """Play as soon as there is a subscriber; return 0 at the end of the file or of a loop."""
    if not (0.0 < args.speed <= 1000.0 and 1 <= args.block <= 65536):
        raise UsageError(
            f'--speed {args.speed:g} --block {args.block}: give a speed above 0, up to 1000, and '
            'a block of 1 to 65536 samples'
        )
    if args.kind == 'float32_multi_array' and args.speed != 1.0:
        raise UsageError(
            'a Float32MultiArray has no stamp, so that its sample rate is that of its arrival: '
            '--speed needs --as imu or --as vibration'
        )
    refuse_topic(args.topic or TOPICS[args.kind])
    signal = read_signal(args.file, channel=args.channel, sample_rate=args.rate)
    try:
        return _play(signal, args)
    except KeyboardInterrupt:
        return 0 if args.loop else 130


def _play(signal: Signal, args: argparse.Namespace) -> int:
    from bearing_twin.ros.processes.domain import initialise
    from bearing_twin.ros.processes.launching import ensure_log_folder
    from bearing_twin.ros.topics.qos import own, STREAM
    import rclpy
    from rclpy.duration import Duration

    ensure_log_folder()
    initialise([])
    try:
        node = rclpy.create_node('play', enable_rosout=False, start_parameter_services=False)
        source = _source(signal, args)
        topic = args.topic or TOPICS[args.kind]
        qos = own(STREAM)
        if args.kind == 'imu':
            # One second; a queue of blocks is at least as long.
            qos.depth = math.ceil(signal.sample_rate)
        publisher: Publisher[Any] = node.create_publisher(source.type, topic, qos)
        said = time.monotonic() + LISTENER_WAIT
        while not publisher.get_subscription_count() and rclpy.ok():
            if time.monotonic() > said:
                print(f'waiting: {publisher.topic_name} has no subscriber yet', flush=True)
                said = math.inf
            time.sleep(0.02)
        rounds = ', again and again until Ctrl-C' if args.loop else ''
        print(
            f'{signal.source}: {len(signal.x) / signal.sample_rate:.4g} s at '
            f'{signal.sample_rate:g} Hz to {publisher.topic_name}{rounds}',
            flush=True,
        )
        source.send(publisher.publish, rclpy.ok)
        if rclpy.ok():
            publisher.wait_for_all_acked(Duration(seconds=LONGEST_ACK))
        return 0 if args.loop or source.finished else 143
    except RuntimeError as error:
        # An RCLError.
        if rclpy.ok():
            raise BearingTwinError(str(error)) from None
        # SIGTERM has ended the context while it was in use.
        return 0 if args.loop else 143
    finally:
        # A signal may end the context at the same time, in a thread of rclpy.
        with contextlib.suppress(RuntimeError):
            rclpy.try_shutdown()


@dataclass
class _Source:
    """A signal that is sent in pieces, each when its last sample would have been taken."""

    signal: Signal
    type: type
    """Type of the messages."""
    messages: Callable[[int, int, np.ndarray[Any, Any]], list[Any]]
    """Return the messages of samples, from their first index, time in ns, and values."""
    size: int
    """Samples per piece."""
    speed: float
    loop: bool
    finished: bool = False

    def send(self, publish: Callable[[Any], None], wanted: Callable[[], bool]) -> None:
        """Send all pieces, or stop when ``wanted`` returns False."""
        x = self.signal.x.astype(np.float32)
        rate, at = self.signal.sample_rate, 0
        began, epoch = time.monotonic(), time.time_ns()
        while self.loop or at < len(x):
            stop = at + self.size if self.loop else min(at + self.size, len(x))
            due = began + stop / (rate * self.speed)
            while (left := due - time.monotonic()) > 0.0:
                time.sleep(min(left, LONGEST_SLEEP))
                if not wanted():
                    return
            samples = x.take(range(at, stop), mode='wrap')
            for message in self.messages(at, epoch + samples_ns(at, rate), samples):
                publish(message)
            at = stop
        self.finished = True


def _source(signal: Signal, args: argparse.Namespace) -> _Source:
    """Return the signal as messages of the requested type."""
    from bearing_twin.assets.messages import floats, message_header
    from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
    from bearing_twin_msgs.msg import Vibration
    from sensor_msgs.msg import Imu
    from std_msgs.msg import Float32MultiArray

    def arrays(_at: int, _stamp: int, samples: np.ndarray[Any, Any]) -> list[Any]:
        return [Float32MultiArray(data=floats(samples))]

    def imus(_at: int, stamp: int, samples: np.ndarray[Any, Any]) -> list[Any]:
        found = []
        for k, sample in enumerate((factor * samples).tolist()):
            time_ns = stamp + samples_ns(k, signal.sample_rate)
            message = Imu(header=message_header(time_ns, args.frame_id))
            message.linear_acceleration.x = sample
            found.append(message)
        return found

    def blocks(at: int, stamp: int, samples: np.ndarray[Any, Any]) -> list[Any]:
        speeds = signal.speeds if len(signal.speeds) else np.array([signal.shaft_hz])
        speed = speeds.take(range(at, at + len(samples)), mode='wrap').mean()
        return [
            Vibration(
                header=message_header(stamp, args.frame_id),
                sample_rate=signal.sample_rate,
                first_sample=at,
                source=Vibration.SOURCE_MEASURED,
                unit=args.unit or signal.unit,
                shaft_hz=float(speed),
                y=floats(samples),
            )
        ]

    # An Imu is in m/s^2; a signal without a unit is assumed to be so.
    unit = args.unit or signal.unit or 'm/s^2'
    factor = acceleration_factor(unit)
    if args.kind == 'imu' and not math.isfinite(factor):
        msg = f'{signal.source} is in {unit}, an Imu in m/s^2: say --unit, or --as vibration'
        raise BearingTwinError(msg)
    of = partial(_Source, signal, speed=args.speed, loop=args.loop)
    if args.kind == 'imu':
        return of(Imu, imus, size=math.ceil(SINGLE_PERIOD * signal.sample_rate))
    if args.kind == 'vibration':
        return of(Vibration, blocks, size=args.block)
    return of(Float32MultiArray, arrays, size=args.block)
