# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Recordings: read, written, recovered; what is inside one MCAP file, and vibration out of any."""
