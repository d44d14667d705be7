// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/vtk_contour.h"

#include <vtkFlyingEdges3D.h>
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

}  // namespace octotomy::bench
