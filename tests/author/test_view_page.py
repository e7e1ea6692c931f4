# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser without a screen: load, choose a tool, press, drag, read the force, look."""

from __future__ import annotations

import io
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from viewed_organ import TOOLS, write_two_tools

from palpate.author.view.curve import curve_at
from palpate.author.view.place import on_field
from palpate.author.view.scenery import start_place
from palpate.author.view.viewed import viewed

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""WebGL on the processor."""
PATIENCE = 300e3
"""ms; a busy machine without a GPU may take minutes for what takes seconds on a quiet one."""
PLOTLY_RACE = "_redrawFromAutoMarginCount"
"""On a slow machine viser docks the panel, and with it removes the plot, while plotly draws it; it is drawn anew."""
VIEW = "from palpate.author.command_line import main; raise SystemExit(main())"


@pytest.fixture
def served(tmp_path: Path) -> Iterator[tuple[Path, str, subprocess.Popen[str]]]:
    """The asset, the page's address, and the command that serves it."""
    asset = write_two_tools(tmp_path / "ellipsoid")
    command = [sys.executable, "-c", VIEW, "view", str(asset), "--port", "0", "--no-browser", "--json"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("palpate: http"):
                yield asset, line.split()[1], process
                break
        else:
            raise AssertionError(f"no address; exit code {process.wait()}")
    finally:
        process.kill()
        process.communicate()


def reading(page: Any, condition: str) -> dict[str, str]:
    """What the page's readings say when they fulfil a condition on their data attributes `d`."""
    told = "(() => { const e = document.querySelector('#palpate'); return e && {...e.dataset}; })()"
    page.wait_for_function(f"(() => {{ const d = {told}; return d && ({condition}); }})()")
    return page.evaluate(told)


def test_a_person_chooses_a_tool_presses_drags_and_reads_the_force(
    served: tuple[Path, str, subprocess.Popen[str]],
) -> None:
    browsers = pytest.importorskip("playwright.sync_api", reason="the package playwright is not installed")
    executable = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if executable is None:
        pytest.skip(f"no browser here: none of {', '.join(BROWSERS)}")
    asset, url, process = served
    with browsers.sync_playwright() as tools:
        browser = tools.chromium.launch(executable_path=executable, args=SOFTWARE, timeout=PATIENCE)
        page = browser.new_page(viewport={"width": 900, "height": 640})
        page.set_default_timeout(PATIENCE)
        problems: list[str] = []
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.goto(url, wait_until="commit")
        assert reading(page, "d.ticks > 0")["tool"] == TOOLS[0]

        page.get_by_role("textbox", name="Tool").or_(page.locator(f"input[value='{TOOLS[0]}']")).first.click()
        page.get_by_role("option", name=TOOLS[1]).click()
        reading(page, f"d.tool === '{TOOLS[1]}'")

        slider = page.get_by_role("slider").first
        slider.focus()
        slider.press("End")
        pressed = reading(page, "d.contact === '1' && d.depth > 4.9e-3")
        tool = viewed(asset).tools[TOOLS[1]]
        place = on_field(tool, start_place(tool))
        depth, force = curve_at(tool, place.point, place.normal)
        said = float(np.interp(float(pressed["depth"]), depth, force))
        assert float(pressed["force"]) == pytest.approx(said, rel=0.02)

        moves = int(pressed["moves"])
        box = page.locator("canvas").first.bounding_box()
        x, y = box["x"] + 0.4 * box["width"], box["y"] + 0.65 * box["height"]  # beside the gizmo
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 30, y + 10, steps=6)
        page.mouse.up()
        dragged = reading(page, f"d.moves > {moves} && d.contact === '1' && d.slipped > 0")
        assert dragged["force"] != pressed["force"]
        picture = page.screenshot(timeout=PATIENCE)
        browser.close()
    if where := os.environ.get("PALPATE_SCREENSHOT"):
        Path(where).write_bytes(picture)
    assert [problem for problem in problems if PLOTLY_RACE not in problem] == []
    pixels = matplotlib.image.imread(io.BytesIO(picture))[:, :, :3]
    scene = pixels[: int(box["height"]), : int(box["width"])]
    assert len(np.unique((32 * scene).astype(int).reshape(-1, 3), axis=0)) > 30  # a map in its colours
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    answer = json.loads(out)
    assert process.returncode == (0 if answer["met"] else 1)
    assert answer["tool"] == TOOLS[1] and answer["contact_ticks"] > 0 and answer["slip_ticks"] > 0
