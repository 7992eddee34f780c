# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The package's error class."""

from __future__ import annotations


class BearingTwinError(Exception):
    """Input that cannot be used: the text names the value, the limit and the remedy."""
