# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""YAML that others have written: plain values, in time and memory in proportion to the text."""

from __future__ import annotations

from typing import Any

from bearing_twin.errors import BearingTwinError
import yaml

__all__ = ['LONGEST', 'load_plain']

LONGEST = 100_000
"""Longest text that is parsed, characters."""


class _PlainLoader(yaml.SafeLoader):
    """
    Refuse references to other parts of the text.

    With them some hundred characters describe a structure of billions of elements, which takes all
    memory when it is merged, copied or printed.
    """

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError('it refers to another part of itself')
        return super().compose_node(parent, index)


def load_plain(text: str, what: str) -> Any:
    """
    Return what a YAML text from outside says.

    Parameters
    ----------
    text
        The text.
    what
        What it is, for the error.

    Raises
    ------
    BearingTwinError
        If it is too long, no YAML, nested too deeply, or refers to parts of itself.

    """
    if len(text) > LONGEST:
        msg = f'{what} has {len(text)} characters; at most {LONGEST} are read'
        raise BearingTwinError(msg)
    try:
        return yaml.load(text, _PlainLoader)
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        msg = f'{what} cannot be read as YAML: {reason}'
        raise BearingTwinError(msg) from None
