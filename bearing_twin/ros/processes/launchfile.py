# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Common parts of the launch files: typed arguments that override a parameter file."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
import os
from pathlib import Path
from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError, REFUSED
from bearing_twin.ros.processes.launching import PARENT
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessExit
from launch.events import matches_action
from launch.events.process import ShutdownProcess
from launch.logging import get_logger
from launch.substitutions import (
    EqualsSubstitution,
    IfElseSubstitution,
    LaunchConfiguration,
    PathJoinSubstitution,
)
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

if TYPE_CHECKING:
    from launch import LaunchContext, Substitution
    from launch.events.process import ProcessExited


PACKAGE = 'bearing_twin'
TRUTHS = ('true', 'false', '1', '0')
"""Values of an argument that decides whether a node is started."""


@dataclass(frozen=True)
class Argument:
    """An argument of a launch file."""

    name: str
    text: str
    default: str | Substitution | Sequence[str | Substitution] = ''
    """If it is empty, the value of the parameter file or the default of the node applies."""
    kind: type = str


class WhenRecorded(IfElseSubstitution):  # type: ignore[misc]
    """One value if the argument ``record`` is true, and another one if not."""

    def __init__(self, value: str, otherwise: str) -> None:
        recorded = EqualsSubstitution(LaunchConfiguration('record'), 'true')
        super().__init__(recorded, value, otherwise)
        self._text = f"'{value}', with record:=false '{otherwise}'"

    def describe(self) -> str:
        """Return the text that ``--show-args`` prints; launch would print an object."""
        return self._text


def shared(*path: str) -> PathJoinSubstitution:
    """Return the path of an installed file of this package."""
    return PathJoinSubstitution([FindPackageShare(PACKAGE), *path])


def launch_description(
    arguments: Sequence[Argument],
    nodes: Mapping[str, Sequence[str]],
    conditions: Mapping[str, str] | None = None,
    *,
    remappings: Mapping[str, Mapping[str, str | Substitution]] | None = None,
    respawned: Collection[str] = (),
) -> LaunchDescription:
    """
    Return the description of a launch file.

    Parameters
    ----------
    arguments
        Arguments of the file, among them ``namespace``. ``params_file`` and ``use_sim_time``, if
        present, apply to all nodes.
    nodes
        Executables to start, and for each the arguments that become its parameters.
    conditions
        For an executable, the argument that decides whether to start it.
    remappings
        For an executable, other names of its topics.
    respawned
        Executables that are restarted after a crash, unless they refuse their parameters.

    Raises
    ------
    BearingTwinError
        At launch, if an argument has the wrong type or ``params_file`` is not a file: launch
        itself would only warn and continue with the defaults.

    """
    conditions, remappings = conditions or {}, remappings or {}

    def start(context: LaunchContext) -> list[Node | RegisterEventHandler]:
        declared = [each.name for each in arguments]
        # Check only the command line: a launch file that includes this one has its own arguments.
        typed = {argument.partition(':=')[0] for argument in context.argv}
        for name in sorted(typed - set(declared)):
            for close in get_close_matches(name, declared, n=1, cutoff=0.85):
                get_logger(PACKAGE).warning(f"there is no argument '{name}'; is '{close}' meant?")
        texts = {each.name: LaunchConfiguration(each.name).perform(context) for each in arguments}
        given = {each.name: _value(each, context) for each in arguments if texts[each.name]}
        file = texts.get('params_file', '')
        if file and not Path(file).is_file():
            msg = f'params_file:={file} is no file; the path is taken from where launch is started'
            raise BearingTwinError(msg)
        for name in conditions.values():
            # launch itself would not say which argument it means.
            if texts[name].lower() not in TRUTHS:
                msg = f'{name}:={texts[name]} is not one of {", ".join(TRUTHS)}'
                raise BearingTwinError(msg)
        started = []
        for executable, names in nodes.items():
            chosen = {name: given[name] for name in (*names, 'use_sim_time') if name in given}
            condition = conditions.get(executable)
            started.append(
                Node(
                    package=PACKAGE,
                    executable=executable,
                    # Parameters of a named node override those of a file for all nodes.
                    name=executable,
                    namespace=LaunchConfiguration('namespace'),
                    parameters=[*([file] if file else []), *([chosen] if chosen else [])],
                    condition=IfCondition(LaunchConfiguration(condition)) if condition else None,
                    remappings=list(remappings.get(executable, {}).items()),
                    additional_env={PARENT: str(os.getpid())},
                    respawn=executable in respawned,
                    respawn_delay=2.0,
                    output='screen',
                )
            )
        ends = [OnProcessExit(target_action=node, on_exit=_leave_refused) for node in started]
        return [*map(RegisterEventHandler, ends if respawned else ()), *started]

    declared = [
        DeclareLaunchArgument(each.name, default_value=each.default, description=each.text)
        for each in arguments
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=start)])


def _leave_refused(event: ProcessExited, _: LaunchContext) -> list[EmitEvent]:
    """Stop launch from restarting a node that has refused its parameters."""
    if event.returncode != REFUSED:
        return []
    get_logger(PACKAGE).error(
        f'{event.process_name} refuses its parameters, see above: it is not started again'
    )
    return [EmitEvent(event=ShutdownProcess(process_matcher=matches_action(event.action)))]


def _value(argument: Argument, context: LaunchContext) -> ParameterValue:
    value = ParameterValue(LaunchConfiguration(argument.name), value_type=argument.kind)
    try:
        value.evaluate(context)
    except ValueError:
        text = LaunchConfiguration(argument.name).perform(context)
        msg = f'{argument.name}:={text} must be of type {argument.kind.__name__}'
        raise BearingTwinError(msg) from None
    return value
