"""lab stanford: bounds over errors of messages, as the diagram that is named after Stanford."""
import collections
import csv
import math
import pathlib

from laboratory.program import LabError

HELP = "Draw the bounds of VALID messages over their errors, with the alert limits"
EXAMPLES = """  cartvo evaluate out/odometry.csv truth.tum --messages messages.csv
  lab/lab stanford messages.csv --output stanford.svg"""
CELLS_PER_DECADE = 20
QUANTITIES = {"velocity": ("m/s", 1.0, 0), "angular_rate": ("deg/s", math.degrees(1.0), 1)}  # unit, factor, index of the limit


def add_options(parser):
    parser.add_argument("messages", nargs="+", type=pathlib.Path, metavar="MESSAGES", help="files of cartvo evaluate --messages")
    parser.add_argument("--alert-limits", default="0.7,12,0.2,1.5", metavar="V,RATE,MOTION,ROTATION", help="default: those of cartvod")
    parser.add_argument("--output", type=pathlib.Path, metavar="FILE", help="SVG to write (default: the terminal)")


def text(options):
    cells = {quantity: collections.Counter() for quantity in QUANTITIES}
    for file in options.messages:
        with open(file, newline="") as rows:
            try:
                count_cells(cells, csv.DictReader(rows))
            except KeyError as column:
                raise LabError(f"{file}: has no column {column}; expected a file of cartvo evaluate --messages") from None
    return stanford(cells, [float(limit) for limit in options.alert_limits.split(",")])


def cell_of(factor, value):
    return round(CELLS_PER_DECADE * math.log10(min(max(factor * float(value or 0.0), 1e-4), 1e4)))


def count_cells(cells, messages):
    """Counts the components of VALID messages by the logarithms of error and bound."""
    for message in messages:
        for quantity, (_, factor, _) in QUANTITIES.items():
            for axis in "xyz":
                error, bound = message[f"{quantity}_error_{axis}"], message[f"{quantity}_bound_{axis}"]
                if message["valid"] == "1" and error:
                    cells[quantity][cell_of(factor, error), cell_of(factor, bound)] += 1


def stanford(cells, limits):
    """An SVG: error to the right, bound upwards, with the alert limits; below the diagonal an error is above its bound."""
    side, parts = 420, []
    for left, (quantity, (unit, _, index)) in zip((70, 70 + 420 + 90), QUANTITIES.items()):
        limit, counts = limits[index], cells[quantity]
        low = math.floor(math.log10(limit)) - 3
        decades = max(5, math.ceil(max((max(place) for place in counts), default=0) / CELLS_PER_DECADE) - low)

        def at(error, bound):
            return left + side * min(max((error - low) / decades, 0), 1), 50 + side * (1 - min(max((bound - low) / decades, 0), 1))

        def line(a, b, style):
            (x1, y1), (x2, y2) = at(*a), at(*b)
            parts.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {style}/>')

        parts.append(f'<text x="{left}" y="30">bound ({unit}) over error ({unit}): {quantity.replace("_", " ")}</text>')
        for decade in range(low, low + decades + 1):
            line((decade, low), (decade, low + decades), 'stroke="#ddd"')
            line((low, decade), (low + decades, decade), 'stroke="#ddd"')
            (x, _), (_, y) = at(decade, low), at(low, decade)
            parts.append(f'<text x="{x:.1f}" y="{50 + side + 18}" text-anchor="middle">{10.0 ** decade:g}</text>')
            parts.append(f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0 ** decade:g}</text>')
        most = math.log(1 + max(counts.values(), default=1))
        for (error, bound), count in sorted(counts.items()):
            x, y = at(error / CELLS_PER_DECADE, bound / CELLS_PER_DECADE)
            colour = "#d55e00" if error > bound else "#0072b2"
            opacity = 0.2 + 0.8 * math.log(1 + count) / most
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4" fill="{colour}" opacity="{opacity:.2f}"/>')
        level = math.log10(limit)
        line((low, low), (low + decades, low + decades), 'stroke="#222"')
        line((low, level), (low + decades, level), 'stroke="#009e73" stroke-dasharray="6 4"')
        line((level, low), (level, low + decades), 'stroke="#009e73" stroke-dasharray="6 4"')
    return ('<svg xmlns="http://www.w3.org/2000/svg" width="1020" height="510" font-family="sans-serif" font-size="13">'
            '<rect width="1020" height="510" fill="white"/>' + "".join(parts) + "</svg>\n")
