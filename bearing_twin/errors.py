# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The error class of the package, and the escaping of texts from outside."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

REFUSED = 2
"""Exit status of a command or node that refuses its arguments or parameters, whatever files, disk
and network are like: the same call fails again. Any other failure ends with 1."""


class BearingTwinError(Exception):
    """Input cannot be used; the text names the value, the limit and the remedy."""


class UsageError(BearingTwinError):
    """The call itself cannot be used; the exit status is :data:`REFUSED`."""


class FileError(BearingTwinError):
    """A file cannot be read now; the exit status is 1, as the same call may work later."""


@contextmanager
def refused() -> Iterator[None]:
    """
    Turn errors about a given value into :class:`UsageError`.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> with refused():
    ...     find_bearing('6307').name
    '6307'

    """
    try:
        yield
    except BearingTwinError as error:
        raise UsageError(str(error)) from None


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
