// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/planner/cli/program/itk_reader.h"

#include "voxel/space/itk_compiler.h"

#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <stdexcept>

namespace octotomy::tests {
namespace {

using Image = itk::Image<double, 3>;

Image::Pointer series_of(const std::filesystem::path& folder) {
  const auto names = itk::GDCMSeriesFileNames::New();
  names->SetDirectory(folder.string());
  const auto reader = itk::ImageSeriesReader<Image>::New();
  reader->SetImageIO(itk::GDCMImageIO::New());
  reader->SetFileNames(names->GetInputFileNames());
  reader->Update();
  return reader->GetOutput();
}

Image::Pointer volume_of(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const auto reader = itk::ImageFileReader<Image>::New();
  if (extension == ".nrrd" || extension == ".nhdr")
    reader->SetImageIO(itk::NrrdImageIO::New());
  else if (extension == ".mha" || extension == ".mhd")
    reader->SetImageIO(itk::MetaImageIO::New());
  else
    reader->SetImageIO(itk::NiftiImageIO::New());
  reader->SetFileName(path.string());
  reader->Update();
  return reader->GetOutput();
}

}  // namespace

ItkVolume read_by_itk(const std::filesystem::path& path) {
  try {
    const Image::Pointer image = std::filesystem::is_directory(path) ? series_of(path) : volume_of(path);
    ItkVolume volume;
    const auto size = image->GetLargestPossibleRegion().GetSize();
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<unsigned>(axis);
      volume.dims[axis] = static_cast<int>(size[i]);
      volume.spacing_mm[axis] = image->GetSpacing()[i];
      volume.lps_from_voxel[3][axis] = image->GetOrigin()[i];
      for (int row = 0; row < 3; ++row)
        volume.lps_from_voxel[axis][row] =
            image->GetDirection()(static_cast<unsigned>(row), i) * image->GetSpacing()[i];
    }
    const double* samples = image->GetBufferPointer();
    volume.samples.assign(samples, samples + image->GetLargestPossibleRegion().GetNumberOfPixels());
    return volume;
  } catch (const itk::ExceptionObject& error) {
    throw std::runtime_error(error.GetDescription());
  }
}

}  // namespace octotomy::tests
