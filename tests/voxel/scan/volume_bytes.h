// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstring>
#include <functional>
#include <nifti/nifti1.h>
#include <string>

// Small volume files, made byte by byte: 2 x 3 x 4 samples.
namespace octotomy::tests {

/// 24 bytes from 0 to 23: 2 x 3 x 4 samples.
inline std::string ramp() {
  std::string bytes;
  for (char value = 0; value < 24; ++value) bytes += value;
  return bytes;
}

inline std::string nrrd(const std::string& fields, const std::string& samples = ramp()) {
  const auto field = [&](const char* name, const char* otherwise) {
    return ("\n" + fields).find(std::string("\n") + name) == std::string::npos ? std::string(otherwise) : "";
  };
  return "NRRD0005\ndimension: 3\nsizes: 2 3 4\n" + fields + field("type:", "type: uchar\n") +
         field("encoding:", "encoding: raw\n") + "\n" + samples;
}
/// With directions (2,0,0) (0,3,0) (0,0,4) and the origin (10,20,30).
inline std::string nrrd_in(const std::string& space) {
  return nrrd(space + "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n");
}

inline std::string meta(const std::string& fields, const std::string& samples = ramp()) {
  const std::string type = fields.find("ElementType") == std::string::npos ? "ElementType = MET_UCHAR\n" : "";
  return "ObjectType = Image\nNDims = 3\nDimSize = 2 3 4\n" + fields + type + "ElementDataFile = LOCAL\n" +
         samples;
}
inline const std::string meta_place =
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\n";

/// A NIfTI-1 of 24 bytes with the spacing 2, 3, 4 mm and the origin (10, 20, 30) in both forms, as changed.
inline std::string nifti(const std::function<void(nifti_1_header&)>& change,
                         const std::string& samples = ramp()) {
  nifti_1_header header{};
  header.sizeof_hdr = 348;
  const short dims[8] = {3, 2, 3, 4, 1, 1, 1, 1};
  const float spacing[8] = {1, 2, 3, 4, 1, 1, 1, 1};
  std::copy_n(dims, 8, header.dim);
  std::copy_n(spacing, 8, header.pixdim);
  header.datatype = DT_UINT8;
  header.bitpix = 8;
  header.vox_offset = 352;
  header.xyzt_units = NIFTI_UNITS_MM;
  header.qform_code = header.sform_code = 1;
  header.qoffset_x = 10, header.qoffset_y = 20, header.qoffset_z = 30;
  header.srow_x[0] = 2, header.srow_y[1] = 3, header.srow_z[2] = 4;
  header.srow_x[3] = 10, header.srow_y[3] = 20, header.srow_z[3] = 30;
  std::memcpy(header.magic, "n+1", 4);
  change(header);
  return std::string(reinterpret_cast<const char*>(&header), sizeof header) + std::string(4, '\0') + samples;
}

}  // namespace octotomy::tests
