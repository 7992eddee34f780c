# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Evaluate messages while they are recorded: parameters, fault alarms, Rerun output."""

from __future__ import annotations

from collections.abc import Callable, Mapping
import contextlib
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
import os
import platform
import time
from typing import Any, TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import LONGEST_TEXT
from bearing_twin.recording.mcap.schema import message_schema, store_from_text
from bearing_twin.recording.plainyaml import load_table
from bearing_twin.recording.snapshot import SnapshotWriter
from bearing_twin.recording.topics import CHECKPOINT, DIAGNOSIS, LEVEL_FAULT
from bearing_twin.wholefile import free_path, given_path
import yaml

if TYPE_CHECKING:
    from bearing_twin.recording.writer import RecordingWriter
    from bearing_twin.view.rerun.logger import RerunLogger
    from rclpy.impl.rcutils_logger import RcutilsLogger


MOST_ATTACHED = 16 * 1024 * 1024
"""Most bytes of node parameters that are attached; they are repeated in every file."""
LONGEST_READ = 5.0
"""Longest time for reading the remaining parameters at the end, s."""
LIBRARIES = ('numpy', 'scipy', 'numba', 'mcap', 'rosbags', 'rerun-sdk', 'rclpy')


class RecordingWatch:
    """
    Evaluate messages while they are recorded.

    Parameters of the nodes (from their checkpoints) and their bearings are attached to the
    recording. A diagnosis that changes to fault triggers a snapshot. Rerun receives what it draws.
    Errors of these tasks are reported and never prevent a message from being recorded.
    """

    def __init__(
        self,
        writer: RecordingWriter,
        values: Mapping[str, Any],
        logger: RcutilsLogger,
    ) -> None:
        self.problem = ''
        """The last error; '' if there is none."""
        self._writer = writer
        self._logger = logger
        self._troubled = ''
        # Parameters by node (YAML), and the version of each node whose parameters are unread.
        self._configurations: dict[str, str] = {}
        self._unread: dict[str, str] = {}
        self._attached = 0
        self._in_fault: dict[str, bool] = {}
        self._rerun: RerunLogger | None = None
        writer.metadata('bearing_twin.versions', _versions())
        writer.metadata('bearing_twin.recorder', {k: str(v) for k, v in values.items()})
        if values['rerun_file'] or values['rerun_port']:
            port = values['rerun_port']
            try:
                # The file has no footer on purpose: Rerun need not warn of it.
                os.environ.setdefault('RUST_LOG', 'info,re_log_encoding=error')
                # Imported only when needed: the import takes a second.
                from bearing_twin.view.rerun import logger as rerun

                rrd = values['rerun_file']
                self._rerun = rerun.RerunLogger(
                    recording_id=str(writer.path.absolute()),
                    rrd=free_path(given_path(rrd)) if rrd else None,
                    serve=(values['rerun_address'], port) if port else None,
                    footer=False,
                )
            except BearingTwinError as error:
                self.problem = f'nothing is drawn: {error} (-p rerun_port:=N, -p rerun_file:=FILE)'
                logger.error(self.problem)
            except ImportError as error:
                # rosdep has no key for rerun-sdk, so it may be missing.
                self.problem = (
                    f'nothing is drawn: {error} (pip install rerun-sdk, or rerun_port:=0)'
                )
                logger.error(self.problem)

    @property
    def pictures_dropped(self) -> int:
        """Messages that live Rerun viewers missed because one of them was too slow."""
        return self._rerun.dropped if self._rerun is not None else 0

    def take(self, topic: str, type_name: str, cdr: bytes, received: int) -> None:
        """Evaluate one message; ``received`` is its log time, ns."""
        drawn = self._rerun is not None and self._rerun.draws(topic, type_name)
        if drawn or type_name in (CHECKPOINT, DIAGNOSIS):
            self._attempt(topic, self._evaluate, topic, type_name, cdr, received)

    def read(self, seconds: float) -> None:
        """
        Attach node parameters from checkpoints for up to ``seconds``; the rest waits.

        Reading an untrusted text may take seconds, in which no messages would be received.
        """
        end = time.monotonic() + seconds
        while self._unread and time.monotonic() < end:
            node = next(iter(self._unread))
            what = f'the configuration of {node}'
            self._attempt(what, self._attach, node, self._unread.pop(node))

    def close(self) -> None:
        """Attach the remaining parameters; finish the Rerun recording."""
        self.read(LONGEST_READ)
        if self._rerun is not None:
            self._rerun.close()

    def _attempt(self, what: str, task: Callable[..., None], *given: Any) -> None:
        """
        Do a task; report any error as a problem, and clear it when the same task succeeds again.

        No context manager: since Python 3.12 that keeps an error, and so the message, until the
        next search for garbage.
        """
        try:
            task(*given)
        except Exception as error:
            said = f'{what} could not be looked at ({type(error).__name__}: {error})'
            self._troubled, self.problem = what, said[:LONGEST_TEXT]
            self._logger.warning(self.problem, throttle_duration_sec=60.0)
        else:
            if what == self._troubled:
                self.problem = self._troubled = ''

    def _evaluate(self, topic: str, type_name: str, cdr: bytes, received: int) -> None:
        schema = message_schema(type_name)
        message = store_from_text(type_name, schema.text).deserialize_cdr(cdr, type_name)
        if type_name == CHECKPOINT:
            self._note_configuration(message)
        elif type_name == DIAGNOSIS:
            self._look_for_fault(topic, message, received)
        if self._rerun is not None:
            self._rerun.log(topic, type_name, message, received)

    def _note_configuration(self, checkpoint: Any) -> None:
        node, text = str(checkpoint.node), str(checkpoint.configuration)
        if self._configurations.get(node) == text:
            return
        if self._attached + len(node) + len(text) > MOST_ATTACHED:
            msg = f'more than {MOST_ATTACHED} bytes of parameters: changes are kept no longer'
            raise BearingTwinError(msg)
        self._attached += len(node) + len(text)
        self._configurations[node] = text
        self._unread[node] = str(checkpoint.version)

    def _attach(self, node: str, version: str) -> None:
        values = load_table(self._configurations[node], 'it')
        parameters = yaml.safe_dump({node: {'ros__parameters': values}}, sort_keys=True)
        name = node.strip('/').replace('/', '.')
        self._writer.attach(f'{name}.yaml', parameters.encode(), 'application/yaml')
        self._writer.metadata(
            f'bearing_twin.parameters.{name}',
            {'node': node, 'version': version}
            | {str(key): str(value) for key, value in values.items()},
        )
        if not values.get('bearing'):
            # A custom bearing or a fleet: the parameters already contain the geometry.
            return
        bearing = asdict(find_bearing(values['bearing']))
        self._writer.attach(
            f'bearing_{values["bearing"]}.yaml',
            yaml.safe_dump(bearing, sort_keys=False).encode(),
            'application/yaml',
        )

    def _look_for_fault(self, topic: str, diagnosis: Any, received: int) -> None:
        before = self._in_fault.get(topic, False)
        fault = diagnosis.level == LEVEL_FAULT
        if fault and not before and isinstance(self._writer, SnapshotWriter):
            self._logger.info(f'{diagnosis.fault_code} on {topic}: a snapshot is written')
            # If this fails, the next verdict triggers again.
            self._writer.trigger(received)
        self._in_fault[topic] = fault


def _versions() -> dict[str, str]:
    versions = {'bearing_twin': __version__, 'python': platform.python_version()}
    for library in LIBRARIES:
        with contextlib.suppress(PackageNotFoundError):
            versions[library] = version(library)
    return versions
