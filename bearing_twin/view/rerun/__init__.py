# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What Rerun shows: pictures, their layout, and where they go: files and viewers."""
