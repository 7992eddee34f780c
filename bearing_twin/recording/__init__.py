# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read, write and recover MCAP recordings, and read vibration from files of other formats."""
