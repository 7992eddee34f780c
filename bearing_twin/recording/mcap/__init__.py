# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read one MCAP file, sound or damaged, within limits that do not depend on what the file states.

All functions raise a BrokenRecording if the data is damaged or larger than the limits.
"""
