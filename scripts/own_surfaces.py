#!/usr/bin/env python3
"""Ten triangulations of four shapes of known volume, simulated: how far the answers are from those of a fine mesh.

Usage: scripts/own_surfaces.py PNEUMORPH FOLDER [SHAPE ...]     needs no packages; writes FOLDER/*.stl, *.toml, *.json, prints a table

A shape is a profile that is turned about z, its sections scaled: capped cylinder, square box, capsule, bellows that bends.
The reference is a fine triangulation of the shape, meshed anew at three sizes (`refined`); for the box also CalculiX, some 2550 mm^3.
"""

import json
import math
import random
import struct
import subprocess
import sys
from pathlib import Path

TURN = 2.0 * math.pi


class Shape:
    """`corners`: the profile (radius, height) from the lower to the upper pole; `section(angle, height)`: scale of its radius."""

    def __init__(self, name, corners, section, edges, pressure, volume):
        self.name, self.corners, self.section, self.edges = name, corners, section, edges
        self.pressure, self.volume = pressure, volume
        # The profile as a program writes it that puts points only where it bends.
        self.sparse = capsule_profile(8.0, 80.0, 8) if name == "capsule" else corners

    def point(self, profile, angle):
        radius, height = profile
        radius *= self.section(angle, height)
        return (radius * math.cos(angle), radius * math.sin(angle), height)

    def level(self, p):
        """A field whose zero level is the shape: the radius over that of the profile, and the heights of the ends."""
        height = p[2]
        low, high = self.corners[0][1], self.corners[-1][1]
        radius = radius_at(self.corners, min(max(height, low + 1e-9), high - 1e-9))
        radius *= self.section(math.atan2(p[1], p[0]), height)
        return max(math.hypot(p[0], p[1]) - radius, low - height, height - high)


def radius_at(corners, height):
    """The profile's radius at a height between its ends."""
    for (r, a), (q, b) in zip(corners, corners[1:]):
        if a <= height <= b and b > a:
            return r + (q - r) * (height - a) / (b - a)
    raise ValueError(height)


def stations(corners, step, keep):
    """Points of the profile about `step` apart, with those of its corners where it turns by more than `keep` degrees."""
    found = [corners[0]]
    lengths = [math.dist(a, b) for a, b in zip(corners, corners[1:])]
    turns = [0.0] + [abs(turn(*corners[i : i + 3])) for i in range(len(corners) - 2)] + [0.0]
    start = 0
    for end in range(1, len(corners)):
        if end < len(corners) - 1 and math.degrees(turns[end]) < keep:
            continue
        piece, total = corners[start : end + 1], sum(lengths[start:end])
        count = max(1, round(total / step))
        found += [along(piece, total * k / count) for k in range(1, count + 1)]
        start = end
    return found


def turn(a, b, c):
    return math.remainder(math.atan2(c[1] - b[1], c[0] - b[0]) - math.atan2(b[1] - a[1], b[0] - a[0]), TURN)


def along(points, way):
    for a, b in zip(points, points[1:]):
        length = math.dist(a, b)
        if way <= length * (1 + 1e-12) or b is points[-1]:
            t = min(1.0, way / length)
            return (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))
        way -= length
    return points[-1]


def ring_angles(shape, count, graded=False):
    """Angles of a ring of about `count` points, those of the section's edges among them."""
    starts = shape.edges or [0.0]
    each = max(1, round(count / len(starts)))
    angles = []
    for a, b in zip(starts, starts[1:] + [starts[0] + TURN]):
        for k in range(each):
            t = k / each
            if graded:
                t = t**2.2
            if shape.edges:  # equal steps along the straight side
                side = math.tan((b - a) / 2.0) * (2.0 * t - 1.0)
                angles.append((a + b) / 2.0 + math.atan(side))
            else:
                angles.append(a + t * (b - a))
    return angles


def sewn(shape, profile, counts, graded=False):
    """Triangles between rings of `counts[i]` points at `profile[i]`; a ring of one is a pole."""
    rings = []
    for at, count in zip(profile, counts):
        angles = [0.0] if count == 1 else ring_angles(shape, count, graded)
        rings.append([(angle, shape.point(at, angle)) for angle in angles])
    triangles = []
    for low, high in zip(rings, rings[1:]):
        i = j = 0
        while i < len(low) * (len(low) > 1) or j < len(high) * (len(high) > 1):
            a, b = low[i % len(low)][1], high[j % len(high)][1]
            next_low = low[(i + 1) % len(low)][0] + TURN * ((i + 1) // len(low)) if len(low) > 1 and i < len(low) else math.inf
            next_high = high[(j + 1) % len(high)][0] + TURN * ((j + 1) // len(high)) if len(high) > 1 and j < len(high) else math.inf
            if next_low <= next_high:
                triangles.append((a, low[(i + 1) % len(low)][1], b))
                i += 1
            else:
                triangles.append((a, high[(j + 1) % len(high)][1], b))
                j += 1
    return triangles


def even(shape, step):
    profile = stations(shape.corners, step * 0.9, 30.0)
    counts = [1 if r < 1e-9 else max(len(shape.edges) or 5, round(TURN * r * (1.1 if shape.edges else 1.0) / step)) for r, _ in profile]
    return sewn(shape, profile, counts)


def grid(shape, step, around, graded=False):
    """Rings of equally many points: needles where `step` is long, strips where it is short."""
    profile = stations(shape.sparse, step, 3.0) if step > 5 else stations(shape.corners, step, 30.0)
    if graded:
        profile = graded_profile(shape)
    counts = [1 if r < 1e-9 else around for r, _ in profile]
    return sewn(shape, profile, counts, graded)


def graded_profile(shape):
    """Stations 0.4 mm apart at the base and 5 mm at the tip."""
    fine = stations(shape.corners, 0.2, 30.0)
    kept, last = [fine[0]], 0
    corners = set(shape.corners)
    for k in range(1, len(fine)):
        wanted = 0.4 + 4.6 * fine[k][1] / shape.corners[-1][1]
        if fine[k] in corners and turn_at(shape.corners, fine[k]) > 30.0 or k == len(fine) - 1 or (k - last) * 0.2 >= wanted:
            kept.append(fine[k])
            last = k
    return kept


def turn_at(corners, corner):
    k = corners.index(corner)
    return math.degrees(abs(turn(*corners[k - 1 : k + 2]))) if 0 < k < len(corners) - 1 else 180.0


def noisy(triangles, size, seed):
    """As a scanner: every vertex moved by up to `size` mm."""
    chance, moved = random.Random(seed), {}
    def of(p):
        key = tuple(round(x, 6) for x in p)
        if key not in moved:
            moved[key] = tuple(x + size * chance.uniform(-1, 1) for x in p)
        return moved[key]
    return [tuple(of(p) for p in t) for t in triangles]


def marched(shape, step):
    """The zero level on a lattice of tetrahedra, as programs of medicine write surfaces."""
    radius = max(r for r, _ in shape.corners) * 1.5
    low = [-radius - 0.37 * step, -radius - 0.41 * step, shape.corners[0][1] - 1.43 * step]
    counts = [int(2 * radius / step) + 3] * 2 + [int((shape.corners[-1][1] - shape.corners[0][1]) / step) + 4]
    values = {}
    def value(n):
        if n not in values:
            v = shape.level(tuple(low[a] + step * n[a] for a in range(3)))
            values[n] = v if abs(v) > 0.02 * step else math.copysign(0.02 * step, v)
        return values[n]
    def cut(m, n):
        if m > n:
            m, n = n, m
        a, b = value(m), value(n)
        t = a / (a - b)
        return tuple(low[k] + step * (m[k] + t * (n[k] - m[k])) for k in range(3))
    triangles = []
    orders = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                for order in orders:
                    n = [i, j, k]
                    tet = [tuple(n)]
                    for axis in order:
                        n[axis] += 1
                        tet.append(tuple(n))
                    inner = [n for n in tet if value(n) < 0]
                    outer = [n for n in tet if value(n) > 0]
                    if len(inner) == 2:
                        (a, b), (c, d) = inner, outer
                        quad = [cut(a, c), cut(a, d), cut(b, d), cut(b, c)]
                        found = [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
                    elif len(inner) in (1, 3):
                        one, rest = (inner[0], outer) if len(inner) == 1 else (outer[0], inner)
                        found = [tuple(cut(one, n) for n in rest)]
                    else:
                        continue
                    out = [sum(n[a] for n in outer) / len(outer) - sum(n[a] for n in inner) / len(inner) for a in range(3)]
                    for t in found:
                        u, v = [[t[m][a] - t[0][a] for a in range(3)] for m in (1, 2)]
                        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
                        triangles.append(t if sum(x * y for x, y in zip(normal, out)) > 0 else t[::-1])
    return triangles


def decimated(triangles, angle):
    """Vertices taken out where the triangles around turn by less than `angle` degrees, in a random order."""
    points, index, faces = [], {}, []
    for t in triangles:
        for p in t:
            key = tuple(round(x, 6) for x in p)
            if key not in index:
                index[key] = len(points)
                points.append(p)
        faces.append([index[tuple(round(x, 6) for x in p)] for p in t])
    around = [set() for _ in points]
    for f, face in enumerate(faces):
        for v in face:
            around[v].add(f)
    def normal(face):
        a, b, c = (points[v] for v in face)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        size = math.hypot(*n)
        return None if size < 1e-9 else tuple(x / size for x in n)
    order = list(range(len(points)))
    random.Random(3).shuffle(order)
    for v in order:
        normals = [normal(faces[f]) for f in around[v]]
        if None in normals or len(normals) > 12:
            continue
        ring = {w for f in around[v] for w in faces[f]} - {v}
        worst = min(sum(x * y for x, y in zip(m, n)) for m in normals for n in normals)
        if worst < math.cos(math.radians(angle)):
            continue
        for w in sorted(ring, key=lambda w: math.dist(points[v], points[w])):
            shared = {x for f in around[w] for x in faces[f]} & ring
            moved = [[w if x == v else x for x in faces[f]] for f in around[v] if w not in faces[f]]
            new = [normal(face) for face in moved]
            if len(shared - {w}) != 2 or None in new:
                continue
            if min(sum(x * y for x, y in zip(n, m)) for n in new for m in normals) < math.cos(math.radians(angle)):
                continue
            for f in list(around[v]):
                if w in faces[f]:
                    for x in faces[f]:
                        around[x].discard(f)
                    faces[f] = None
                else:
                    faces[f] = [w if x == v else x for x in faces[f]]
                    around[w].add(f)
            around[v] = set()
            break
    return [tuple(points[v] for v in face) for face in faces if face]


def write(path, triangles):
    """A binary STL, without triangles of two equal corners."""
    data = [struct.pack("<9f", *(x for p in t for x in p)) for t in triangles]
    data = [d for d in data if len({d[:12], d[12:24], d[24:]}) == 3]
    with open(path, "wb") as file:
        file.write(b"made by scripts/own_surfaces.py".ljust(80) + struct.pack("<I", len(data)))
        file.writelines(bytes(12) + d + bytes(2) for d in data)


def capsule_profile(radius, length, count=64):
    arc = [math.pi / 2 * k / count for k in range(count + 1)]
    low = [(radius * math.sin(a), radius * (1 - math.cos(a))) for a in arc]
    return low + [(radius * math.cos(a), length - radius + radius * math.sin(a)) for a in arc]


def waves(angle, height):
    """Folds of 10 mm on one side."""
    return 1.0 + 0.12 * (1.0 + math.cos(angle)) * (1.0 - math.cos(TURN * height / 10.0)) / 2.0


def square(angle, _):
    quarter = math.remainder(angle, math.pi / 2)
    return 1.0 / math.cos(quarter)


def shapes():
    corners = [math.pi / 4 + k * math.pi / 2 for k in range(4)]
    # int (1 + c (1 + cos))^2 = 2 pi (1 + 2 c + 1.5 c^2); its mean over whole folds, c = 0.06 (1 - cos): 0.06 and 1.5 * 0.06^2.
    folded = math.pi * 64.0 * 80.0 * (1.0 + 2.0 * 0.06 + 1.5 * 1.5 * 0.06**2)
    can = [(0.0, 0.0), (8.0, 0.0), (8.0, 80.0), (0.0, 80.0)]
    tube = [(0.0, 0.0), (8.0, 0.0)] + [(8.0, 0.25 * k) for k in range(1, 321)] + [(0.0, 80.0)]
    one = lambda angle, height: 1.0
    return [
        Shape("cylinder", can, one, [], 0.01, math.pi * 64.0 * 80.0),
        Shape("box", [(0.0, 0.0), (10.0, 0.0), (10.0, 80.0), (0.0, 80.0)], square, corners, 0.001, 32000.0),
        Shape("capsule", capsule_profile(8.0, 80.0), one, [], 0.01, math.pi * 64.0 * (64.0 + 32.0 / 3.0)),
        Shape("bellows", tube, waves, [], 0.005, folded),
    ]


def triangulations(shape):
    """Name and triangles of each; those that follow a curve in few steps have as many as a careful export."""
    fold = 1.0 if shape.name == "bellows" else 80.0
    fine = even(shape, 1.0)
    # A cap of a CAD program is one fan; so is the end of a capsule.
    yield "fine even", fine
    yield "needles", grid(shape, fold, 128)
    yield "fans", grid(shape, fold if fold < 80 else 20.0, 48)
    yield "decimated", decimated(even(shape, 1.6), 12.0)
    yield "fewest (box: 12)", grid_box(shape) if shape.name == "box" else grid(shape, fold, 36)
    yield "scan, 0.03 mm", noisy(even(shape, 0.9), 0.03, 5)
    yield "facets, $fn = 64", grid(shape, min(fold, 40.0), 64)
    yield "thin strips", grid(shape, 0.35, 40)
    yield "marching, 0.9 mm", marched(shape, 0.9)
    yield "graded", grid(shape, 1.0, 56, graded=True)


def grid_box(shape):
    a = 10.0
    p = [(x, y, z) for z in (0.0, 80.0) for y in (-a, a) for x in (-a, a)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return [tuple(p[i] for i in t) for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def simulated(program, folder, name, shape, mesh):
    """What came of `name`.stl: volume at rest and growth (mm^3), chord angle (degrees); or the line that refused it."""
    (folder / f"{name}.toml").write_text(
        f'[part]\nstl = "{name.split("@")[0]}.stl"\n{mesh}[material]\nlaw = "neo-hookean"\nmu = 0.3\n'
        f"[load]\npressure = {shape.pressure}\nmay_overlap = true\n"
    )
    out = folder / f"{name}.out"
    subprocess.run(["rm", "-rf", out], check=True)
    run = subprocess.run([program, "simulate", folder / f"{name}.toml", "--out", out, "--json"], capture_output=True, text=True)
    if run.returncode != 0:
        return {"refused": run.stderr.strip().splitlines()[-1]}
    s = json.loads(run.stdout)
    said = [line for line in run.stderr.splitlines() if line]
    return {"volume": s["volume_initial"], "growth": s["volume_final"] - s["volume_initial"], "angle": s["angle_deg"],
            "ending": s["ending"], "triangles": s["surface"]["triangles"], "creased": s["creased_share"], "said": said}


def main():
    program, folder, chosen = sys.argv[1], Path(sys.argv[2]), sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    for shape in shapes():
        if chosen and shape.name not in chosen:
            continue
        print(f"\n{shape.name}: {shape.volume:.0f} mm^3, {shape.pressure} MPa", flush=True)
        for size in (2.4, 1.7, 1.2):
            name = f"{shape.name}-refined-{size}"
            write(folder / f"{name}.stl", even(shape, 0.5 * size))
            reference = simulated(program, folder, name, shape, f"[mesh]\nedge = {size}\n")
            print(f"  refined, {size} mm: {reference}", flush=True)
        for kind, triangles in triangulations(shape):
            name = f"{shape.name}-{kind.split(',')[0].split(' (')[0].replace(' ', '-')}"
            write(folder / f"{name}.stl", triangles)
            answer = simulated(program, folder, name, shape, "")
            print(f"  {kind:18} {len(triangles):6}  {told(answer, reference, shape)}", flush=True)


def told(answer, reference, shape):
    if "refused" in answer:
        return answer["refused"]
    share = lambda key: 100.0 * (answer[key] / reference[key] - 1.0)
    angle = f"  angle {answer['angle']:.3f} deg {share('angle'):+.2f} %" if reference["angle"] > 1.0 else ""
    return (f"-> {answer['triangles']:6}  volume {100.0 * (answer['volume'] / shape.volume - 1.0):+.2f} %"
            f"  growth {answer['growth']:.1f} {share('growth'):+.2f} %{angle}  {answer['ending']} {answer['creased']:.4f} {'; '.join(answer['said'])}")


if __name__ == "__main__":
    main()
