// SPDX-License-Identifier: AGPL-3.0-or-later
// Any bytes are a NIfTI, NRRD or MetaImage or are refused with std::runtime_error in one line; no header
// claims more samples than its data can hold. The first byte of an input says which format the rest is.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include "voxel/scan/read_volume.h"
#include "voxel/volume/volume_header.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fs = std::filesystem;
  using octotomy::voxel::VolumeFormat;
  if (size < 1) return 0;
  struct Kind {
    VolumeFormat format;
    const char* extension;
  };
  constexpr std::array<Kind, 7> kinds{{{VolumeFormat::Nifti, ".nii"},
                                       {VolumeFormat::Nifti, ".nii.gz"},
                                       {VolumeFormat::Nrrd, ".nrrd"},
                                       {VolumeFormat::Nrrd, ".nhdr"},
                                       {VolumeFormat::Meta, ".mha"},
                                       {VolumeFormat::Meta, ".mhd"},
                                       {VolumeFormat::Nifti, ".hdr"}}};
  const Kind kind = kinds[data[0] % kinds.size()];
  // A folder of its own: a detached header is answered with what lies beside it.
  static const fs::path folder = [] {
    fs::path made = fs::temp_directory_path() / ("octotomy-fuzz-" + std::to_string(::getpid()));
    fs::create_directories(made);
    return made;
  }();
  const fs::path path = folder / ("header" + std::string(kind.extension));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data) + 1, static_cast<std::streamsize>(size - 1));
  if (kind.extension == std::string(".hdr"))
    std::ofstream(folder / "header.img", std::ios::binary) << std::string(4096, '\1');
  try {
    const octotomy::voxel::VolumeHeader header = octotomy::voxel::read_volume_header(path, kind.format);
    // Compressed samples may be a thousand times larger than the file.
    const glm::dvec3 dims(header.geometry.dims);
    if (dims.x * dims.y * dims.z <= 1e6) octotomy::voxel::read_volume(path, kind.format);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
