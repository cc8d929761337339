"""Plots of a page: the data that the script draws, and the drawing in a browser."""

import base64
import json
import re

import numpy as np
import pytest
from shown.browser import CHROMIUM, document

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
            panel.series[0].y[30_000] = np.nan
        x, ys = decoded(plot_data(original, 3000))
        assert 1000 < len(x) <= 3002  # one more per curve for its gap
        assert np.all(np.diff(x) > 0)
        rows = np.searchsorted(original.x, x)
        for y, panel in zip(ys, original.panels, strict=True):
            np.testing.assert_array_equal(y, panel.series[0].y[rows].astype("<f4"))
            assert y[np.isfinite(y)].max() == 100.0
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
        assert "Of 7000 samples, those are drawn that are smallest or largest" in written(plot(7000))

    def test_width(self):
        assert '<div class="block wide">' in written(plot(10))
        assert '<div class="block half">' in written(plot(10, wide=False))


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_in_a_browser(tmp_path):
    """The script draws every panel on a canvas in place of the static picture, without complaint."""
    (tmp_path / "plots.html").write_text(written(plot(500), plot(9000, wide=False)), encoding="utf-8")
    shown = document((tmp_path / "plots.html").as_uri(), tmp_path / "profile")
    assert shown.count("<canvas") == 4
    assert shown.count('<div class="still scroll" hidden="">') == 2


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


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
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
