"""Whether every robot of the catalog and the shared files is shown in headless Chromium, and how quickly.

Per robot: triangles, size of the page [kB], time until it is ready [s], frames per second in software rendering (each
one read back after a seek). The exit code is the number of robots that load and are not shown.
`--play RUN ROBOT` measures one page with a run instead.
"""

import sys
import tempfile
import time
import warnings
from pathlib import Path

from shared_data import ARMS
from shown.driven_browser import DrivenBrowser

import urdf
from crosscheck.recordings import differentiated, load_recording
from crosscheck.viewing.figures import Figure
from crosscheck.viewing.motions import recorded_motion
from crosscheck.viewing.page import page
from crosscheck.viewing.robots import shown_robot

FACES = 12000

FRAMES = """(() => {
  const gl = player.stage.renderer.getContext(), pixel = new Uint8Array(4), count = 20, start = performance.now();
  for (let k = 0; k < count; k++) {
    player.seek((k / count) * player.figures[0].duration);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  }
  return (1000 * count) / (performance.now() - start);
})()"""


def figure_of(robot, run=None):
    model = urdf.load(robot)
    shown = shown_robot(robot, model, urdf.Reading(), FACES)
    if run is None:
        return Figure(Path(robot).name, shown)
    recording = load_recording(run, joints=model.independent_joints)
    if recording.v is None or recording.a is None:
        recording = differentiated(recording, "residual")
    return Figure(Path(robot).name, shown, *recorded_motion(model, recording))


def measured(browser, file, figure):
    """Whether the page of a figure is shown without complaint, and its numbers in words."""
    file.write_text(page(figure.name, [figure]), encoding="utf-8")
    start = time.perf_counter()
    browser.open(file.as_uri())
    ready = time.perf_counter() - start
    browser.value(FRAMES)
    frames = browser.value(FRAMES)
    triangles = browser.value("player.stage.renderer.info.render.triangles")
    is_shown = triangles > 0 and not browser.complaints and browser.requests == [file.as_uri()]
    words = f"{triangles:6} triangles {file.stat().st_size / 1000:6.0f} kB  ready {ready:4.1f} s {frames:5.1f} frames/s"
    return is_shown, words, browser.complaints


def main():
    warnings.simplefilter("ignore")
    files = [str(path) for path in sorted(ARMS.glob("*.urdf"))]
    asked = [(robot, None) for robot in (*files, *(entry.name for entry in urdf.robots()))]
    if sys.argv[1:2] == ["--play"]:
        asked = [(sys.argv[3], sys.argv[2])]
    failed = 0
    with tempfile.TemporaryDirectory() as folder, DrivenBrowser(f"{folder}/profile") as browser:
        for robot, run in asked:
            try:
                figure = figure_of(robot, run)
            except urdf.URDFError as error:
                print(f"{Path(robot).name:36} refused: {error}", flush=True)
                continue
            is_shown, words, complaints = measured(browser, Path(folder) / "view.html", figure)
            failed += not is_shown
            missing = sum("is not shown" in note for note in figure.robot.notes)
            told = f", {missing} shapes missing" if missing else ""
            print(f"{Path(robot).name:36} {words}{told}{'' if is_shown else f'  NOT SHOWN: {complaints}'}", flush=True)
    return failed
