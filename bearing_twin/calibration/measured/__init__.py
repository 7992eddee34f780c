# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurements on a record: impacts, resonances, noise floor and sensor path."""
