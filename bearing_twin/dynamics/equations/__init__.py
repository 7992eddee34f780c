# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Contacts, rings, waviness, filters and sensor path, each written once for all integrators."""
