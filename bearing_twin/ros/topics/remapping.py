# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Remap topics of a recording for replay."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.validate_full_topic_name import validate_full_topic_name

if TYPE_CHECKING:
    from collections.abc import Mapping


def remapping(rules: list[str]) -> dict[str, str]:
    """Return the new name by recorded name, from rules ``recorded:=new``."""
    names = {}
    for rule in filter(None, rules):
        recorded, separator, new = rule.partition(':=')
        if not (recorded and separator and new):
            raise BearingTwinError(f"remap='{rule}' does not read 'recorded:=new'")
        try:
            validate_full_topic_name(expand_topic_name(new, 'replay', '/'))
        except (ValueError, NameValidationException) as error:
            reason = str(error).partition(', at ')[0].splitlines()[0].rstrip(':')
            raise BearingTwinError(f"remap='{rule}': {reason}") from None
        names[recorded] = new
    return names


def check_remapping(names: Mapping[str, str], types: Mapping[str, str]) -> None:
    """
    Refuse rules that do not match the recording; ``types`` holds the types of replayed topics.

    Raises
    ------
    BearingTwinError
        If a rule names a topic that is not replayed, or two topics of different types would have
        the same name.

    """
    unknown = sorted(names.keys() - types.keys())
    if unknown:
        raise BearingTwinError(
            f'remap names {", ".join(unknown)}, which is not replayed; '
            f'there is {", ".join(sorted(types))}'
        )
    taken: dict[str, str] = {}
    for topic, kind in sorted(types.items()):
        new = names.get(topic, topic)
        if taken.setdefault(new, kind) != kind:
            msg = f'remap puts {taken[new]} and {kind} on one topic, {new}; give {topic} another'
            raise BearingTwinError(msg)
