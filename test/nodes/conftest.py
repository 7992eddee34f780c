# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real nodes as processes, and a probe that talks to them over DDS as anybody would."""

from __future__ import annotations

import os
import time

from bearing_twin.nodes.launching import NodeProcesses
import pytest

TIMEOUT = 40.0


class Probe:
    """A node of the test: collects messages, publishes, calls services, sets parameters."""

    def __init__(self):
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.context = rclpy.Context()
        self.context.init()
        self.node = rclpy.create_node('probe', context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.statuses = {}
        self._publishers = {}
        self._clients = {}

    def close(self):
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.shutdown()

    def collect(self, kind, topic, depth=1000):
        """Return a list that fills with the messages of a topic."""
        messages = []
        self.node.create_subscription(kind, topic, messages.append, depth)
        return messages

    def watch_diagnostics(self):
        """Keep the latest status of every part in ``statuses``, values as a dict."""
        from diagnostic_msgs.msg import DiagnosticArray

        def keep(array):
            for status in array.status:
                values = {item.key: item.value for item in status.values}
                self.statuses[status.name] = (status.level, status.message, values)

        self.node.create_subscription(DiagnosticArray, '/diagnostics', keep, 100)

    def publish(self, topic, message, depth=100):
        """Publish on a topic, after the first subscriber is there."""
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
        """Call a service and return its response."""
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, name)
        client = self._clients[name]
        self.until(client.service_is_ready, f'service {name}')
        future = client.call_async(kind.Request(**fields))
        self.until(future.done, f'the answer of {name}')
        return future.result()

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


@pytest.fixture
def probe(ros_domain):
    """Return a probe in the test's own ROS domain."""
    made = Probe()
    yield made
    made.close()


@pytest.fixture
def nodes(ros_domain, tmp_path):
    """Return a starter of nodes in the test's own ROS domain."""
    with NodeProcesses(tmp_path / 'logs', os.environ) as processes:
        yield processes
