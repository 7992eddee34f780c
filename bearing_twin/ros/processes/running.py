# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Run a node as a process: prepare it, start it, and end it cleanly on a signal."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future
import contextlib
import ctypes
import os
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError, FileError, REFUSED, shown
from bearing_twin.process import keep_freed_memory
from bearing_twin.ros.executor import LeanExecutor
from bearing_twin.ros.health import Health, Level, Status
from bearing_twin.ros.lifecycle import PREPARATION, refuses
from bearing_twin.ros.processes.deadlock import bounded, LEAVING, watch
from bearing_twin.ros.processes.domain import initialise
from bearing_twin.ros.processes.fastdds import fast_dds_settings
from bearing_twin.ros.processes.launching import (
    COMPILING,
    ensure_log_folder,
    LOADING,
    PARENT,
)
from bearing_twin.view.rerun.ending import leave
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation

if TYPE_CHECKING:
    from bearing_twin.ros.lifecycle import ManagedNode
    from rclpy.executors import Executor


RCLError: type[Exception] = rclpy_implementation.RCLError
SLOW = 2.0
"""Time after which a node reports why its preparation takes long, s."""
_PR_SET_PDEATHSIG = 1
"""Option in ``linux/prctl.h``: signal to a process when its parent ends."""
PART = 'real time'
"""Name of the status during preparation; every node that compiles uses it later, too."""


def run(node_class: type[ManagedNode], args: Sequence[str] | None = None) -> int:
    """
    Run a node until a signal ends it; return the exit status.

    SIGINT, SIGTERM and SIGHUP (a closed terminal) end it cleanly: files are finished and the
    status is 0. The status is :data:`REFUSED` if parameters or arguments are refused, because a
    restart would not help.
    """
    stray = _stray(sys.argv[1:] if args is None else args)
    if stray:
        print(
            f"{_program(node_class)}: unknown argument '{stray}'; parameters and remappings go "
            "behind --ros-args, e.g. '--ros-args -p NAME:=VALUE'",
            file=sys.stderr,
        )
        return REFUSED
    _end_with_parent()
    ensure_log_folder()
    keep_freed_memory()
    status = _run(node_class, args)
    if _is_compiling():
        # The compiler cannot be interrupted, and there is nothing to save.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    leave(status)
    return status


def _end_with_parent() -> None:
    """
    Request SIGTERM for this process when the launch that started it ends.

    SIGTERM or a crash ends ``ros2 launch`` without its nodes. These would continue to record, and
    after the next launch each sensor would have two of each node.
    """
    parent = os.environ.get(PARENT, '')
    if parent != str(os.getppid()):
        return
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if parent != str(os.getppid()):
        # The parent ended before this request.
        os.kill(os.getpid(), signal.SIGTERM)


def _prepare(node: ManagedNode, executor: Executor) -> None:
    """
    Prepare a node in a thread, and answer services until that is done.

    If it takes long, the log and /diagnostics report why.
    """
    started = time.monotonic()
    node.preparation.start()
    health: Health | None = None
    said = ''
    while node.preparation.is_alive() and node.context.ok():
        executor.spin_once(timeout_sec=0.1)
        if time.monotonic() - started < SLOW:
            continue
        if (why := _what_takes_long()) != said:
            node.get_logger().info(said := why)
        if health is None:
            health = Health(node, node.get_namespace())
            health.add(
                PART,
                lambda: Status(
                    Level.WARN, _what_takes_long(), {'time_s': time.monotonic() - started}
                ),
            )
    if health is not None:
        health.destroy()


def _what_takes_long() -> str:
    # Imported here, because Numba takes a second to load and not all nodes need it.
    from bearing_twin.numerics.compiled import has_compiled, other_processors, processor

    others = ', '.join(other_processors())
    if has_compiled() and others:
        return f'{COMPILING}: the code at hand is for {others}, this is a {processor()}'
    return COMPILING if has_compiled() else LOADING


def _is_compiling() -> bool:
    """Return whether a preparation is running; the compiler cannot be interrupted."""
    return any(thread.name == PREPARATION for thread in threading.enumerate())


def _work(node: ManagedNode) -> None:
    def give_up(threads: str) -> None:
        node.failed = True
        node.get_logger().fatal(
            f'the middleware has locked itself up ({threads}): the node hears nothing any more, '
            'ends with status 1 and must be started again'
        )
        # As a signal does. rclpy's own shutdown also destroys publishers, which would block.
        os.kill(os.getpid(), signal.SIGTERM)

    watch(give_up)
    try:
        # Refused after a signal during the construction of the node.
        executor = LeanExecutor()
        executor.add_node(node)
        _prepare(node, executor)
        node.bring_up()
        executor.spin()
    except (Exception, KeyboardInterrupt):
        if not node.context.ok():
            # A signal shuts down the context at once, even during a callback that publishes.
            raise ExternalShutdownException from None
        raise


def _run(node_class: type[ManagedNode], args: Sequence[str] | None) -> int:
    node: ManagedNode | None = None
    status = 1
    interrupts = _note_interrupts()
    if signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:  # nohup ignores it
        signal.signal(signal.SIGHUP, _terminate)
    try:
        initialise(args)
        try:
            if interrupts:
                # The interrupt came before rclpy installed its handler.
                raise ExternalShutdownException
            with fast_dds_settings(fleet=node_class.fleet):
                node = _build(node_class)
            _work(node)
        finally:
            if node is not None:
                node.shut_down(destroy=False)
        status = 1 if node.failed else 0
    except ExternalShutdownException:
        status = 1 if node is not None and node.failed else 0
    except BearingTwinError as error:
        print(shown(f'{_program(node_class)}: {error}', keep='\n'), file=sys.stderr)
        refused = node.refused if node is not None else not isinstance(error, FileError)
        status = REFUSED if refused else 1
    except RCLError as error:
        # With a time beyond 2038 Fast DDS 3.2 sends nothing and never recovers: the process must
        # be restarted.
        hint = '; is the system clock beyond 2038?' if 'publish' in str(error) else ''
        print(
            shown(f'{_program(node_class)}: nothing can be sent ({error}){hint}'), file=sys.stderr
        )
    finally:
        # Only the end of the process remains: do not interrupt it.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _take_leave(node, status)
    return status


def _take_leave(node: ManagedNode | None, status: int) -> None:
    """Tell the other nodes that this one ends: they would count on it for 20 s more."""
    sys.stdout.flush()
    sys.stderr.flush()
    with bounded(LEAVING, status):
        if node is not None:
            node.destroy_node()
            # rclpy keeps the state machine, and with it the participant.
            node._state_machine.destroy_when_not_in_use()
        # A signal may shut down the context at the same time, in a thread of rclpy.
        with contextlib.suppress(RCLError):
            rclpy.try_shutdown()


def _note_interrupts() -> list[int]:
    """
    Make SIGINT act like SIGTERM: rclpy shuts down the context, which the node checks.

    Otherwise Python would raise KeyboardInterrupt between any two steps of a callback, such as in
    the middle of writing a record, or while the node already ends after an earlier interrupt.
    The signals that come are added to the returned list.
    """
    came: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: came.append(number))
    return came


def _terminate(*_: object) -> None:
    """End as by SIGTERM, which rclpy handles; a repeated SIGHUP is ignored."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    os.kill(os.getpid(), signal.SIGTERM)


def _build(node_class: type[ManagedNode]) -> ManagedNode:
    """
    Build a node in a thread, and abandon the thread if a signal ends the process.

    The check of parameters may compile, which may take longer than launch waits before SIGKILL.
    """
    future: Future[ManagedNode] = Future()

    def build() -> None:
        try:
            future.set_result(node_class())  # type: ignore[call-arg]
        except BaseException as error:
            future.set_exception(error)

    thread = threading.Thread(target=build, name=PREPARATION, daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(0.1)
        if not rclpy.ok():
            raise ExternalShutdownException
    try:
        return future.result()
    except Exception as error:
        if isinstance(error, BearingTwinError):
            raise
        if refuses(error):
            raise BearingTwinError(str(error)) from None
        if rclpy.ok():
            raise
        raise ExternalShutdownException from None


def _program(node_class: type[ManagedNode]) -> str:
    return node_class.__name__.removesuffix('Node').lower()


def _stray(words: Sequence[str]) -> str:
    """Return the first argument outside ``--ros-args`` ... ``--``; '' if there is none."""
    inside = False
    for word in words:
        if word == '--ros-args':
            inside = True
        elif inside:
            inside = word != '--'
        else:
            return word
    return ''
