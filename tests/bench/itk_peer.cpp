// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/itk_peer.h"

#include "voxel/space/itk_compiler.h"

#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImage.h>
#include <itkImageSeriesReader.h>

namespace octotomy::bench {

int read_series_by_itk(const std::filesystem::path& folder) {
  using Image = itk::Image<short, 3>;
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetDirectory(folder.string());
  const auto reader = itk::ImageSeriesReader<Image>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(names->GetInputFileNames());
  reader->Update();
  return reader->GetOutput()->GetBufferPointer()[12345];
}

}  // namespace octotomy::bench
