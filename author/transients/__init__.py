# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Event-based transients: what the first milliseconds of a tap feel like, and the force that makes a device say it.

Source of the whole room: K. J. Kuchenbecker, J. Fiene, G. Niemeyer, Event-based haptics and acceleration matching:
portraying and assessing the realism of contact, World Haptics 2005 ("the paper" in these files).
"""
