# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The package's error class, and how a text from outside is shown."""

from __future__ import annotations


class BearingTwinError(Exception):
    """Input that cannot be used: the text names the value, the limit and the remedy."""


def shown(text: object, keep: str = '') -> str:
    r"""
    Return a text from outside with what a terminal would obey written as an escape.

    Parameters
    ----------
    text
        Names and messages out of a file: they may hold colours, cursor movements, titles, and
        marks that turn the direction of the text.
    keep
        Characters that are left as they are, such as the newlines of an error.

    Examples
    --------
    >>> shown('\x1b[31mred')
    '\\x1b[31mred'

    """
    said = str(text)
    if said.isprintable():
        return said
    return ''.join(
        c if c.isprintable() or c in keep else c.encode('unicode_escape').decode() for c in said
    )
