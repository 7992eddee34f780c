# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Quantities of a record that need no twin: impacts, resonances, noise floor, sensor path."""
