"""Style of every picture of a run: one palette, and plotly figures as plain data.

Colours are of Okabe and Ito's colour-blind-safe palette (https://jfly.uni-koeln.de/color/).
"""

from typing import Any

import numpy as np

from drawbar.geometry import Floats

TRACTOR = "#0072B2"
TRAILER = "#D55E00"
ESTIMATOR = "#009E73"
KINK = "#CC79A7"
REFERENCE = "#6B7280"
MEASURED = "#A3ACB8"
INK = "#1F2933"
GRID = "#E8EBEF"
BODY_COLOURS = {"tractor": TRACTOR, "trailer": TRAILER}
FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif'

Figure = dict[str, Any]
"""a plotly figure: {"data": traces, "layout": layout}; numpy arrays inside"""

_DECIMALS = 5


def line(x: Floats, y: Floats, name: str, colour: str, **options: Any) -> dict[str, Any]:
    """Return a plotly line trace, with a gap where y is NaN; `width` and `dash` are its line's options."""
    stroke = {"color": colour, "width": options.pop("width", 1.6), "dash": options.pop("dash", "solid")}
    trace = {"type": "scatter", "mode": "lines", "name": name, "line": stroke}
    return trace | {"x": np.round(x, _DECIMALS), "y": np.round(y, _DECIMALS)} | options


def axis(title: str, **options: Any) -> dict[str, Any]:
    """Return a plotly axis with a title that names its unit."""
    look = {
        "gridcolor": GRID,
        "zerolinecolor": "#C5CCD5",
        "linecolor": "#C5CCD5",
        "ticks": "outside",
        "ticklen": 4,
    }
    return look | {"title": {"text": title, "standoff": 8}, "tickcolor": "#C5CCD5"} | options


def layout(x: dict[str, Any], y: dict[str, Any], **options: Any) -> dict[str, Any]:
    """Return the layout that all figures share."""
    shared: dict[str, Any] = {
        "font": {"family": FONT, "size": 13, "color": INK},
        "margin": {"l": 64, "r": 16, "t": 56, "b": 48},
        "paper_bgcolor": "#FFFFFF",
        "plot_bgcolor": "#FFFFFF",
        "hoverlabel": {
            "bgcolor": "#FFFFFF",
            "bordercolor": "#C5CCD5",
            "font": {"family": FONT, "size": 12, "color": INK},
        },
        "legend": {"orientation": "h", "x": 0, "y": 1.1, "yanchor": "bottom"},
    }
    return shared | {"xaxis": x, "yaxis": y} | options
