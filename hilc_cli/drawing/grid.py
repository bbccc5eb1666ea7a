"""Square panels in rows and columns, as many side by side as a sheet has room for."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.drawing.layout import BOTTOM, LEFT, TOP
from hilc_cli.drawing.sheet import room_on
from hilc_cli.results.look import Look

_LEAST_SIDE = 1.5  # of panels on a narrow sheet [inch]


@dataclass(frozen=True, slots=True)
class Grid:
    """Places of square panels, row by row [inch].

    Attributes:
        columns: How many stand in a row.
        side: Of a panel.
        top: Distance from the upper edge of the sheet to the titles of the first row.
    """

    columns: int
    side: float
    top: float

    @property
    def width(self) -> float:
        """Of all panels with their labels."""
        return self.columns * (LEFT + self.side)

    def corner(self, index: int) -> tuple[float, float]:
        """Distances of a panel from the left and the upper edge of the sheet."""
        row, column = divmod(index, self.columns)
        step = self.side + LEFT
        return LEFT + column * step, self.top + TOP + row * (TOP + self.side + BOTTOM)

    def end(self, panels: int) -> float:
        """How far down so many panels with their labels reach."""
        return self.top + -(-panels // self.columns) * (TOP + self.side + BOTTOM)


def grid_on(look: Look, columns: int, side: float, top: float, beside: float) -> tuple[Grid, float]:
    """The places of panels on the sheet that a user asks for, and its width.

    Args:
        look: What the user asks for; where there is no room, fewer and smaller panels stand in a
            row.
        columns: How many stand in a row if nobody asks for a width.
        side: Likewise the side of each [inch].
        top: As of `Grid` [inch].
        beside: Room to the right of the panels [inch].
    """
    grid = Grid(columns, side, top)
    sheet = room_on(look, grid.width + beside)
    room = sheet - beside
    if look.width is not None and room < grid.width:
        columns = max(1, min(columns, int(room / (LEFT + _LEAST_SIDE))))
        grid = Grid(columns, min(side, room / columns - LEFT), top)
    return grid, sheet
