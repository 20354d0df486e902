"""Draws charts: panels one above the other with a common x axis. Needs matplotlib."""
import dataclasses
import io
import logging
import re
import warnings

import numpy as np

from evaluation.program import EvaluationError

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # not where it keeps its cache
try:
    import matplotlib
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogFormatter
except ImportError as missing:
    raise EvaluationError(f"plots and reports need matplotlib ({missing}); install Debian's package python3-matplotlib, or leave out --plot, "
                          "--report and --figures-dir") from None

# Colours that readers with colour blindness can tell apart (M. Okabe, K. Ito, 2008).
INK, GRID, BLUE, RED, GREEN = "#222222", "#dedede", "#0072b2", "#d55e00", "#009e73"
OF_ESTIMATES = (BLUE, "#e69f00", GREEN, "#cc79a7", "#56b4e9", "#a67619")
PAGE_COLOURS = {INK: "var(--ink)", GRID: "var(--grid)", BLUE: "var(--blue)", RED: "var(--red)", GREEN: "var(--green)"}
PIXELS_PER_INCH, WIDTH = 100, 600  # px of a chart; a .png has twice as many
SETTINGS = {"svg.fonttype": "none", "svg.hashsalt": "cartvo", "font.size": 8, "axes.titlesize": 8, "axes.grid": True, "grid.color": GRID,
            "axes.edgecolor": GRID, "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
            "axes.formatter.useoffset": False, "axes.axisbelow": True, "lines.linewidth": 1.2, "lines.markersize": 3, "legend.frameon": False,
            "text.parse_math": False}
STYLES = {"line": ("-", ""), "dashed": ("--", ""), "dots": ("", "o")}


@dataclasses.dataclass
class Series:
    """Values over x; one that is not finite interrupts the line."""
    name: str  # in the legend
    colour: str
    x: np.ndarray
    y: np.ndarray
    style: str = "line"


@dataclasses.dataclass
class Panel:
    """A y axis with its curves."""
    title: str  # with the unit
    series: list
    height: int  # px
    band: Series | None = None  # an area; y: (n, 2) from and to
    is_logarithmic: bool = False
    contains_zero: bool = False  # whether the axis begins at 0; no value is below


@dataclasses.dataclass
class Chart:
    name: str  # of its files, without extension
    title: str
    x_title: str
    panels: list
    caption: str
    columns: list  # of a table of its numbers
    rows: list
    marked: list = dataclasses.field(default_factory=list)  # (from, to) of the x axis that red bars show
    marked_name: str = ""
    has_equal_scale: bool = False  # x and y have the same unit and scale
    is_x_logarithmic: bool = False


def drawable(values):
    """Values that axes can have; others interrupt a line."""
    return np.where(np.abs(values) < 1e12, values, np.nan)


def reduced(band, most=1500):
    """A band of many points as the hull of neighbours that one pixel shows."""
    size = -(-len(band.x) // most)
    parts, limits = [slice(i, i + size) for i in range(0, len(band.x), size)], drawable(band.y)
    return band.x[::size], np.array([limits[part, 0].min() for part in parts]), np.array([limits[part, 1].max() for part in parts])


def write_plain_numbers(axis):
    """Logarithmic axes would write powers as formulas, which "text.parse_math" leaves undrawn."""
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(LogFormatter())


def draw_panel(axes, panel, chart):
    """Returns the entries of the legend by their name."""
    entries = {}
    for series in panel.series:
        line, marker = STYLES[series.style]
        entries[series.name] = axes.plot(series.x, drawable(series.y), linestyle=line, marker=marker, color=series.colour)[0]
    if panel.is_logarithmic:
        axes.set_yscale("log")
        write_plain_numbers(axes.yaxis)
    if chart.is_x_logarithmic:
        axes.set_xscale("log")
        write_plain_numbers(axes.xaxis)
    if chart.has_equal_scale:
        axes.set_aspect("equal", "datalim")
    low, high = axes.get_ylim()
    if panel.contains_zero:
        axes.set_ylim(bottom=0.0)
    if panel.band:
        entries[panel.band.name] = axes.fill_between(*reduced(panel.band), color=panel.band.colour, alpha=0.2, linewidth=0)
    if panel.band and not panel.is_logarithmic:  # of wide bands the part near the series is visible
        axes.set_ylim(1.3 * low - 0.3 * high, 1.3 * high - 0.3 * low)
    for start, end in chart.marked:
        entries[chart.marked_name] = axes.axvspan(start, end, 0.0, 0.05, color=RED, linewidth=0)
    axes.set_title(panel.title, loc="left")
    entries.pop("", None)
    return entries


def draw(charts):
    """A figure of charts one below the other."""
    heights = [panel.height for chart in charts for panel in chart.panels]
    height = sum(heights) + 38 * len(heights) + 60 * len(charts)  # px, with titles and legends
    figure = Figure(figsize=(WIDTH / PIXELS_PER_INCH, height / PIXELS_PER_INCH), dpi=PIXELS_PER_INCH, layout="constrained")
    all_axes = iter(figure.subplots(len(heights), 1, squeeze=False, gridspec_kw={"height_ratios": heights})[:, 0])
    for chart in charts:
        entries, first = {}, None
        for panel in chart.panels:
            axes = next(all_axes)
            if first:
                axes.sharex(first)
            first = first or axes
            entries = {**draw_panel(axes, panel, chart), **entries}
        first.set_title(f"{chart.title}\n{chart.panels[0].title}", loc="left")
        axes.set_xlabel(chart.x_title)
        if entries:  # below the title of the x axis
            columns = 4 if max(map(len, entries)) < 30 else 1
            axes.legend(entries.values(), entries.keys(), loc="upper left", bbox_to_anchor=(-0.1, 0.0), ncol=columns, borderaxespad=4.5)
    return figure


def picture(charts, kind):
    """The charts as the bytes of an "svg" or a "png"."""
    matplotlib.rcdefaults()
    contents = io.BytesIO()
    with matplotlib.rc_context(SETTINGS), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        metadata = {"Date": None} if kind == "svg" else None
        draw(charts).savefig(contents, format=kind, dpi=PIXELS_PER_INCH * (2 if kind == "png" else 1), metadata=metadata)
    return contents.getvalue()


def svg_element(svg, title):
    """A chart's SVG for an HTML page: with an escaped title for screen readers and the page's colours, without a background."""
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", svg[svg.index(b"<svg"):].decode(), flags=re.S)
    text = re.sub(r' id="[\w.]+_\d+"', "", text).replace("fill: #ffffff", "fill: none")
    for colour, name in PAGE_COLOURS.items():
        text = text.replace(colour, name)
    return text.replace(">", f' role="img"><title>{title}</title>', 1)
