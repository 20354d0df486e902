"""Tables as text, as Markdown and as JSON."""
import math

NONE = "–"


class Table:
    def __init__(self, header, title=""):
        self.header, self.title, self.rows = list(header), title, []

    def add(self, *cells):
        if len(cells) != len(self.header):
            raise ValueError(f"a row of {len(cells)} cells in a table of {len(self.header)} columns")
        self.rows.append([str(cell) for cell in cells])

    def text(self):
        widths = [max(len(row[i]) for row in [self.header, *self.rows]) for i in range(len(self.header))]
        lines = ["  ".join(cell.ljust(w) if i == 0 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths))).rstrip()
                 for row in [self.header, *self.rows]]
        return "\n".join(([self.title, ""] if self.title else []) + lines) + "\n"

    def markdown(self):
        lines = ["| " + " | ".join(row) + " |" for row in [self.header, *self.rows]]
        lines.insert(1, "|---" + "|---:" * (len(self.header) - 1) + "|")
        return "\n".join(([f"## {self.title}", ""] if self.title else []) + lines) + "\n"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def fixed(value, digits, factor=1.0):
    return f"{factor * value:.{digits}f}" if is_number(value) else NONE


def significant(value, factor=1.0):
    """Three significant digits, without an exponent."""
    if not is_number(value):
        return NONE
    value *= factor
    digits = 2 if value == 0 else max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:.{digits}f}"


def both(a, b):
    return NONE if NONE in (a, b) else f"{a} / {b}"
