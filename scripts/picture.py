#!/usr/bin/env python3
"""Draws the designs of a run's front at rest, bent, and pressing on the plane.

Usage: scripts/picture.py RUN_FOLDER PICTURE.png      (needs meshio, numpy and matplotlib from PyPI)
"""
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

ROWS = [("path", "at rest", 0), ("path", "bent", -1), ("path_blocked", "blocked", -1)]
LIGHT = np.array([-0.5, -0.7, 0.5]) / np.linalg.norm([-0.5, -0.7, 0.5])


def shaded(axes, file):
    mesh = meshio.read(file)
    cells = mesh.cells_dict
    # Quadratic triangles as the four between their six points.
    six = cells.get("triangle6", np.empty((0, 6), int))
    parts = [six[:, part] for part in ([0, 3, 5], [1, 4, 3], [2, 5, 4], [3, 4, 5])]
    corners = mesh.points[np.vstack([cells.get("triangle", np.empty((0, 3), int)), *parts])]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    shade = 0.45 + 0.55 * (0.5 + 0.5 * normals @ LIGHT)
    colors = np.outer(shade, [0.55, 0.7, 0.9])
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=colors, edgecolors=(0, 0, 0, 0.15), linewidths=0.2)
    )
    axes.set(xlim=(-75, 25), ylim=(-30, 30), zlim=(0, 90))
    axes.set_box_aspect((100, 60, 90), zoom=1.2)
    axes.view_init(8, -80)
    axes.set_axis_off()


def main(run, picture):
    designs = sorted(path for path in Path(run, "front").iterdir() if path.is_dir())[:6]
    figure = plt.figure(figsize=(2.2 * len(designs), 7.5))
    for column, design in enumerate(designs):
        for row, (name, title, frame) in enumerate(ROWS):
            place = row * len(designs) + column + 1
            axes = figure.add_subplot(len(ROWS), len(designs), place, projection="3d")
            shaded(axes, sorted(design.glob(f"{name}_[0-9]*.vtu"))[frame])
            axes.set_title(f"{design.name}, {title}", fontsize=8)
    figure.subplots_adjust(0, 0, 1, 0.97, 0, 0.05)
    figure.savefig(picture, dpi=90)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
