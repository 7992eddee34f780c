# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One MCAP file, read within bounds that hold whatever the file claims, sound or damaged."""
