# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Candidate machines for a record: drawn at random, simulated and compared with it."""
