#!/usr/bin/env bash
# A physical group that gmsh is given reversed, `Physical Surface("skin", 5) = {-1, -2}`, keeps its number 5 under
# $PhysicalNames, but the surfaces of a file of format 4.1 carry -5 in $Entities. In format 2.2 the triangles carry 5, turned.
# So a reader that looks the number up as it stands finds the group in 2.2 and loses it in 4.1, without an error:
# meshio's cell set "skin" has the triangles of neither surface.
#
# Seen with gmsh 4.15.0 and meshio 5.3.5 (PyPI), Python 3.11. What to do: take the absolute value of the tag; its sign is the orientation.
set -euo pipefail

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet gmsh==4.15.0 meshio==5.3.5 numpy==2.2.6

cat >box.geo <<'GEO'
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Physical Surface("skin", 5) = {-1, -2};
Physical Surface("rest", 6) = {3, 4};
Physical Volume("wall", 7) = {1};
GEO

cat >look.py <<'PYTHON'
import gmsh, meshio

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open("box.geo")
gmsh.model.mesh.generate(3)
seen = {}
for version in (2.2, 4.1):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.write("box.msh")
    mesh = meshio.read("box.msh")
    triangles = [tags for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]) if block.type == "triangle"]
    numbers = sorted({int(tag) for tags in triangles for tag in tags})
    in_set = {name: sum(len(part) for part in mesh.cell_sets[name]) for name in ("skin", "rest") if name in mesh.cell_sets}
    seen[version] = (int(mesh.field_data["skin"][0]), numbers, {name: count > 0 for name, count in in_set.items()})
    print(f"format {version}: the group is number {seen[version][0]}, triangles carry {numbers}, cell sets have triangles: {seen[version][2]}")
assert seen[2.2] == (5, [5, 6], {}), seen
assert seen[4.1] == (5, [-5, 6], {"skin": False, "rest": True}), seen
PYTHON
venv/bin/python look.py
echo "as described"
