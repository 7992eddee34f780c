# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bearing geometry, fault frequencies and the catalogue."""

from bearing_twin.bearing.geometry import (
    Bearing,
    FaultFrequencies,
    fault_frequencies,
    fault_orders,
)

__all__ = ['Bearing', 'FaultFrequencies', 'fault_frequencies', 'fault_orders']
