# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Contacts, rings, waves, resonators and sensor path, each written once for all integrators."""
