# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The live view: an asset in a browser, felt through the C++ runtime in its servo thread."""

from palpate.author.view.live import view

__all__ = ["view"]
