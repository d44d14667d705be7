// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/write_volume.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <nifti/nifti1.h>
#include <stdexcept>
#include <zlib.h>

#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/space/write_failure.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr bool is_big = std::endian::native == std::endian::big;

const char* word_of(Meaning meaning) {
  return meaning == Meaning::Hounsfield ? "HU" : meaning == Meaning::Raw ? "raw" : "label";
}

bool is_int16(const Scene& scene) {
  return std::holds_alternative<Int16Samples>(scene.samples);
}

std::string_view bytes_of_samples(const Scene& scene) {
  return std::visit(
      [](const auto& samples) {
        return std::string_view(reinterpret_cast<const char*>(samples.data()),
                                samples.size() * sizeof(samples[0]));
      },
      scene.samples);
}

/// A file that is being written, without compression or compressed from some offset on.
class OutFile {
 public:
  explicit OutFile(const fs::path& path) : path_(path) {
    errno = 0;
    out_.open(path, std::ios::binary);
    if (!out_) refuse_unwritten(path_, errno);
  }

  void write(std::string_view bytes) {
    errno = 0;
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out_) refuse_unwritten(path_, errno);
  }
  /// Overwrites bytes that were written earlier.
  void overwrite(std::uint64_t at, std::string_view bytes) {
    out_.seekp(static_cast<std::streamoff>(at));
    write(bytes);
  }
  void close() {
    errno = 0;
    out_.close();
    if (!out_) refuse_unwritten(path_, errno);
  }

  /// Appends the parts as one gzip or zlib stream; returns its length. Uses level 1: scans are noisy, so
  /// higher levels cost time and save only a few per cent.
  std::uint64_t write_packed(std::initializer_list<std::string_view> parts, bool is_gzip_stream) {
    z_stream stream{};
    if (deflateInit2(&stream, 1, Z_DEFLATED, is_gzip_stream ? MAX_WBITS + 16 : MAX_WBITS, 9,
                     Z_DEFAULT_STRATEGY) != Z_OK)
      throw Error(ErrorCode::Resource, path_.string() + ": no memory is left to compress its samples");
    const Ended ended{stream};
    std::string packed(std::size_t{1} << 18, '\0');
    for (std::string_view part : parts)
      while (!part.empty()) {
        part.remove_prefix(feed(stream, part));
        drain(stream, packed, Z_NO_FLUSH);
      }
    drain(stream, packed, Z_FINISH);
    return stream.total_out;
  }

 private:
  struct Ended {
    z_stream& stream;
    ~Ended() { deflateEnd(&stream); }
  };

  /// Passes the first bytes of the part to the stream, at most as many as zlib's 32-bit counter allows.
  /// Returns their number.
  static std::size_t feed(z_stream& stream, std::string_view part) {
    const std::size_t count = std::min(part.size(), std::size_t{1} << 30);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(part.data()));  // zlib only reads it
    stream.avail_in = static_cast<uInt>(count);
    return count;
  }

  void drain(z_stream& stream, std::string& packed, int flush) {
    int state = Z_OK;
    do {
      stream.next_out = reinterpret_cast<Bytef*>(packed.data());
      stream.avail_out = static_cast<uInt>(packed.size());
      state = deflate(&stream, flush);
      write(std::string_view(packed).substr(0, packed.size() - stream.avail_out));
    } while (flush == Z_FINISH ? state != Z_STREAM_END : stream.avail_in > 0 || stream.avail_out == 0);
  }

  const fs::path& path_;
  std::ofstream out_;
};

/// Whether the axes are perpendicular up to the rounding of single precision. Readers of MetaImage, and the
/// qform of NIfTI, require direction cosines to be a rotation or reflection.
bool is_perpendicular(const Lattice& lattice) {
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < a; ++b)
      if (std::abs(glm::dot(glm::dvec3(lattice.lps_from_voxel[a]), glm::dvec3(lattice.lps_from_voxel[b]))) >
          4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * spacing_mm[a] * spacing_mm[b])
        return false;
  return true;
}

/// The bytes of a NIfTI extension with the lattice's geometry: length, code and text.
std::string nifti_extension(const Lattice& lattice) {
  std::string text(nifti_geometry_mark);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) text += print("%.17g ", lattice.lps_from_voxel[column][row]);
  text.resize((text.size() + 8 + 15) / 16 * 16 - 8, ' ');
  const std::int32_t head[2] = {static_cast<std::int32_t>(text.size() + 8), nifti_text_extension};
  return std::string(reinterpret_cast<const char*>(head), sizeof head) + text;
}

void put_qform(const glm::dmat4& ras, const glm::dvec3& spacing_mm, nifti_1_header& header) {
  glm::dmat3 turn;
  for (int axis = 0; axis < 3; ++axis) turn[axis] = glm::dvec3(ras[axis]) / spacing_mm[axis];
  const double qfac = glm::determinant(turn) < 0.0 ? -1.0 : 1.0;
  turn[2] *= qfac;
  glm::dquat quaternion = glm::quat_cast(turn);
  if (quaternion.w < 0.0) quaternion = -quaternion;
  header.pixdim[0] = static_cast<float>(qfac);
  header.quatern_b = static_cast<float>(quaternion.x);
  header.quatern_c = static_cast<float>(quaternion.y);
  header.quatern_d = static_cast<float>(quaternion.z);
  header.qform_code = NIFTI_XFORM_SCANNER_ANAT;
}

std::string padding_text(const Scene& scene) {
  return print("%.17g", *scene.padding);
}

/// The sform is always written, the qform only if it can represent the same geometry.
nifti_1_header nifti_header(const Scene& scene, const fs::path& path, std::size_t samples_at) {
  nifti_1_header header{};
  const glm::ivec3& dims = scene.lattice.dims;
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  header.sizeof_hdr = sizeof header;
  header.regular = 'r';
  header.dim[0] = 3;
  for (int i = 0; i < 7; ++i) {
    const int length = i < 3 ? dims[i] : 1;
    if (length > std::numeric_limits<short>::max())
      refuse(path, "NIfTI can store at most 32767 samples along an axis; write .nrrd instead");
    header.dim[i + 1] = static_cast<short>(length);
    header.pixdim[i + 1] = i < 3 ? static_cast<float>(spacing_mm[i]) : 1.0f;
  }
  header.datatype = is_int16(scene) ? DT_INT16 : DT_FLOAT32;
  header.bitpix = is_int16(scene) ? 16 : 32;
  header.vox_offset = static_cast<float>(samples_at);
  header.scl_slope = 1.0f;
  header.xyzt_units = NIFTI_UNITS_MM;
  if (scene.meaning == Meaning::Label) header.intent_code = NIFTI_INTENT_LABEL;
  std::string text = std::string(nifti_mark) + word_of(scene.meaning) + " " + scene.modality;
  if (scene.padding) text += " " + std::string(nifti_padding_mark) + padding_text(scene);
  std::memcpy(header.descrip, text.data(), std::min(text.size(), sizeof header.descrip - 1));
  glm::dmat4 ras = scene.lattice.lps_from_voxel;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 2; ++row) ras[column][row] = 0.0 - ras[column][row];
  header.pixdim[0] = 1.0f;
  header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  for (int column = 0; column < 4; ++column) {
    header.srow_x[column] = static_cast<float>(ras[column].x);
    header.srow_y[column] = static_cast<float>(ras[column].y);
    header.srow_z[column] = static_cast<float>(ras[column].z);
  }
  header.qoffset_x = static_cast<float>(ras[3].x);
  header.qoffset_y = static_cast<float>(ras[3].y);
  header.qoffset_z = static_cast<float>(ras[3].z);
  if (is_perpendicular(scene.lattice)) put_qform(ras, spacing_mm, header);
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

void write_nifti(const Scene& scene, const fs::path& path) {
  const std::string extension = std::string("\1\0\0\0", 4) + nifti_extension(scene.lattice);
  const nifti_1_header header = nifti_header(scene, path, sizeof header + extension.size());
  const std::string_view head(reinterpret_cast<const char*>(&header), sizeof header);
  OutFile out(path);
  if (extension_of(path) == ".gz") {
    out.write_packed({head, extension, bytes_of_samples(scene)}, true);
  } else {
    for (const std::string_view part : {head, std::string_view(extension), bytes_of_samples(scene)})
      out.write(part);
  }
  out.close();
}

std::string numbers(const glm::dvec3& vector, const char* between) {
  return print("%.17g%s%.17g%s%.17g", vector.x, between, vector.y, between, vector.z);
}

std::string dims_text(const Scene& scene) {
  const glm::ivec3& dims = scene.lattice.dims;
  return print("%d %d %d", dims.x, dims.y, dims.z);
}

void write_nrrd(const Scene& scene, const fs::path& path) {
  const auto vector = [&](int column) {
    return "(" + numbers(glm::dvec3(scene.lattice.lps_from_voxel[column]), ",") + ")";
  };
  std::string header =
      std::string("NRRD0005\n# Written by Octotomy\ntype: ") + (is_int16(scene) ? "short" : "float") +
      "\ndimension: 3\nspace: left-posterior-superior\nsizes: " + dims_text(scene) +
      "\nspace directions: " + vector(0) + " " + vector(1) + " " + vector(2) +
      "\nkinds: domain domain domain\nendian: " + (is_big ? "big" : "little") +
      "\nencoding: gzip\nspace units: \"mm\" \"mm\" \"mm\"\nspace origin: " + vector(3) + "\n";
  if (scene.meaning == Meaning::Hounsfield) header += "sample units: \"HU\"\n";
  fs::path data = path;
  const bool is_detached = extension_of(path) == ".nhdr";
  if (is_detached) header += "data file: " + data.replace_extension(".raw.gz").filename().string() + "\n";
  header += std::string(meaning_key) + ":=" + word_of(scene.meaning) + "\n";
  if (!scene.modality.empty()) header += std::string(modality_key) + ":=" + scene.modality + "\n";
  if (scene.padding) header += std::string(padding_key) + ":=" + padding_text(scene) + "\n";
  OutFile out(path);
  out.write(header);
  if (!is_detached) out.write("\n");
  if (is_detached) {
    OutFile samples(data);
    samples.write_packed({bytes_of_samples(scene)}, true);
    samples.close();
  } else {
    out.write_packed({bytes_of_samples(scene)}, true);
  }
  out.close();
}

std::string modality_of_meta(const std::string& modality) {
  for (const char* known : {"CT", "MR", "NM", "US"})
    if (modality == known) return std::string("Modality = MET_MOD_") + known + "\n";
  return "";
}

void write_meta(const Scene& scene, const fs::path& path) {
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const auto direction = [&](int axis) {
    return numbers(glm::dvec3(scene.lattice.lps_from_voxel[axis]) / spacing_mm[axis], " ");
  };
  constexpr int size_digits = 20;
  std::string header =
      std::string("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = ") +
      (is_big ? "True" : "False") + "\nCompressedData = True\nCompressedDataSize = ";
  const std::size_t size_at = header.size();
  header += std::string(size_digits, ' ') + "\nTransformMatrix = " + direction(0) + " " + direction(1) + " " +
            direction(2) + "\nOffset = " + numbers(glm::dvec3(scene.lattice.lps_from_voxel[3]), " ") +
            "\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = " +
            sides_of_origin(glm::dmat3(scene.lattice.lps_from_voxel)) +
            "\nElementSpacing = " + numbers(spacing_mm, " ") + "\nDistanceUnits = mm\n" +
            modality_of_meta(scene.modality) + "DimSize = " + dims_text(scene) + "\n" + meaning_key + " = " +
            word_of(scene.meaning) + "\n";
  if (!scene.modality.empty()) header += std::string(modality_key) + " = " + scene.modality + "\n";
  if (scene.padding) header += std::string(padding_key) + " = " + padding_text(scene) + "\n";
  header +=
      std::string("ElementType = ") + (is_int16(scene) ? "MET_SHORT" : "MET_FLOAT") + "\nElementDataFile = ";
  fs::path data = path;
  const bool is_detached = extension_of(path) == ".mhd";
  header += is_detached ? data.replace_extension(".zraw").filename().string() + "\n" : "LOCAL\n";
  OutFile out(path);
  out.write(header);
  std::uint64_t bytes = 0;
  if (is_detached) {
    OutFile samples(data);
    bytes = samples.write_packed({bytes_of_samples(scene)}, false);
    samples.close();
  } else {
    bytes = out.write_packed({bytes_of_samples(scene)}, false);
  }
  out.overwrite(size_at, print("%*llu", size_digits, static_cast<unsigned long long>(bytes)));
  out.close();
}

}  // namespace

void write_volume(const Scene& scene, const fs::path& path, VolumeFormat format) {
  switch (format) {
    case VolumeFormat::Nifti:
      return write_nifti(scene, path);
    case VolumeFormat::Nrrd:
      return write_nrrd(scene, path);
    case VolumeFormat::Meta:
      if (!is_perpendicular(scene.lattice))
        throw InvalidInput("MetaImage cannot store axes that are not perpendicular; write .nrrd or .nii.gz");
      return write_meta(scene, path);
  }
}

}  // namespace octotomy::voxel
