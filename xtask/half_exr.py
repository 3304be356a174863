"""Writes OpenEXR files of 16-bit floats as scan lines, ZIP compressed, without a library. The scripts that make pictures use it."""

import struct
import zlib


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def compressed(raw):
    """Compresses bytes as OpenEXR's ZIP does: separated by parity, as differences plus 128, deflated."""
    halves = raw[0::2] + raw[1::2]
    differences = bytearray(halves[:1])
    differences += bytes((b - a + 128) & 255 for a, b in zip(halves, halves[1:]))
    packed = zlib.compress(bytes(differences), 9)
    return packed if len(packed) < len(raw) else raw


def write(path, comment, channels, rows):
    """Writes rows of pixels. Each pixel has one value for each channel; `channels` are letters in alphabetical order."""
    width, height = len(rows[0]), len(rows)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", 1, 0, 1, 1) for n in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join(
        [
            attribute("channels", "chlist", listed),
            attribute("comments", "string", comment.encode()),
            attribute("compression", "compression", bytes([3])),
            attribute("dataWindow", "box2i", window),
            attribute("displayWindow", "box2i", window),
            attribute("lineOrder", "lineOrder", bytes([0])),
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
            attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
            b"\0",
        ]
    )
    blocks = []
    for first in range(0, height, 16):
        raw = b""
        for row in rows[first : first + 16]:
            for of in range(len(channels)):
                raw += struct.pack(f"<{width}e", *(pixel[of] for pixel in row))
        packed = compressed(raw)
        blocks.append(struct.pack("<ii", first, len(packed)) + packed)
    at = len(header) + 8 * len(blocks)
    offsets = b""
    for block in blocks:
        offsets += struct.pack("<Q", at)
        at += len(block)
    path.write_bytes(header + offsets + b"".join(blocks))
    print(path, path.stat().st_size, "bytes")
