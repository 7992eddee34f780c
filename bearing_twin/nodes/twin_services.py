# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Services of one twin, in a twin node or a fleet node."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from bearing_twin.ros.lifecycle import answered
from bearing_twin.streams.statefile import StateFolder
from bearing_twin_msgs.srv import InjectDefect, LoadState, SaveState
from rclpy.parameter import Parameter

if TYPE_CHECKING:
    from bearing_twin.ros.lifecycle import ManagedNode
    from bearing_twin.ros.parameters import ParameterSet


class TwinServices:
    """Answer ``reset``, ``save_state``, ``load_state`` and ``inject_defect``."""

    def __init__(
        self,
        node: ManagedNode,
        parameters: ParameterSet,
        *,
        reset: Callable[[], None],
        save: Callable[[], bytes],
        load: Callable[[bytes], None],
        path: str = '~',
        prefix: str = '',
    ) -> None:
        self._node = node
        self._parameters = parameters
        self._reset, self._save, self._load = reset, save, load
        self._prefix = prefix
        self._states, self._disk = StateFolder(parameters['state_directory']), node.states.disk
        node.offer(f'{path}/reset', self._restart)
        node.create_service(SaveState, f'{path}/save_state', self._on_save)
        node.create_service(LoadState, f'{path}/load_state', self._on_load)
        node.create_service(InjectDefect, f'{path}/inject_defect', self._on_inject)

    def _restart(self) -> str:
        self._reset()
        return f'back at the start with seed {self._parameters["seed"]}'

    async def _on_save(
        self, request: SaveState.Request, response: SaveState.Response
    ) -> SaveState.Response:
        async def save() -> str:
            state = self._save()
            return str(await self._disk.do(lambda: self._states.save(request.path, state)))

        return await answered(response, save)

    async def _on_load(
        self, request: LoadState.Request, response: LoadState.Response
    ) -> LoadState.Response:
        async def load() -> str:
            self._load(await self._disk.do(lambda: self._states.load(request.path)))
            return f'loaded {request.path}'

        return await answered(response, load)

    def _on_inject(
        self, request: InjectDefect.Request, response: InjectDefect.Response
    ) -> InjectDefect.Response:
        # Set through the parameters, so that they stay true and the same checks apply.
        result = self._node.set_parameters_atomically(
            [
                Parameter(f'{self._prefix}defect', value=request.place),
                Parameter(f'{self._prefix}defect_width', value=request.width),
                Parameter(f'{self._prefix}defect_depth', value=request.depth),
            ]
        )
        response.success = result.successful
        response.message = result.reason or f'defect: {request.place}'
        return response
