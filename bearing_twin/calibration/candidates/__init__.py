# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Machines that a record may be of: drawn at random, simulated, and weighed against it."""
