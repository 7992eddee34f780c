# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature laws: GCr15 tables, beta0, slip, clearance, viscosity, friction, rating life."""
