// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/vtk_peer.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointRayCastImage.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkNew.h>
#include <vtkOpenGLRenderer.h>
#include <vtkPiecewiseFunction.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include "tests/bench/vtk_scan.h"

namespace octotomy::bench {

struct VtkPeer::Pipeline {
  vtkNew<vtkImageImport> import;
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  vtkNew<vtkVolume> volume;
  vtkNew<vtkOpenGLRenderer> renderer;
  vtkNew<vtkGenericOpenGLRenderWindow> window;
};

VtkPeer::VtkPeer(const FlatScan& scan, double threshold, int threads)
    : pipeline_(std::make_unique<Pipeline>()) {
  Pipeline& p = *pipeline_;
  import_scan(scan, *p.import);
  p.mapper->SetInputConnection(p.import->GetOutputPort());
  p.mapper->SetBlendModeToComposite();
  p.mapper->AutoAdjustSampleDistancesOff();
  p.mapper->SetImageSampleDistance(1.0f);
  p.mapper->SetSampleDistance(static_cast<float>(scan.spacing_mm[0]));
  p.mapper->SetNumberOfThreads(threads);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(threshold - 1.0, 0.0);
  opacity->AddPoint(threshold, 1.0);
  vtkNew<vtkColorTransferFunction> colour;
  colour->AddRGBPoint(threshold, 0.9, 0.9, 0.9);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(opacity);
  property->SetColor(colour);
  property->SetScalarOpacityUnitDistance(scan.spacing_mm[0]);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  p.volume->SetMapper(p.mapper);
  p.volume->SetProperty(property);
  p.renderer->AddVolume(p.volume);
  p.window->AddRenderer(p.renderer);
}

VtkPeer::~VtkPeer() = default;

int VtkPeer::draw(const PicturePlane& plane) const {
  Pipeline& p = *pipeline_;
  p.window->SetSize(plane.side_px, plane.side_px);
  vtkCamera* camera = p.renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * plane.width_mm);
  camera->SetFocalPoint(plane.centre_mm[0], plane.centre_mm[1], plane.centre_mm[2]);
  camera->SetPosition(plane.centre_mm[0] - plane.range_mm * plane.look[0],
                      plane.centre_mm[1] - plane.range_mm * plane.look[1],
                      plane.centre_mm[2] - plane.range_mm * plane.look[2]);
  camera->SetViewUp(plane.up[0], plane.up[1], plane.up[2]);
  camera->SetClippingRange(0.1, 3.0 * plane.range_mm);
  p.mapper->PerVolumeInitialization(p.renderer, p.volume);
  p.mapper->PerImageInitialization(p.renderer, p.volume, 0, p.import->GetOutput()->GetOrigin(),
                                   p.import->GetOutput()->GetSpacing(), p.import->GetOutput()->GetExtent());
  p.mapper->PerSubVolumeInitialization(p.renderer, p.volume, 0);
  p.mapper->RenderSubVolume();
  vtkFixedPointRayCastImage* image = p.mapper->GetRayCastImage();
  int size[2];
  int memory[2];
  image->GetImageInUseSize(size);
  image->GetImageMemorySize(memory);
  const unsigned short* pixels = image->GetImage();
  int lit = 0;
  for (int y = 0; y < size[1]; ++y)
    for (int x = 0; x < size[0]; ++x) lit += pixels[4 * (y * memory[0] + x) + 3] > 0x3fff;
  return lit;
}

}  // namespace octotomy::bench
