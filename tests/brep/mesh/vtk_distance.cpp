// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/brep/mesh/vtk_distance.h"

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkDistancePolyDataFilter.h>
#include <vtkImplicitPolyDataDistance.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

namespace octotomy::tests {
namespace {

void fill(const FlatSurface& surface, vtkPolyData* data) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Point& p : surface.points) points->InsertNextPoint(p.data());
  vtkNew<vtkCellArray> cells;
  for (const auto& face : surface.faces) {
    const vtkIdType corners[] = {face[0], face[1], face[2]};
    cells->InsertNextCell(3, corners);
  }
  data->SetPoints(points);
  data->SetPolys(cells);
}

}  // namespace

std::vector<double> vtk_signed_distances(const FlatSurface& surface, const std::vector<Point>& points) {
  vtkNew<vtkPolyData> data;
  fill(surface, data);
  vtkNew<vtkImplicitPolyDataDistance> distance;
  distance->SetInput(data);
  std::vector<double> distances;
  for (Point p : points) distances.push_back(distance->EvaluateFunction(p.data()));
  return distances;
}

std::vector<double> vtk_vertex_distances(const FlatSurface& from, const FlatSurface& to) {
  vtkNew<vtkPolyData> from_data, to_data;
  fill(from, from_data);
  fill(to, to_data);
  vtkNew<vtkDistancePolyDataFilter> filter;
  filter->SetInputData(0, from_data);
  filter->SetInputData(1, to_data);
  filter->SignedDistanceOn();
  filter->ComputeSecondDistanceOff();
  filter->Update();
  vtkDataArray* array = filter->GetOutput()->GetPointData()->GetArray("Distance");
  std::vector<double> distances;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i) distances.push_back(array->GetTuple1(i));
  return distances;
}

}  // namespace octotomy::tests
