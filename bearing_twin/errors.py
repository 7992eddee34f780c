# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The error class of the package, and the escaping of texts from outside."""

from __future__ import annotations


class BearingTwinError(Exception):
    """Input cannot be used; the text names the value, the limit and the remedy."""


def shown(text: object, keep: str = '') -> str:
    r"""
    Return a text from outside with its control characters escaped for a terminal.

    Parameters
    ----------
    text
        Name or message from a file. It may hold sequences that set colours, the cursor or the
        window title, and marks that reverse the direction of the text.
    keep
        Characters that are not escaped, such as the newlines of an error.

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
