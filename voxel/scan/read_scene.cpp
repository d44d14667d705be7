// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_scene.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string_view>

#include "voxel/scan/read_dicom.h"
#include "voxel/scan/read_dicom_seg.h"
#include "voxel/scan/read_image_stack.h"
#include "voxel/scan/read_raw.h"
#include "voxel/scan/read_volume.h"
#include "voxel/scan/size_audit.h"
#include "voxel/space/error.h"
#include "voxel/space/regular_file.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// Refuses options that override the frame, unit or spacing: DICOM states all of them.
void need_no_override(const fs::path& path, const ReadOptions& options) {
  if (options.frame || options.unit)
    throw InvalidInput(path.string() +
                       ": DICOM states its patient frame (LPS) and its unit of length (mm): leave --frame "
                       "and --unit out");
  if (options.spacing_mm)
    throw InvalidInput(path.string() + ": DICOM states its spacing: leave --spacing out");
}

/// Refuses options that choose a series, because a single file or a stack contains no series.
void need_no_series(const fs::path& path, const ReadOptions& options) {
  if (!options.series.empty() || options.join || !options.slices.empty())
    throw InvalidInput(path.string() +
                       ": is not a DICOM series: leave --series, --join and --slices out, or choose the "
                       "folder of the series");
}

Scene read_volume_file(const fs::path& path, VolumeFormat format, const ReadOptions& options) {
  need_no_series(path, options);
  if (options.spacing_mm)
    throw InvalidInput(path.string() +
                       ": its header states the spacing: leave --spacing out, or correct the "
                       "header; --unit names another unit of length");
  return read_volume(path, format, options);
}

Scene read_stack(const fs::path& path, const ReadOptions& options) {
  need_no_series(path, options);
  return read_image_stack(path, options);
}

Scene read_any(const fs::path& path, const ReadOptions& options) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const bool is_folder = fs::is_directory(status);
  if (!is_folder) need_regular_file(path);
  if (options.raw) {
    need_no_series(path, options);
    return read_raw(path, options);
  }
  if (!is_folder) {
    if (!image_files(path).empty()) return read_stack(path, options);
    if (!fs::exists(status)) refuse(path, "no such file or folder");
    if (const std::optional<VolumeFormat> format = readable_volume_format(path))
      return read_volume_file(path, *format, options);
    need_no_override(path, options);
    if (!is_dicom_seg(path)) return read_dicom(path, options);
    if (!options.series.empty() && !options.join && options.slices.empty())
      return read_dicom_fractions(path, options.series);
    need_no_series(path, options);
    return read_dicom_seg(path);
  }
  // A folder of images may also contain DICOM files. DICOM is tried first because it states positions.
  if (image_files(path).empty()) {
    need_no_override(path, options);
    return read_dicom(path, options);
  }
  try {
    Scene scene = read_dicom(path, options);
    need_no_override(path, options);
    return scene;
  } catch (const Error& refusal) {
    if (refusal.code() != ErrorCode::Input) throw;
    return read_stack(path, options);
  }
}

/// Refuses positions that no scanner produces and for which later sums would overflow.
void need_near_places(const fs::path& path, const Lattice& lattice) {
  constexpr double farthest_mm = 1e9;  // up to this distance doubles resolve 1e-7 mm
  const glm::dvec3 last = glm::dvec3(lattice.dims - 1);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_mm = glm::abs(
        lattice.lps_mm({corner & 1 ? last.x : 0.0, corner & 2 ? last.y : 0.0, corner & 4 ? last.z : 0.0}));
    if (!(std::max({p_mm.x, p_mm.y, p_mm.z}) <= farthest_mm))
      refuse(path, "the header places samples beyond 1e9 mm: correct its origin, its spacing or their unit");
  }
}

/// File names in findings may contain control characters, which would control terminals and break lists.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char symbol) { return static_cast<unsigned char>(symbol) < ' ' || symbol == 0x7f; }, '?');
  return text;
}

}  // namespace

std::vector<SliceRange> parse_slices(const std::string& text) {
  std::vector<SliceRange> slices;
  const auto number = [&](std::string_view part) {
    int value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || value < 1)
      throw InvalidInput("'" + text +
                         "' names no images: give FROM:TO counted from 1, for example "
                         "1:40 or 1:40,45:60");
    return value;
  };
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string_view part(text.data() + at, end - at);
    const std::size_t colon = part.find(':');
    const int first = number(part.substr(0, colon));
    const int last = colon == std::string_view::npos ? first : number(part.substr(colon + 1));
    if (last < first) throw InvalidInput("'" + text + "' ends before it begins: swap FROM and TO");
    slices.push_back({first, last});
    at = end + 1;
  }
  return slices;
}

std::string to_string(const std::vector<SliceRange>& slices) {
  std::string text;
  for (const SliceRange& range : slices)
    text += (text.empty() ? "" : ",") + std::to_string(range.first) + ":" + std::to_string(range.last);
  return text;
}

Scene read_scene(const fs::path& path, const ReadOptions& options) {
  Scene scene = read_any(path, options);
  for (Finding& finding : scene.audit) finding.detail = on_one_line(finding.detail);
  try {
    check(scene);
  } catch (const InvalidInput& flaw) {
    refuse(path, std::string("the header's geometry is unusable: ") + flaw.what());
  }
  need_near_places(path, scene.lattice);
  if (std::optional<Finding> size = size_finding(scene)) scene.audit.push_back(std::move(*size));
  options.progress.at(1.0);
  return scene;
}

}  // namespace octotomy::voxel
