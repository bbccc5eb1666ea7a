"""The one place that turns a figure into a file: the same data gives the same bytes."""

from __future__ import annotations

import re
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hilc_cli.drawing import style
from hilc_cli.drawing.sheet import Sheet
from hilc_cli.errors import UsageError
from hilc_cli.results.folder import PICTURE_FORMATS
from hilc_cli.results.look import USUAL
from hilc_cli.wording import suggestion

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_LEVEL = 3
_INCH = 0.0254  # [m]


def encode_png(pixels: NDArray[np.uint8], dpi: float) -> bytes:
    """Encodes an opaque picture, without dates or versions of anything.

    Args:
        pixels: Red, green and blue of each pixel from the top left on, shape (height, width, 3).
        dpi: Dots per inch.

    Source:
        Portable Network Graphics (PNG) Specification, W3C, sections 5 and 11.
    """
    height, width, _ = pixels.shape
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)  # filter 0 (none) before each row
    rows[:, 1:] = pixels.reshape(height, 3 * width)
    per_meter = round(dpi / _INCH)
    return b"".join(
        [
            _SIGNATURE,
            _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
            _chunk(b"pHYs", struct.pack(">IIB", per_meter, per_meter, 1)),
            _chunk(b"IDAT", zlib.compress(rows.tobytes(), _LEVEL)),
            _chunk(b"IEND", b""),
        ]
    )


def _chunk(kind: bytes, content: bytes) -> bytes:
    checksum = zlib.crc32(kind + content)
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)


FORMATS = PICTURE_FORMATS


def check_format(name: str) -> None:
    """Makes sure that pictures can be saved in a format.

    Raises:
        UsageError: They cannot; names the formats that are known.
    """
    if name not in FORMATS:
        raise UsageError(f"unknown picture format '{name}'; {suggestion(name, FORMATS)}")


def render(figure: Figure, picture_format: str, dpi: int = 150) -> bytes:
    """A figure as the content of a picture file, without dates or versions of anything.

    Args:
        figure: The figure.
        picture_format: One of ``FORMATS``.
        dpi: Dots per inch of a PNG; an SVG or PDF is drawn in lines.

    Raises:
        UsageError: The format is not known.
    """
    check_format(picture_format)
    buffer = BytesIO()
    before = figure.dpi
    scale, look = (figure.scale, figure.look) if isinstance(figure, Sheet) else (1.0, USUAL)
    figure.dpi = dpi * scale
    try:
        # Straight to the canvas: Figure.savefig draws everything twice. The canvases are not typed,
        # and those of the vector formats are imported only where they are needed.
        canvas: Any
        with style.applied(look):
            if picture_format == "png":
                canvas = FigureCanvasAgg(figure)
                canvas.draw()
                return encode_png(np.asarray(canvas.buffer_rgba())[..., :3], dpi)
            if picture_format == "svg":
                from matplotlib.backends.backend_svg import FigureCanvasSVG

                canvas = FigureCanvasSVG(figure)
                canvas.print_svg(buffer, metadata={"Date": None, "Creator": None})
                return _scaled_svg(buffer.getvalue(), scale)
            _print_pdf(figure, buffer, dpi, scale)
    finally:
        figure.dpi = before
    return buffer.getvalue()


_SVG_SIZE = re.compile(rb' (width|height)="([0-9.]+)pt"')


def _scaled_svg(content: bytes, scale: float) -> bytes:
    """An SVG of another size on paper: the lengths within its view box stay as they are."""
    if scale == 1:
        return content

    def scaled(found: re.Match[bytes]) -> bytes:
        return b' %s="%.6gpt"' % (found[1], scale * float(found[2]))

    return _SVG_SIZE.sub(scaled, content, count=2)


def _print_pdf(figure: Figure, buffer: BytesIO, dpi: float, scale: float) -> None:
    """Writes a PDF of one page.

    Args:
        figure: The figure.
        buffer: Where to write.
        dpi: Dots per inch of what is drawn in dots even here.
        scale: How large an inch of the figure is on the page.
    """
    from matplotlib.backends import backend_pdf as pdf

    backend: Any = pdf  # is not typed
    figure.dpi = 72  # points of the page, before it is scaled
    width, height = figure.get_size_inches()
    file = backend.PdfFile(
        buffer, metadata={"CreationDate": None, "Creator": None, "Producer": None}
    )
    try:
        file.newPage(scale * width, scale * height)
        # What lies off the page is left out, before it is scaled.
        file.width, file.height = width, height
        if scale != 1:
            file.output(scale, 0, 0, scale, 0, 0, backend.Op.concat_matrix)
        page = backend.RendererPdf(file, dpi * scale, height, width)
        renderer = backend.MixedModeRenderer(figure, width, height, dpi * scale, page)
        figure.draw(renderer)
        renderer.finalize()
        file.finalize()
    finally:
        file.close()


def save_figure(figure: Figure, path: Path, dpi: int = 150) -> None:
    """Writes a figure, in one go, in the format that the name of the file ends with.

    Args:
        figure: The figure.
        path: The file; its folder must exist.
        dpi: Dots per inch of a PNG.

    Raises:
        UsageError: The name does not end with a known format.
        OSError: The file cannot be written.
    """
    path.write_bytes(render(figure, path.suffix.removeprefix("."), dpi))


def save_pictures(
    pictures: Mapping[str, Callable[[], Figure]], folder: Path, formats: Sequence[str], dpi: int
) -> list[Path]:
    """Draws pictures and writes each to ``NAME.FORMAT``.

    Args:
        pictures: What draws each, by name.
        folder: Where the files go; it must exist.
        formats: Some of ``FORMATS``.
        dpi: Dots per inch of PNG files.

    Returns:
        The files, in the order of pictures and formats.

    Raises:
        UsageError: A format is not known; nothing is drawn then.
        OSError: A file cannot be written.
    """
    for suffix in formats:
        check_format(suffix)
    written = []
    for name, draw in pictures.items():
        figure = draw()
        for suffix in dict.fromkeys(formats):
            path = folder / f"{name}.{suffix}"
            save_figure(figure, path, dpi)
            written.append(path)
    return written
