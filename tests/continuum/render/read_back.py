# Reads an exported file by VTK, and tells what VTK found in it as JSON: read_back.py FILE
import json
import sys

import vtkmodules.vtkCommonDataModel  # noqa: F401
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

path = sys.argv[1]
reader = vtkPLYReader() if path.endswith(".ply") else vtkXMLPolyDataReader()
reader.SetFileName(path)
reader.Update()
data = reader.GetOutput()


def rows(array, count=3):
    """The first of them."""
    return [list(array.GetTuple(i)) for i in range(min(count, array.GetNumberOfTuples()))]


arrays = data.GetPointData()
fields = data.GetFieldData()
print(json.dumps({
    "points": data.GetNumberOfPoints(),
    "vertices": data.GetNumberOfVerts(),
    "positions": rows(data.GetPoints().GetData()),
    "arrays": {arrays.GetArrayName(i): rows(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())},
    "time": fields.GetArray(0).GetTuple1(0) if fields.GetNumberOfArrays() else None,
}))
