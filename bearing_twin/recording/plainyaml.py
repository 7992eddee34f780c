# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read plain values from untrusted YAML; time and memory are proportional to its length."""

from __future__ import annotations

from typing import Any

from bearing_twin.errors import BearingTwinError
import yaml

LONGEST = 1_000_000
"""Longest text that is parsed, characters."""


LOADER = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
"""The loader in C, if PyYAML has it: five times as fast."""
MOST_PARTS = 100_000
"""Most YAML events (begins, values and ends) in a text: a fleet of a thousand has half of it."""
DEEPEST = 100
"""Most levels of nested lists and tables."""


def load_plain(text: str, what: str) -> Any:
    """
    Return the values of an untrusted YAML text; ``what`` names the text in errors.

    Raises
    ------
    BearingTwinError
        If it is too long, not YAML, nested too deeply, or refers to parts of itself.

    """
    if len(text) > LONGEST:
        raise BearingTwinError(f'{what} has {len(text)} characters; at most {LONGEST} are read')
    try:
        _refuse_structure(text)
        return yaml.load(text, LOADER)
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise BearingTwinError(f'{what} cannot be read as YAML: {reason}') from None


def load_table(text: str, what: str) -> dict[str, Any]:
    """
    Return the parameters in an untrusted YAML text, by name.

    Raises
    ------
    BearingTwinError
        If :func:`load_plain` refuses the text, or if it is no table.

    """
    values = load_plain(text, what)
    if not isinstance(values, dict):
        raise BearingTwinError(f'{what} is no table of parameters')
    return values


def _refuse_structure(text: str) -> None:
    """
    Refuse deep nesting, very many parts, and references to other parts of the text.

    With references, a few hundred characters can describe a structure of billions of elements. It
    fills the memory when it is merged, copied or printed.
    """
    depth = 0
    for number, event in enumerate(yaml.parse(text, Loader=LOADER)):
        if number > MOST_PARTS:
            raise yaml.YAMLError(f'it has more than {MOST_PARTS} parts')
        if isinstance(event, yaml.AliasEvent):
            raise yaml.YAMLError('it refers to another part of itself')
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise yaml.YAMLError(f'it is nested deeper than {DEEPEST} levels')
