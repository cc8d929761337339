"""Plots of a page: the data that the script draws, and the drawing in a browser."""

import base64
import dataclasses
import json
import re

import numpy as np
import pytest
from shown.browser import CHROMIUM, document
from shown.driven_browser import DrivenBrowser

from crosscheck.report.html import page
from crosscheck.report.pictures.plot import (
    MAX_STATIC_POINTS,
    MAX_ZOOM_POINTS,
    plot_data,
    plot_picture,
    points_per_curve,
    samples_per_curve,
)
from crosscheck.report.report import Panel, Plot, Report, Section, Series

EPOCH = 1.7e9
"""[s] Stamps of a clock, for which single precision has steps of two minutes."""


def plot(samples, curves=2, **options):
    rng = np.random.default_rng(0)
    series = tuple(Series(f"curve {k}", rng.normal(size=samples)) for k in range(curves))
    panels = Panel("upper", series[:1], "N m"), Panel("lower", series[1:], "N m", height=0.5)
    return Plot(EPOCH + 0.001 * np.arange(samples), "t [s]", panels, "two curves", **options)


def decoded(data):
    """x, and y of every curve."""
    kept = json.loads(data)
    curves = [one["y"] for panel in kept["panels"] for one in panel["series"]]
    x = np.frombuffer(base64.b64decode(kept["x"]), "<f8")
    return x, [np.frombuffer(base64.b64decode(y), "<f4") for y in curves]


def written(*plots):
    report = Report("plots", None, (Section("plots", "Plots", plots),), dict)
    return page(report, ["graphdyn"], {})


class TestData:
    def test_short_curves_are_whole(self):
        original = plot(100)
        x, ys = decoded(plot_data(original))
        np.testing.assert_array_equal(x, original.x)
        for y, panel in zip(ys, original.panels, strict=True):
            np.testing.assert_array_equal(y, panel.series[0].y.astype("<f4"))

    def test_long_curves_keep_extremes_and_gaps(self):
        original = plot(50_000)
        for panel, row in zip(original.panels, (12_345, 45_678), strict=True):
            panel.series[0].y[row] = 100.0
            panel.series[0].y[row + 2] = -100.0
            panel.series[0].y[[row - 1, row + 1, 30_000]] = np.nan  # beside the extremes, too
        x, ys = decoded(plot_data(original, 3000))
        assert 1000 < len(x) <= 3006  # one more for each part with a gap
        assert np.all(np.diff(x) > 0)
        rows = np.searchsorted(original.x, x)
        for y, panel in zip(ys, original.panels, strict=True):
            np.testing.assert_array_equal(y, panel.series[0].y[rows].astype("<f4"))
            assert (y[np.isfinite(y)].min(), y[np.isfinite(y)].max()) == (-100.0, 100.0)
            assert np.isnan(y).any()

    def test_a_page_of_many_plots(self):
        assert samples_per_curve([plot(10)]) == MAX_ZOOM_POINTS
        assert samples_per_curve([]) == MAX_ZOOM_POINTS
        many = [plot(20_000, 3)] * 96
        samples, points = samples_per_curve(many), points_per_curve(many)
        assert 400 < samples < MAX_ZOOM_POINTS
        assert 20 < points < MAX_STATIC_POINTS
        length = len(plot_data(many[0], samples)) + len(plot_picture("p", many[0], points))
        assert 96 * length < 4_500_000

    def test_thinning_is_said(self):
        assert "smallest or largest among their neighbors" not in written(plot(100))
        many = written(plot(7000))
        assert "Of 7000 samples, those are drawn that are smallest or largest" in many
        (data,) = re.findall(r'<script type="application/json">(.*?)</script>', many)
        assert MAX_STATIC_POINTS < len(decoded(data)[0]) <= MAX_ZOOM_POINTS
        longest = max(len(re.findall("[ML] ", path)) for path in re.findall(r' d="([^"]*)"', many))
        assert MAX_STATIC_POINTS < longest <= 2 * MAX_STATIC_POINTS  # of the picture: two for each part

    def test_width(self):
        assert '<div class="block wide">' in written(plot(10))
        assert '<div class="block half">' in written(plot(10, wide=False))


needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")

DRAWN = """new Promise((done) => {
  const look = () => {
    const plots = [...document.querySelectorAll("figure.plot")].map((figure) => figure.plot);
    const ready = document.readyState === "complete" && plots.length && plots.every((plot) => plot?.drawn);
    ready ? done(1) : setTimeout(look, 10);
  };
  look();
})"""

LINES = """(async () => {
  const kept = [], usual = line;
  const panels = [...document.querySelectorAll("figure.plot")].flatMap((figure) => figure.plot.drawn);
  line = (u, color, dash, ...ends) => kept.push([
    panels.indexOf(u), color, dash.length, ...ends.map((pixel, k) => u.posToVal(pixel, "xy"[k % 2], true)),
  ]);
  for (const panel of panels) panel.redraw();
  await new Promise((done) => setTimeout(done, 50));
  line = usual;
  return kept;
})()"""
"""Panel, color, dash and ends [units of the axes] of each line that is drawn beside the curves."""

PANELS = """[...document.querySelectorAll("figure.plot")].flatMap((figure) => figure.plot.drawn.map((u) => ({
  data: u.data, title: u.root.querySelector(".u-title").textContent, height: u.height,
  distributions: [u.scales.x.distr, u.scales.y.distr],
  x: [u.scales.x.min, u.scales.x.max], y: [u.scales.y.min, u.scales.y.max],
  labels: u.axes.map((one) => one.label), ticks: u.axes.map((one) => one._values),
  series: u.series.slice(1).map((one, k) => [
    one.label, one.show, one.width, one.dash !== undefined, one.spanGaps, one.stroke(), one.points.show(u, k + 1, 0, 1),
    one.paths(u, k + 1, 0, 3, () => 0) !== null,
  ]),
  said: u.series.slice(1).map((one) => [0.00123456, 0, 123456, 0.99965e-6, null].map((y) => one.value(u, y))),
})))"""

SHORT = ["0.0012346", "0", "1.23e+5", "1.00e-6", "–"]
"""Numbers of PANELS without and with prefixes."""
PREFIXED = ["1.23 ms", "0 ns", "123000 s", "1 µs", "–"]


@needs_chromium
class TestInABrowser:
    """The script draws every panel on a canvas in place of the static picture: each number at its place."""

    X = np.array([0.0, 0.5, 1.5, 2.0])
    Y = np.array([-1.0, 2.0, np.nan, 4.0])
    LOG_X = np.array([1.0, 10.0, 10.0, 1000.0])
    TIMES = np.array([2e-9, 5e-7, 0.0, 3e-4])

    @pytest.fixture(scope="class")
    @classmethod
    def browser(cls, tmp_path_factory):
        x, y = cls.X, cls.Y
        mixed = (
            Series("line", y, color=2, low=y - 1, high=y + 2),
            Series("broken", 3 * y, "dashed", 9),
            Series("points", 2 * y, "marks", 1, hidden=True, low=y, high=y + 1),
        )
        upper, lower = Panel("torque", mixed, "N m", level=8.0), Panel("time", (Series("a", cls.TIMES),), "s", True)
        lower = dataclasses.replace(lower, prefixes=True, height=0.5)
        gaps = Panel("error", (Series("line", y), Series("m", y, "marks")), "N")
        plots = (
            Plot(x, "t [s]", (upper, lower), "linear", upright=1.0),
            Plot(cls.LOG_X, "samples", (gaps,), "logarithmic", log_x=True),
            plot(9000, wide=False),
        )
        folder = tmp_path_factory.mktemp("plots")
        (folder / "plots.html").write_text(written(*plots), encoding="utf-8")
        with DrivenBrowser(folder / "profile") as browser:
            browser.call("Page.navigate", url=(folder / "plots.html").as_uri())
            browser.value(DRAWN)
            yield browser

    @pytest.fixture(scope="class")
    @classmethod
    def panels(cls, browser):
        return browser.value(PANELS)

    def test_pictures_are_replaced(self, browser):
        assert browser.complaints == []
        assert browser.value("document.querySelectorAll('canvas').length") == 5
        assert browser.value("[...document.querySelectorAll('.still')].map((still) => still.hidden)") == [True] * 3

    def test_curves(self, panels):
        """A gap is a gap; on a logarithmic axis zero is one."""
        none = [None if np.isnan(y) else y for y in self.Y]
        thrice, twice = ([y and factor * y for y in none] for factor in (3, 2))
        assert panels[0]["data"] == [self.X.tolist(), none, thrice, twice]
        times = [None if y == 0 else pytest.approx(y, rel=1e-6) for y in self.TIMES]
        assert panels[1]["data"] == [self.X.tolist(), times]
        assert panels[2]["data"] == [self.LOG_X.tolist(), none, none]

    def test_axes(self, panels):
        """x under the last panel only; the unit beside y, or with its prefix at every number."""
        assert [panel["title"] for panel in panels[:3]] == ["torque", "time", "error"]
        assert [panel["labels"] for panel in panels[:3]] == [["", "N m"], ["t [s]", ""], ["samples", "N"]]
        assert [panel["distributions"] for panel in panels[:3]] == [[1, 1], [1, 3], [3, 1]]  # linear 1, logarithmic 3
        assert [panel["x"] for panel in panels[:3]] == [[0, 2], [0, 2], [1, 1000]]
        assert [panel["height"] for panel in panels[:2]] == [240 + 60, 120 + 60]
        assert panels[2]["ticks"][0] == ["1", "10", "1000"]
        assert [text for text in panels[1]["ticks"][1] if text] == ["100 ns", "10 µs", "1 ms"]
        for panel, low, high in ((panels[0], -3, 12), (panels[1], 2e-9, 3e-4), (panels[2], -1, 4)):
            assert panel["y"][0] <= low < high <= panel["y"][1]

    def test_series(self, browser, panels):
        """Name, shown, width, dashed, across gaps, color, with dots, with a path."""
        colors = browser.value("[0, 1, 2].map((k) => css('--c' + k))")
        assert panels[0]["series"] == [
            ["line", True, 2, False, False, colors[2], True, True],
            ["broken", True, 1.5, True, False, colors[1], True, True],
            ["points", False, 0, False, False, colors[1], True, False],
        ]
        assert panels[2]["series"] == [
            ["line", True, 2, False, True, colors[0], True, True], ["m", True, 0, False, False, colors[0], True, False]
        ]  # fmt: skip
        assert [one[6] for panel in panels[3:] for one in panel["series"]] == [False, False]
        assert [panel["said"][0] for panel in panels[:3]] == [SHORT, PREFIXED, SHORT]

    def test_lines_beside_the_curves(self, browser, panels):
        """The level, the instant, and a bar at each point of a curve that is shown and has a value."""
        ink, middle, color = browser.value("['--ink', '--middle', '--c2'].map(css)")
        kept = browser.value(LINES)
        assert [line[:3] for line in kept] == [
            [0, ink, 2], [0, middle, 0], *[[0, color, 0]] * 3, [1, middle, 0]
        ]  # fmt: skip
        ends = [[0, 8, 2, 8], [1, panels[0]["y"][1], 1, panels[0]["y"][0]]]
        ends += [[x, y - 1, x, y + 2] for x, y in zip(self.X, self.Y, strict=True) if np.isfinite(y)]
        for line, expected in zip(kept, ends, strict=False):
            assert line[3:] == pytest.approx(expected, abs=1e-9)
        assert kept[-1][3:] == pytest.approx([1, panels[1]["y"][1], 1, panels[1]["y"][0]])

    def test_zoom_and_hidden_curves(self, browser):
        """A zoom of one panel is one of all of its plot; a curve that is switched on gets its bars."""
        found = browser.value(
            """(async () => {
              const [first, second] = [...document.querySelectorAll("figure.plot")].map((figure) => figure.plot.drawn);
              first[0].setScale("x", { min: 0.5, max: 1.5 });
              await new Promise((done) => setTimeout(done, 50));
              return [first[1], second[0]].map((panel) => [panel.scales.x.min, panel.scales.x.max]);
            })()"""
        )
        assert found == [[0.5, 1.5], [1, 1000]]
        browser.value("document.querySelector('figure.plot').plot.drawn[0].setSeries(3, { show: true })")
        assert sum(line[0] == 0 and line[2] == 0 for line in browser.value(LINES)) == 1 + 2 * 3


PROBE = """<!DOCTYPE html><html><body><iframe src="plots.html" style="border:0;width:1200px;height:800px"></iframe>
<script>
onload = () => {
  const page = document.querySelector("iframe"), figure = page.contentDocument.querySelector("figure.plot");
  const [panel] = figure.plot.drawn, said = document.body.dataset;
  said.range = [panel.scales.y.min, panel.scales.y.max].join(" ");
  const name = figure.querySelector(".u-legend .u-series:nth-child(2) th");
  const press = () => name.dispatchEvent(new page.contentWindow.KeyboardEvent("keydown", { key: "Enter" }));
  press(); said.off = panel.series[1].show;
  press(); said.on = panel.series[1].show;
  panel.setScale("x", { min: 10, max: 20 });
  page.style.width = "900px";
  page.contentDocument.body.getBoundingClientRect();  // lay it out, and tell it now: a busy browser does so too late
  page.contentWindow.dispatchEvent(new Event("resize"));
  setTimeout(() => { said.zoom = [panel.scales.x.min, panel.scales.x.max, panel.width < 1000].join(" "); }, 300);
};
</script></body></html>
"""


@needs_chromium
def test_bound_keyboard_and_zoom(tmp_path):
    """A bound far above its curve is in view; Enter switches a curve; a zoom outlives another width of the window."""
    x = np.linspace(0, 100, 200)
    panel = Panel("error", (Series("torque", 1e-16 + 1e-17 * np.sin(x)),), log=True, level=1e-9)
    (tmp_path / "plots.html").write_text(written(Plot(x, "state", (panel,), "errors")), encoding="utf-8")
    (tmp_path / "probe.html").write_text(PROBE, encoding="utf-8")
    shown = document((tmp_path / "probe.html").as_uri(), tmp_path / "profile")
    said = dict(re.findall(r'data-(\w+)="([^"]*)"', shown))
    low, high = map(float, said["range"].split())
    assert low <= 1.1e-16
    assert high >= 1e-9
    assert (said["off"], said["on"]) == ("false", "true")
    assert said["zoom"] == "10 20 true"
