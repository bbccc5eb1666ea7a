"""A PNG encoder for line drawings: smaller files than Matplotlib's, in half the time.

Pillow tries five filters on each row of pixels. On large even areas none of them pays, and five
pictures must not keep ``hilc run`` waiting.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

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
