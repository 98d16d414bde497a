"""Read a mesh file with VTK's own reader and print what it holds as one JSON object.

Usage: python3 vtk_reader.py FILE.vtu|FILE.ply|FILE.obj

Floating-point numbers are printed as the bits of a double, so that a comparison is exact.
"""

import json
import struct
import sys

from vtkmodules.vtkIOGeometry import vtkOBJReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

READERS = {"vtu": vtkXMLUnstructuredGridReader, "ply": vtkPLYReader, "obj": vtkOBJReader}


def bits(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def arrays(data):
    found = {}
    for i in range(data.GetNumberOfArrays()):
        array = data.GetAbstractArray(i)
        if array.IsA("vtkStringArray"):
            found[array.GetName()] = [array.GetValue(k) for k in range(array.GetNumberOfTuples())]
            continue
        found[array.GetName()] = [bits(array.GetTuple1(k)) for k in range(array.GetNumberOfTuples())]
    return found


def main(path):
    reader = READERS[path.rsplit(".", 1)[1]]()
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("the reader reported an error"))
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    cells = []
    for i in range(grid.GetNumberOfCells()):
        ids = grid.GetCell(i).GetPointIds()
        cells.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
    points = [[bits(x) for x in grid.GetPoint(i)] for i in range(grid.GetNumberOfPoints())]
    print(json.dumps({
        "errors": errors,
        "points": points,
        "cells": cells,
        "types": sorted({grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}),
        "point_data": arrays(grid.GetPointData()),
        "cell_data": arrays(grid.GetCellData()),
        "field_data": arrays(grid.GetFieldData()),
    }))


if __name__ == "__main__":
    main(sys.argv[1])
