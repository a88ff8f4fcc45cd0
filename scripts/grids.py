#!/usr/bin/env python3
"""Writes tests/data/vtu again: one cube of 15 mm around a cavity of 5 mm, in the forms that VTK and meshio write.

Wants `pip install vtk meshio`. Usage: scripts/grids.py FOLDER
"""
import itertools
import pathlib
import sys

import meshio
import vtk

folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)


def number(i, j, k):
    return (4 * i + j) * 4 + k


points = [(5.0 * i, 5.0 * j, 5.0 * k) for i, j, k in itertools.product(range(4), repeat=3)]
tetrahedra = []
for cell in itertools.product(range(3), repeat=3):
    if cell == (1, 1, 1):
        continue
    for order in itertools.permutations(range(3)):  # Kuhn's six about the cube's diagonal
        corner = list(cell)
        nodes = [number(*corner)]
        for axis in order:
            corner[axis] += 1
            nodes.append(number(*corner))
        tetrahedra.append(nodes)


def grid(more=()):
    grid, places = vtk.vtkUnstructuredGrid(), vtk.vtkPoints()
    places.SetDataTypeToDouble()
    for point in points:
        places.InsertNextPoint(*point)
    grid.SetPoints(places)
    for kind, nodes in [(vtk.VTK_TETRA, nodes) for nodes in tetrahedra] + list(more):
        grid.InsertNextCell(kind, len(nodes), nodes)
    return grid


COMPRESSORS = {
    "zlib": vtk.vtkZLibDataCompressor,
    "lz4": vtk.vtkLZ4DataCompressor,
    "lzma": vtk.vtkLZMADataCompressor,
}
Writer = vtk.vtkXMLWriter
FORMS = {
    "text": (Writer.Ascii, 0),
    "inline": (Writer.Binary, 0),
    "raw": (Writer.Appended, 0),
    "base64": (Writer.Appended, 1),
}


def write(name, order="little", compressor="plain", form="raw", head="32", ids="64", of=None):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(folder / f"{name}.vtu"))
    writer.SetInputData(of or grid())
    mode, encode = FORMS[form]
    writer.SetDataMode(mode)
    writer.SetEncodeAppendedData(encode)
    writer.SetCompressor(COMPRESSORS[compressor]() if compressor in COMPRESSORS else None)
    if order == "big":
        writer.SetByteOrderToBigEndian()
    (writer.SetHeaderTypeToUInt64 if head == "64" else writer.SetHeaderTypeToUInt32)()
    (writer.SetIdTypeToInt64 if ids == "64" else writer.SetIdTypeToInt32)()
    writer.SetBlockSize(4096)
    assert writer.Write() == 1


write("ascii", form="text")
write("ascii_big", order="big", form="text")
for name in [
    "little_zlib_raw_32", "big_zlib_inline_64", "big_plain_raw_64", "little_plain_base64_32", "big_plain_inline_32",
    "little_lz4_raw_32", "big_lz4_base64_64", "little_lzma_inline_64", "big_lzma_raw_32",
]:  # fmt: skip
    write(name, *name.split("_"))
write("ids32", compressor="zlib", ids="32")
others = [
    (vtk.VTK_TRIANGLE, tetrahedra[0][:3]), (vtk.VTK_QUAD, [0, 1, 5, 4]), (vtk.VTK_LINE, [0, 1]),
    (vtk.VTK_VERTEX, [3]), (vtk.VTK_POLY_LINE, [0, 1, 2, 3]),
]  # fmt: skip
write("mixed", compressor="zlib", of=grid(others))
write("hexa", compressor="zlib", of=grid([(vtk.VTK_HEXAHEDRON, [0, 16, 20, 4, 1, 17, 21, 5])]))
meshio.write(folder / "meshio_lzma.vtu", meshio.read(folder / "ascii.vtu"), compression="lzma")


def piece(cells):
    """One half of the grid with points of its own, as a program that runs in parallel writes it."""
    used = sorted({node for cell in cells for node in cell})
    new = {node: place for place, node in enumerate(used)}

    def array(kind, name, numbers, more=""):
        numbers = " ".join(map(str, numbers))
        return f'<DataArray type="{kind}" Name="{name}" {more}format="ascii">{numbers}</DataArray>\n'

    return (
        f'<Piece NumberOfPoints="{len(used)}" NumberOfCells="{len(cells)}">\n<Points>'
        + array("Float64", "Points", (x for node in used for x in points[node]), 'NumberOfComponents="3" ')
        + "</Points><Cells>"
        + array("Int64", "connectivity", (new[node] for cell in cells for node in cell))
        + array("Int64", "offsets", (4 * (k + 1) for k in range(len(cells))))
        + array("UInt8", "types", [10] * len(cells))
        + "</Cells></Piece>\n"
    )


half = len(tetrahedra) // 2
(folder / "pieces.vtu").write_text(
    '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">\n<UnstructuredGrid>'
    + piece(tetrahedra[:half])
    + piece(tetrahedra[half:])
    + "</UnstructuredGrid></VTKFile>\n"
)
