// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/io/read_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "brep/io/dicom_model.h"
#include "brep/io/mesh_bytes.h"
#include "brep/io/mesh_scanner.h"
#include "brep/io/weld_seams.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

/// Refuses glTF as text: its points are in another file beside it, or in its text as base64.
MeshContent refuse_gltf_text(std::string_view /*bytes*/) {
  throw Error(ErrorCode::Input, "is glTF as text, which cannot be read: save it as .glb, its binary form");
}

struct Format {
  std::string_view extension;
  MeshContent (*read)(std::string_view bytes);
  bool is_text;         ///< a file of this format is, or may be, text
  bool repeats_points;  ///< files repeat a point whose attributes differ between triangles
};
constexpr Format dicom_format{".dcm", read_dicom_model, false, true};
constexpr std::array<Format, 10> formats{{{".stl", read_stl, true, false},
                                          {".ply", read_ply, true, true},
                                          {".obj", read_obj, true, true},
                                          {".off", read_off, true, false},
                                          {".vtk", read_vtk, true, true},
                                          {".vtp", read_vtk_xml, true, true},
                                          {".vtu", read_vtk_xml, true, true},
                                          {".glb", read_glb, false, false},
                                          {".gltf", refuse_gltf_text, false, false},
                                          {".3mf", read_3mf, false, false}}};

const Format* format_of(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  const auto found = std::find_if(formats.begin(), formats.end(),
                                  [&](const Format& format) { return format.extension == extension; });
  if (found != formats.end()) return &*found;
  return (extension.empty() || extension == dicom_format.extension) && is_dicom_model(path) ? &dicom_format
                                                                                            : nullptr;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::error_code error;
  // Refuses a pipe or a device, which may never end.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    throw Error(ErrorCode::Input, "is not a regular file: copy it into one first");
  std::ifstream file(path, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!file || error) throw Error(ErrorCode::Input, "cannot be read; check its name and permissions");
  std::string bytes(size, '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw Error(ErrorCode::Input, "reading broke off");
  return bytes;
}

/// Removes a byte-order mark. If lines end in a single carriage return, as on old Macs, replaces it by a line
/// feed.
std::string_view plain_text(std::string& bytes) {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if ((bytes.starts_with("\xff\xfe") && bytes.substr(3, 1) == std::string(1, '\0')) ||
      (bytes.starts_with("\xfe\xff") && bytes.substr(2, 1) == std::string(1, '\0')))
    throw Error(ErrorCode::Input, "is text in UTF-16: save it as plain text (UTF-8)");
  if (bytes.find('\n') == std::string::npos && bytes.find('\0') == std::string::npos)
    std::replace(bytes.begin(), bytes.end(), '\r', '\n');
  return std::string_view(bytes).substr(bytes.starts_with(mark) ? mark.size() : 0);
}

/// Up to this limit, sums of a thousand products of sixteen coordinates are finite. The longest products in
/// use have six factors: the oriented box compares fractions of areas by squares of sides (CGAL,
/// Area_less_rectangle_2).
const double largest_coordinate_mm =
    std::pow(std::numeric_limits<double>::max() / 1e3, 1.0 / 16.0);  // 1.2e19

void need_reach(const Triangles& triangles) {
  for (std::size_t i = 0; i < triangles.points_mm.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (const double x = triangles.points_mm[i][axis]; !(std::abs(x) <= largest_coordinate_mm))
        throw Error(ErrorCode::Input, "point " + std::to_string(i) + " has a coordinate of " + short_text(x) +
                                          " mm, beyond the largest, " + short_text(largest_coordinate_mm) +
                                          " mm: the file is damaged, or its unit is another one");
}

void turn_to_lps(Triangles& triangles, const std::string& frame, double scale) {
  if (frame == "LPS" && scale == 1.0) return;
  const glm::dmat3 lps = lps_from(frame);
  // Adding 0 turns -0 into 0.
  for (glm::dvec3& p : triangles.points_mm) p = lps * (p * scale) + 0.0;
  if (glm::determinant(lps) < 0.0)
    for (auto& face : triangles.faces) std::swap(face[1], face[2]);
}

/// A finding on the size alone: no object of a patient or of an operation is smaller than a millimetre or
/// longer than three metres.
MeshFinding size_finding(const MeshFile& file) {
  const glm::dvec3 side = file.extent().high_mm - file.extent().low_mm;
  const double longest = std::max({side.x, side.y, side.z});
  const bool is_odd = !file.triangles.points_mm.empty() && (longest < 1.0 || longest > 3000.0);
  return {"size", is_odd ? MeshVerdict::Warn : MeshVerdict::Pass,
          short_text(side.x) + " x " + short_text(side.y) + " x " + short_text(side.z) + " mm" +
              (is_odd ? ": its unit may be another one; give it by --unit um, cm, m or inch" : "")};
}

MeshFile read_bytes(std::string bytes, const Format& format, const MeshReadOptions& options) {
  if (bytes.empty()) throw Error(ErrorCode::Input, "the file is empty");
  MeshContent content = format.read(format.is_text ? plain_text(bytes) : std::string_view(bytes));
  MeshStatements::Resolved resolved = content.says.resolved(options.frame, options.unit);
  MeshFile made{std::move(content.triangles), std::move(resolved.audit)};
  const std::vector<MeshFinding> welded =
      format.repeats_points ? weld_seams(made.triangles) : drop_repeating(made.triangles);
  turn_to_lps(made.triangles, resolved.frame, resolved.unit.mm / content.scale);
  need_reach(made.triangles);
  made.audit.push_back(size_finding(made));
  for (MeshFinding& finding : content.polygons.findings(resolved.unit.mm / content.scale))
    made.audit.push_back(std::move(finding));
  made.audit.insert(made.audit.end(), welded.begin(), welded.end());
  return made;
}

}  // namespace

const char* const mesh_formats_read =
    ".stl, .ply, .obj, .off, .vtk, .vtp, .vtu, .glb, .3mf or a .dcm that holds a surface";

bool is_mesh_file(const std::filesystem::path& path) {
  return format_of(path) != nullptr;
}

Extent MeshFile::extent() const {
  if (triangles.points_mm.empty()) return {};
  Extent extent{triangles.points_mm.front(), triangles.points_mm.front()};
  for (const glm::dvec3& p : triangles.points_mm) {
    extent.low_mm = glm::min(extent.low_mm, p);
    extent.high_mm = glm::max(extent.high_mm, p);
  }
  return extent;
}

MeshFile read_mesh(const std::filesystem::path& path, const MeshReadOptions& options) {
  try {
    const Format* format = format_of(path);
    if (format == nullptr)
      throw Error(ErrorCode::Input, "'" + lower_extension(path) +
                                        "' is not a mesh format that can be read; use " + mesh_formats_read);
    return read_bytes(bytes_of(path), *format, options);
  } catch (const std::runtime_error& e) {
    throw Error(ErrorCode::Input, path.string() + ": " + e.what());
  }
}

Triangles read_triangles(const std::filesystem::path& path, const MeshReadOptions& options) {
  return read_mesh(path, options).triangles;
}

}  // namespace octotomy::brep
