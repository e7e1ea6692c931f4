# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy, measured on a scene's own organ: `palpate tradeoff`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from palpate.author.progress import Progress, SilentProgress
from palpate.author.scene import Scene

__all__ = ["tradeoff"]


def tradeoff(
    scene: Scene,
    out: Path,
    tool: str = "",
    *,
    budget: float | None = None,
    held_out: int | None = None,
    workers: int | None = None,
    confirm_seeds: int = 0,
    confirm_points: int | None = None,
    write_scene: Path | None = None,
    progress: Progress | None = None,
    executor: Any = None,
    solver: Any = None,
) -> dict[str, Any]:
    """Weighs the settings of one tool (the scene's first when none is named) in the folder `out`.

    Args:
        budget: s of wall time for the sweep; presses that are under way end.  What is kept in `out` counts nothing.
        held_out: presses that judge all settings (count); the scene's own, at least 8, when None.
        workers: processes that press; one a core when None.
        confirm_seeds: fresh seeds that judge the recommended setting afterwards, beyond the budget; none when 0.
        confirm_points: fresh presses of each seed (count); as many as the scene holds out when None.
        write_scene: file that the scene goes to with the recommended setting.
        executor, solver: press instead of processes and finite elements (tests).

    Returns:
        rows: [{setting, cpu_seconds, bytes, tick_ns, force_error, lateral_error, stuck_error, met, chance, ...}],
        errors as {p50, p95, max}; pareto: indices; recommended: index, None where no row is sure enough to meet the
        tolerance; confirmed (confirm.py), scene_written and files where they are; tolerance, base, truth, left_out,
        budget, seconds.  A row that is not `offered` has no tick and stands on no front.

    Raises:
        InputError: the scene has no such tool, the tool is several (radii, tilts), or does not fit its organ; or the
            budget ended before there was a row.
        Interrupted: by Ctrl-C while pressing.
    """
    from palpate.author.tradeoff.confirm import confirmed
    from palpate.author.tradeoff.files import write_files
    from palpate.author.tradeoff.knobs import setting_of
    from palpate.author.tradeoff.scene_file import require_scene_path
    from palpate.author.tradeoff.scene_file import write_scene as scene_written
    from palpate.author.tradeoff.sweep import Sweep

    if write_scene is not None:
        require_scene_path(write_scene, scene)
    chosen = scene.tool_named(tool) if tool else scene.tool[0]
    sweep = Sweep(
        scene, chosen, out, progress or SilentProgress(), budget, held_out, workers, executor, solver
    )
    result = sweep.run()
    best = result["recommended"]
    result["confirmed"] = result["scene_written"] = None
    if best is not None:
        row = result["rows"][best]
        if write_scene is not None:
            written = scene_written(scene, setting_of(row["setting"]), write_scene)
            result["scene_written"] = str(written)
        if confirm_seeds:
            result["files"] = write_files(result, out)  # what there is, while many presses more are made
            result["confirmed"] = confirmed(
                sweep, row, confirm_seeds, confirm_points or scene.accuracy.held_out
            )
    result["files"] = write_files(result, out)
    return result
