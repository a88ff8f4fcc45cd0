#!/usr/bin/env python3
"""Writes the badly meshed parts of verify/stability/parts: a capsule with slivers, and one with corners of 4, 8 and 10 edges.

Usage: scripts/hard_surfaces.py
"""

import math
import struct
from pathlib import Path

RADIUS, LENGTH = 8.0, 40.0  # mm; of the capsule, its round ends included


def capsule(arc):
    """Radius and height of the capsule at the arc length `arc` (mm) from its lower pole."""
    quarter = 0.5 * math.pi * RADIUS
    straight = LENGTH - 2.0 * RADIUS
    if arc < quarter:
        angle = arc / RADIUS
        return RADIUS * math.sin(angle), RADIUS * (1.0 - math.cos(angle))
    if arc < quarter + straight:
        return RADIUS, RADIUS + arc - quarter
    angle = (arc - quarter - straight) / RADIUS
    return RADIUS * math.cos(angle), LENGTH - RADIUS + RADIUS * math.sin(angle)


def revolved(arcs, meridians, jack):
    """Triangles between rings at `arcs`, closed by fans at the poles; with `jack` the diagonals alternate."""
    rings = []
    for arc in arcs:
        radius, height = capsule(arc)
        angles = [2.0 * math.pi * k / meridians for k in range(meridians)]
        rings.append([(radius * math.cos(a), radius * math.sin(a), height) for a in angles])
    bottom, top = (0.0, 0.0, 0.0), (0.0, 0.0, LENGTH)
    triangles = []
    for k in range(meridians):
        n = (k + 1) % meridians
        triangles.append((bottom, rings[0][n], rings[0][k]))
        triangles.append((top, rings[-1][k], rings[-1][n]))
        for i in range(len(rings) - 1):
            a, b, c, d = rings[i][k], rings[i][n], rings[i + 1][n], rings[i + 1][k]
            if jack and (i + k) % 2:
                triangles += [(a, b, d), (b, c, d)]
            else:
                triangles += [(a, b, c), (a, c, d)]
    return triangles


def write(name, triangles):
    """Writes a binary STL; normals are left to the reader."""
    path = Path(__file__).parent.parent / "verify" / "stability" / "parts" / name
    with open(path, "wb") as file:
        file.write(b"made by scripts/hard_surfaces.py".ljust(80))
        file.write(struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *(x for corner in triangle for x in corner), 0))


def main():
    total = math.pi * RADIUS + LENGTH - 2.0 * RADIUS
    # Rings in pairs 0.15 mm apart: triangles of 3.1 x 0.15 mm between them.
    coarse = [total * (k + 0.5) / 15 for k in range(15)]
    write("slivers.stl", revolved(sorted(coarse + [arc + 0.15 for arc in coarse]), 16, False))
    write("valence_10.stl", revolved([total * (k + 1) / 12 for k in range(11)], 10, True))


main()
