# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
A probe that talks to real nodes over DDS as anybody would.

A machine that is busy with something else may hold up any process at any point. So a test waits
for what it means instead of for a time, simulated time goes on when the nodes have followed it,
what must not be lost on the way is sent reliably through queues that hold all of it, and blocks
that a twin gives up because it comes too late are counted instead of forbidden.
"""

from __future__ import annotations

from itertools import pairwise
import time
from typing import NamedTuple

TIMEOUT = 300.0
"""After it a test gives up; no bound on how long anything may take, s."""


KEPT = 1000
DEEP = {f'qos_overrides./{topic}.publisher.depth': KEPT for topic in ('vibration', 'twin_state')}
"""Parameters of a twin whose queues keep what a test that is held up takes late."""


class Status(NamedTuple):
    """What a part of a node has reported."""

    level: bytes
    message: str
    values: dict[str, str]


class Probe:
    """A node of the test: collects messages, publishes, calls services, sets parameters."""

    def __init__(self, domain=None):
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.context = rclpy.Context()
        self.context.init(domain_id=domain)
        self.node = rclpy.create_node('probe', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.statuses = {}
        self.clocks = {}
        self._publishers = {}
        self._clients = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.shutdown()

    def collect(self, kind, topic, depth=1000):
        """Return a list that fills with the messages of a topic."""
        messages = []
        self.node.create_subscription(kind, topic, messages.append, depth)
        return messages

    def watch_diagnostics(self):
        """Keep the latest status of every part in ``statuses``, each node's time in ``clocks``."""
        from diagnostic_msgs.msg import DiagnosticArray

        def keep(array):
            for status in array.status:
                values = {item.key: item.value for item in status.values}
                self.statuses[status.name] = Status(status.level, status.message, values)
                stamp = array.header.stamp
                self.clocks[status.name.split(':')[0]] = stamp.sec + stamp.nanosec * 1e-9

        self.node.create_subscription(DiagnosticArray, '/diagnostics', keep, 100)

    def status(self, name):
        """Return level, message and values of a part as it reported last; empty before that."""
        return self.statuses.get(name, Status(b'', '', {}))

    def publish(self, topic, message, depth=100):
        """
        Publish on a topic, after the first subscriber is there.

        Others may be found later, and one that listens by best effort may not have found the probe
        yet: what they have to hear is sent until they have shown that they have.
        """
        if topic not in self._publishers:
            publisher = self.node.create_publisher(type(message), topic, depth)
            self._publishers[topic] = publisher
            self.until(publisher.get_subscription_count, f'a subscriber of {topic}')
        self._publishers[topic].publish(message)

    def spin(self, seconds):
        """Let messages in for a while."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.executor.spin_once(timeout_sec=left)

    def until(self, happened, what, timeout=TIMEOUT, every=None):
        """Let messages in until something has happened; return what it gave."""
        end = time.monotonic() + timeout
        while not (result := happened()):
            assert time.monotonic() < end, f'{what} did not come within {timeout} s'
            if every is not None:
                every()
            self.executor.spin_once(timeout_sec=0.05)
        return result

    def call(self, kind, name, **fields):
        """
        Call a service and return its response; what only reads is asked again each ten seconds.

        Fast DDS drops a response whose reader the node has not yet discovered.
        """
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, name)
        client = self._clients[name]
        self.until(client.service_is_ready, f'service {name}')
        futures, begun = [], time.monotonic()

        def answer():
            waited = time.monotonic() - begun
            if not futures or (kind.__name__.startswith('Get') and waited > 10 * len(futures)):
                futures.append(client.call_async(kind.Request(**fields)))
            return next((future for future in futures if future.done()), None)

        return self.until(answer, f'the answer of {name}').result()

    def run_clock(self, begin, end, streams, each=lambda: None):
        """
        Publish /clock from ``begin`` to ``end`` (s) in steps of 10 ms, ``each`` after every one.

        ``streams`` holds for each node the list of its blocks. Time begins when all know of it,
        and goes on when they have sent the blocks of all but the last 0.15 s: a timer may lie
        0.04 s behind the clock, and a fleet spreads what it sends over as much.
        """
        from builtin_interfaces.msg import Time
        from rosgraph_msgs.msg import Clock

        def tell(tick):
            reading = Time(sec=tick // 100, nanosec=tick % 100 * 10**7)
            self.publish('/clock', Clock(clock=reading))

        def followed(now):
            return now < begin + 0.2 or all(
                blocks and abs(now - block_end(blocks[-1])) < 0.15 for blocks in streams.values()
            )

        first, last = round(begin * 100), round(end * 100)
        # Nobody asks for a lost /clock again: it is told until it is heard.
        self.until(
            lambda: all(self.clocks.get(node) == begin for node in streams),
            f'the clock of {begin} s',
            every=lambda: tell(first),
        )
        for tick in range(first, last + 1):
            tell(tick)
            each()
            self.until(
                lambda now=tick / 100: followed(now),
                f'the blocks until {tick / 100} s',
                every=lambda tick=tick: tell(tick),
            )

    def until_still(self, node):
        """Wait until a node says that its clock stands still, and what it sent before is in."""
        name = f'{node}: real time'
        for _ in range(2):
            # It stood still, too, while it waited for a node that was held up.
            self.statuses.pop(name, None)
            self.until(lambda: 'stands still' in self.status(name)[1], 'the standing clock')
        self.spin(0.5)

    def set_parameters(self, node, **values):
        """Set parameters as one change; return (accepted, reason)."""
        from rcl_interfaces.srv import SetParametersAtomically
        from rclpy.parameter import Parameter

        answer = self.call(
            SetParametersAtomically,
            f'{node}/set_parameters_atomically',
            parameters=[Parameter(k, value=v).to_parameter_msg() for k, v in values.items()],
        )
        return answer.result.successful, answer.result.reason

    def get_parameters(self, node, *names):
        """Return the values of parameters."""
        from rcl_interfaces.srv import GetParameters
        from rclpy.parameter import parameter_value_to_python

        answer = self.call(GetParameters, f'{node}/get_parameters', names=list(names))
        return [parameter_value_to_python(value) for value in answer.values]

    def change_state(self, node, transition):
        """Trigger a lifecycle transition by its label; return whether it succeeded."""
        from lifecycle_msgs.msg import Transition
        from lifecycle_msgs.srv import ChangeState

        return self.call(
            ChangeState, f'{node}/change_state', transition=Transition(label=transition)
        ).success

    def state(self, node):
        """Return the label of the lifecycle state."""
        from lifecycle_msgs.srv import GetState

        return self.call(GetState, f'{node}/get_state').current_state.label

    def until_active(self, node):
        """Wait until a node works: it is seen, and has a status, while it still compiles."""
        self.until(lambda: self.state(node) == 'active', f'{node} at work')


def check_complete(states, blocks, every=1):
    """
    Check that each block published has come, and that the twin counts those it gave up.

    Of each ``every`` blocks at least one has its state.
    """
    for state in states:
        count = state.blocks_published + state.blocks_dropped
        assert state.first_sample == (count - 1) * state.sample_count
    assert all(1 <= b.blocks_published - a.blocks_published <= every for a, b in pairwise(states))
    begin = max(states[0].first_sample, blocks[0].first_sample)
    end = min(states[-1].first_sample, blocks[-1].first_sample)
    of_states, of_blocks = (
        [m.first_sample for m in messages if begin <= m.first_sample <= end]
        for messages in (states, blocks)
    )
    assert of_states == of_blocks if every == 1 else set(of_states) < set(of_blocks)
    counted = {s.first_sample: s.blocks_published for s in states}
    numbers = [(k, counted[first]) for k, first in enumerate(of_blocks) if first in counted]
    assert all(number - k == numbers[0][1] for k, number in numbers)


def block_end(block):
    """Return the time after the last sample of a block, s."""
    stamp = block.header.stamp
    return stamp.sec + stamp.nanosec * 1e-9 + len(block.y) / block.sample_rate
