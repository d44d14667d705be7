// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/vtk_contour.h"

#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>

namespace octotomy::bench {

struct VtkContour::Pipeline {
  vtkNew<vtkImageImport> import;
  vtkNew<vtkFlyingEdges3D> contour;
};

VtkContour::VtkContour(const FlatScan& scan, double value, int threads)
    : pipeline_(std::make_unique<Pipeline>()) {
  vtkSMPTools::Initialize(threads);
  Pipeline& p = *pipeline_;
  p.import->SetDataScalarTypeToShort();
  p.import->SetNumberOfScalarComponents(1);
  p.import->SetWholeExtent(0, scan.dims[0] - 1, 0, scan.dims[1] - 1, 0, scan.dims[2] - 1);
  p.import->SetDataExtentToWholeExtent();
  p.import->SetDataSpacing(scan.spacing_mm.data());
  p.import->SetDataOrigin(scan.first_mm.data());
  p.import->SetImportVoidPointer(const_cast<std::int16_t*>(scan.samples));
  p.import->Update();
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
