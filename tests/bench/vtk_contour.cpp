// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/vtk_contour.h"

#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>

#include "tests/bench/vtk_scan.h"

namespace octotomy::bench {

struct VtkContour::Pipeline {
  vtkNew<vtkImageImport> import;
  vtkNew<vtkFlyingEdges3D> contour;
};

VtkContour::VtkContour(const FlatScan& scan, double value, int threads)
    : pipeline_(std::make_unique<Pipeline>()) {
  vtkSMPTools::Initialize(threads);
  Pipeline& p = *pipeline_;
  import_scan(scan, *p.import);
  p.contour->SetInputConnection(p.import->GetOutputPort());
  p.contour->ComputeNormalsOff();
  p.contour->ComputeGradientsOff();
  p.contour->ComputeScalarsOff();
  p.contour->SetValue(0, value);
}

VtkContour::~VtkContour() = default;

std::size_t VtkContour::triangles() const {
  pipeline_->contour->Modified();
  pipeline_->contour->Update();
  return static_cast<std::size_t>(pipeline_->contour->GetOutput()->GetNumberOfPolys());
}

FlatMesh VtkContour::surface() const {
  vtkPolyData& found = *pipeline_->contour->GetOutput();
  FlatMesh mesh;
  for (vtkIdType i = 0; i < found.GetNumberOfPoints(); ++i) {
    const double* p = found.GetPoint(i);
    for (int axis = 0; axis < 3; ++axis) mesh.points_mm.push_back(static_cast<float>(p[axis]));
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < found.GetNumberOfPolys(); ++i) {
    found.GetCellPoints(i, corners);
    for (int k = 0; k < 3; ++k) mesh.faces.push_back(static_cast<std::uint32_t>(corners->GetId(k)));
  }
  return mesh;
}

}  // namespace octotomy::bench
