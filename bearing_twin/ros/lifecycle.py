# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Base class of the nodes: a lifecycle node with a parameter table and automatic start."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Collection, Iterable, Mapping
import gc
import sys
import threading
import traceback
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.parameters.shared import AUTOSTART
from bearing_twin.errors import BearingTwinError, shown, UsageError
from bearing_twin.ros.executor import PolledGroup
from bearing_twin.ros.parameterfile import doubts
from bearing_twin.ros.parameters import ParameterSet, read_as_at_start, unknown_at_start
from bearing_twin.ros.topics.subscribing import validated
from bearing_twin.streams.statefile import NodeStates
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.logging import get_logger
from rclpy.qos_overriding_options import InvalidQosOverridesError
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

if TYPE_CHECKING:
    from bearing_twin.assets.parameters.spec import Spec
    from rclpy.impl.rcutils_logger import RcutilsLogger
    from rclpy.lifecycle import LifecycleState
    from rclpy.service import Service
    from rclpy.subscription import Subscription


REFUSALS = (
    'Unexpected QoS override',
    'error creating node: invalid node name',
    # Two topics of different types that are remapped to one.
    'called for existing topic name',
)
"""Refusals for which rclpy raises RuntimeError, by a part of their text."""
POLL_PERIOD = 0.1
"""Longest time that a polled input waits, s."""
PREPARATION = 'preparation'
"""Name of the threads that may compile: the compiler cannot be interrupted."""


def entities(node: LifecycleNode) -> set[Any]:
    """Return publishers, subscriptions, services, clients and timers of a node."""
    return {
        *(*node.publishers, *node.subscriptions),
        *(*node.services, *node.clients, *node.timers),
    }


def destroy_new(node: LifecycleNode, before: Collection[Any]) -> None:
    """Destroy all entities of a node that are not in ``before``."""
    destroyers: tuple[tuple[Iterable[Any], Callable[[Any], bool]], ...] = (
        (node.timers, node.destroy_timer),
        (node.clients, node.destroy_client),
        (node.services, node.destroy_service),
        (node.subscriptions, node.destroy_subscription),
        (node.publishers, node.destroy_lifecycle_publisher),
    )
    for made, destroy in destroyers:
        for entity in list(made):
            if entity not in before:
                destroy(entity)


class ManagedNode(LifecycleNode):
    """
    A lifecycle node with a parameter table.

    ``configure`` builds the objects for the parameters, and ``activate`` starts the work.
    ``deactivate`` and ``cleanup`` undo these steps, and destroy the topics, services and timers
    that the step made. Subclasses implement :meth:`prepare`, :meth:`check`, :meth:`apply`,
    :meth:`setup`, :meth:`start`, :meth:`stop` and :meth:`teardown`. If one of the last four raises
    BearingTwinError, the transition fails and the text is logged.
    """

    fleet = False
    """Whether the node publishes the blocks of many bearings."""

    def __init__(self, name: str, specs: Iterable[Spec]) -> None:
        super().__init__(name)
        # Before the check of the parameters, which may fail because of it.
        for sentence in doubts(sys.argv, self.get_fully_qualified_name()):
            self.get_logger().warning(shown(sentence))
        self.configured = False
        self.active = False
        self.polled = PolledGroup(POLL_PERIOD)
        """Group of the subscriptions that can wait for the next block."""
        self.states = NodeStates(lambda text: self.get_logger().error(text))
        """States kept over restarts; released at the end."""
        self._managed = False
        self.failed = False
        """Whether the work has ended with an error; sets the exit status of the process."""
        self.refused = False
        """Whether the error is a refused parameter, found only when the parameter was used."""
        self.preparation = threading.Thread(target=self.prepare, name=PREPARATION, daemon=True)
        """Thread of :meth:`prepare`; a configuration waits until it has ended."""
        self.parameters = ParameterSet(
            self,
            (*specs, AUTOSTART),
            check=self.check,
            apply=self._apply,
            locked=lambda: self.configured,
        )

    def get_logger(self) -> RcutilsLogger:
        """Return the logger; after a shutdown one whose texts rclpy does not try to publish."""
        logger = super().get_logger()
        return logger if self.context.ok() else get_logger(f'bearing_twin.{logger.name}')

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, *args: Any, **kwargs: Any
    ) -> Subscription[Any]:
        """Subscribe; messages for rclpy's own subscription to /clock are validated."""
        if msg_type is Clock and not kwargs.get('raw', False):
            kwargs['raw'], given = True, callback
            callback = validated(self, Clock, topic, lambda message, _: given(message))
        return super().create_subscription(msg_type, topic, callback, *args, **kwargs)

    def create_service(
        self, srv_type: Any, srv_name: str, callback: Any, *args: Any, **kwargs: Any
    ) -> Service[Any, Any]:
        """Create a service; values sent to rclpy's own parameter services are read as at start."""
        if srv_type in (SetParameters, SetParametersAtomically):
            callback = read_as_at_start(self, callback)
        return super().create_service(srv_type, srv_name, callback, *args, **kwargs)

    def offer(self, name: str, action: Callable[[], str | Awaitable[str]]) -> Service[Any, Any]:
        """
        Create a ``std_srvs/Trigger`` service.

        Parameters
        ----------
        name
            Its name.
        action
            Function that returns the message of the answer, or an awaitable of it; the node works
            meanwhile. A BearingTwinError refuses the request.

        """

        async def answer(_: Any, response: Any) -> Any:
            return await answered(response, action)

        return self.create_service(Trigger, name, answer)

    def prepare(self) -> None:
        """Compile at the first start; called in a thread, while the node answers."""

    def check(self, values: Mapping[str, Any]) -> None:
        """Raise BearingTwinError if parameters contradict each other."""

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply changed parameters to the configured node."""

    def setup(self) -> None:
        """Build publishers, subscriptions and the core objects."""

    def start(self) -> None:
        """Start the work."""

    def stop(self) -> None:
        """Stop the work; :meth:`start` may follow."""

    def teardown(self) -> None:
        """Release the objects that :meth:`setup` built."""

    def bring_up(self) -> None:
        """
        Configure and activate, if ``autostart`` is set and no manager has begun to.

        Raises
        ------
        BearingTwinError
            If a transition failed; its reason is in the log.

        """
        if self._managed or not self.parameters['autostart']:
            return
        for trigger in (self.trigger_configure, self.trigger_activate):
            result = trigger()
            if not self.context.ok():
                # Interrupted while starting: this is not an error.
                raise ExternalShutdownException
            if result != TransitionCallbackReturn.SUCCESS:
                raise BearingTwinError('the node could not start; see the error above')

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Set up the node; callback of rclpy."""
        self._managed = True
        while self.preparation.is_alive():
            self.preparation.join(0.1)
            self._end_if_interrupted()
        self._unconfigured = entities(self)
        result = self._attempt_or_undo(self.setup, self._unconfigured)
        if result == TransitionCallbackReturn.SUCCESS:
            self.configured = True
            # A full garbage collection takes tens of milliseconds with these libraries loaded.
            # Freeze the present objects, so that the collector skips them. The next configuration
            # frees objects that an earlier one has left.
            gc.unfreeze()
            gc.collect()
            gc.freeze()
        else:
            self.states.release()
        self._end_if_interrupted()
        return result

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start the work; callback of rclpy."""
        if super().on_activate(state) != TransitionCallbackReturn.SUCCESS:
            return TransitionCallbackReturn.FAILURE
        self._inactive = entities(self)
        result = self._attempt_or_undo(self.start, self._inactive)
        self.active = result == TransitionCallbackReturn.SUCCESS
        if not self.active:
            super().on_deactivate(state)
        self._end_if_interrupted()
        if not self.active:
            return result
        # Not an error: a parameter file may be shared with other nodes. Only now all topics are
        # known, whose QoS can be given.
        for sentence in unknown_at_start(self):
            self.get_logger().warning(sentence)
        return result

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Tear down after a programming error; callback of rclpy."""
        self.shut_down()
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop the work; callback of rclpy."""
        self.active = False
        result = self._undo(self.stop, self._inactive)
        super().on_deactivate(state)
        return result

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Tear down; callback of rclpy."""
        result = self._tear_down()
        # The log has the failure; the node counts as cleaned up, as nothing can be activated.
        failure, success = TransitionCallbackReturn.FAILURE, TransitionCallbackReturn.SUCCESS
        return success if result == failure else result

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop and tear down from any state; callback of rclpy."""
        self._managed = True
        self.shut_down()
        return TransitionCallbackReturn.SUCCESS

    def shut_down(self, *, destroy: bool = True) -> None:
        """
        Stop and tear down if necessary; called whenever the process ends.

        Without ``destroy`` the entities remain: a middleware that blocks keeps no file unfinished.
        """
        if self.active:
            self.active = False
            self._undo(self.stop, self._inactive, destroy=destroy)
        if self.configured:
            self._tear_down(destroy=destroy)

    def _tear_down(self, *, destroy: bool = True) -> TransitionCallbackReturn:
        self.configured = False
        result = self._undo(self.teardown, self._unconfigured, destroy=destroy)
        self.states.release()
        return result

    def _apply(self, values: Mapping[str, Any]) -> None:
        if self.configured:
            self.apply(values)

    def _end_if_interrupted(self) -> None:
        """
        Raise KeyboardInterrupt after a step during which a signal came.

        rclpy cannot publish the end of the transition any more, and would log this as an error.
        """
        if not self.context.ok():
            raise KeyboardInterrupt

    def _attempt_or_undo(self, step: Any, before: set[Any]) -> TransitionCallbackReturn:
        """Attempt a step; if it fails, destroy the entities that it has made."""
        result = self._attempt(step)
        if result != TransitionCallbackReturn.SUCCESS:
            destroy_new(self, before)
        return result

    def _undo(
        self, step: Any, before: set[Any], *, destroy: bool = True
    ) -> TransitionCallbackReturn:
        """Attempt the step that leaves a state; ``destroy`` the entities made in that state."""
        result = self._attempt(step)
        if destroy:
            destroy_new(self, before)
        return result

    def _attempt(self, step: Any) -> TransitionCallbackReturn:
        try:
            step()
        except Exception as error:
            if refuses(error):
                # The refusals of rclpy are of QoS overrides.
                own = isinstance(error, BearingTwinError)
                self.refused = not own or isinstance(error, UsageError)
                self.get_logger().error(shown(error, keep='\n'))
                return TransitionCallbackReturn.FAILURE
            if not self.context.ok():
                # An interrupt can occur anywhere, also in the compiler: not a programming error.
                return TransitionCallbackReturn.FAILURE
            # rclpy would hide the error: log a programming error with its traceback.
            self.get_logger().fatal(traceback.format_exc())
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS


async def answered(response: Any, action: Callable[[], str | Awaitable[str]]) -> Any:
    """
    Run ``action`` and fill in ``success`` and ``message`` of the answer of a service.

    ``action`` is as in :meth:`ManagedNode.offer`.
    """
    try:
        said = action()
        response.message = said if isinstance(said, str) else await said
        response.success = True
    except BearingTwinError as error:
        response.message = str(error)
    return response


def refuses(error: Exception) -> bool:
    """Return whether an error is a refusal of user input, by this package or by rclpy."""
    refusals = (
        BearingTwinError, ParameterException, InvalidQosOverridesError, NameValidationException
    )  # fmt: skip
    return isinstance(error, refusals) or any(text in str(error) for text in REFUSALS)
