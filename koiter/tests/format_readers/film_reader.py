"""Read a film with the readers of its format and print what they hold as one JSON object.

Usage: python3 film_reader.py FILE.vtkhdf|FILE.usda|FILE.npz|FILE.stl

The object has "times", "up", "metres", "parts" (names), and in "frames" for every frame "positions", "faces" and "fields" by name.
Floating-point numbers are printed as the bits of a double, so that a comparison is exact.
"""

import json
import sys

import numpy


def bits(array):
    return numpy.ascontiguousarray(array, dtype="<f8").view("<u8").tolist()


def read_vtkhdf(path):
    import h5py
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.AddObserver("ErrorEvent", lambda *_: sys.exit("the reader reported an error"))
    assert reader.CanReadFile(path), "VTK does not take it for a VTKHDF file"
    reader.SetFileName(path)
    reader.UpdateInformation()
    key = Pipeline.TIME_STEPS()
    information = reader.GetOutputInformation(0)
    # Of a single frame VTK tells no time.
    times = [information.Get(key, k) for k in range(information.Length(key))] or [0.0]
    frames = []
    for time in times:
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        fields = {}
        for prefix, arrays in (("vertex", data.GetPointData()), ("face", data.GetCellData())):
            for k in range(arrays.GetNumberOfArrays()):
                fields[f"{prefix} {arrays.GetArrayName(k)}"] = bits(vtk_to_numpy(arrays.GetArray(k)))
        polygons = data.GetPolys()
        frames.append({
            "positions": bits(vtk_to_numpy(data.GetPoints().GetData())),
            "faces": vtk_to_numpy(polygons.GetConnectivityArray()).reshape(-1, 3).tolist(),
            "fields": fields,
        })
    with h5py.File(path) as file:
        attributes = file["VTKHDF"].attrs
        parts = [attributes[name].decode() for name in sorted(attributes) if name.startswith("part_")]
        up, metres = attributes["up_axis"].decode(), float(attributes["metres_per_unit"])
        points = file["VTKHDF/Points"]
        assert points.dtype == "<f8" and points.shape == (sum(len(f["positions"]) for f in frames), 3)
        stored = file["VTKHDF/Steps/Values"][:].tolist()
        assert len(times) == 1 or stored == times
    return {"times": bits(stored), "up": up, "metres": metres, "parts": parts, "frames": frames}


def read_usda(path):
    from pxr import Usd, UsdGeom, UsdUtils

    stage = Usd.Stage.Open(path)
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    codes = sorted({code for mesh in meshes for code in mesh.GetPointsAttr().GetTimeSamples()}) or [Usd.TimeCode.Default()]
    frames = []
    for code in codes:
        positions, faces, fields = [], [], {}
        for mesh in meshes:
            assert set(mesh.GetFaceVertexCountsAttr().Get(code)) <= {3}
            corners = numpy.array(mesh.GetFaceVertexIndicesAttr().Get(code)).reshape(-1, 3)
            faces += (corners + len(positions)).tolist()
            points = mesh.GetPointsAttr().Get(code)
            positions += bits(points)
            low, high = mesh.GetExtentAttr().Get(code)
            assert numpy.allclose(UsdGeom.PointBased.ComputeExtent(points), [low, high], rtol=1e-6)
            for primvar in UsdGeom.PrimvarsAPI(mesh).GetPrimvarsWithAuthoredValues():
                prefix = {"vertex": "vertex", "uniform": "face"}[primvar.GetInterpolation()]
                fields.setdefault(f"{prefix} {primvar.GetPrimvarName()}", []).extend(bits(primvar.Get(code)))
        frames.append({"positions": positions, "faces": faces, "fields": fields})
    rate = stage.GetTimeCodesPerSecond()
    is_film = len(codes) > 1
    assert not is_film or (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (codes[0], codes[-1])
    return {
        "times": bits([code / rate for code in codes]) if is_film else None,
        "up": UsdGeom.GetStageUpAxis(stage).lower(),
        "metres": UsdGeom.GetStageMetersPerUnit(stage),
        "parts": [mesh.GetPrim().GetName() for mesh in meshes],
        "frames": frames,
    }


def read_npz(path):
    file = numpy.load(path)
    frames = []
    for k in range(len(file["times"])):
        fields = {
            f"{prefix} {name[len(prefix) + 1:]}": bits(file[name][k])
            for prefix in ("vertex", "face")
            for name in file.files
            if name.startswith(prefix + "_")
        }
        frames.append({"positions": bits(file["positions"][k]), "faces": file["faces"].tolist(), "fields": fields})
    assert file["part_vertices"][-1, 1] == file["positions"].shape[1]
    assert file["part_faces"][-1, 1] == len(file["faces"])
    assert len(file["steps"]) == len(frames)
    return {
        "times": bits(file["times"]),
        "up": str(file["up_axis"]),
        "metres": float(file["metres_per_unit"]),
        "parts": file["part_names"].tolist(),
        "frames": frames,
    }


def read_stl(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOGeometry import vtkSTLReader

    reader = vtkSTLReader()
    reader.SetFileName(path)
    reader.MergingOff()
    reader.Update()
    return {"corners": bits(vtk_to_numpy(reader.GetOutput().GetPoints().GetData()))}


if __name__ == "__main__":
    read = {"vtkhdf": read_vtkhdf, "usda": read_usda, "npz": read_npz, "stl": read_stl}
    print(json.dumps(read[sys.argv[1].rsplit(".", 1)[1]](sys.argv[1])))
