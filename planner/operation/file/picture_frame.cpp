// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/picture_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/picture/png_chunk.h"
#include "voxel/space/error.h"
#include "voxel/space/regular_file.h"

namespace octotomy::planner {
namespace {

constexpr const char* keyword = "octotomy-frame";

/// Directions of two views count as equal if no pixel of the largest picture moves by a tenth of a pixel
/// between them.
constexpr double same_direction = 1e-5;

bool same(const voxel::View& a, const voxel::View& b) {
  return glm::distance(a.look, b.look) < same_direction && glm::distance(a.up, b.up) < same_direction;
}

}  // namespace

voxel::View PictureFrame::view() const {
  voxel::View view;
  view.right = glm::normalize(glm::dvec3(lps_from_pixel[0]));
  view.up = -glm::normalize(glm::dvec3(lps_from_pixel[1]));
  view.look = glm::cross(view.up, view.right);
  return view;
}

glm::dmat3 PictureFrame::view_mm_from_pixel() const {
  const voxel::View seen = view();
  glm::dmat3 matrix;
  for (const int column : {0, 1, 3})
    matrix[std::min(column, 2)] =
        glm::dvec3(seen.project(glm::dvec3(lps_from_pixel[column])), column == 3 ? 1.0 : 0.0);
  return matrix;
}

PictureFrame frame_of(const voxel::ImagePlane& plane) {
  const glm::dvec3 first_mm = plane.lps_mm({0.5, 0.5}, 0.0);
  glm::dmat4 matrix(glm::dvec4(plane.view.right * plane.pixel_mm, 0.0),
                    glm::dvec4(-plane.view.up * plane.pixel_mm, 0.0), glm::dvec4(plane.view.look, 0.0),
                    glm::dvec4(first_mm, 1.0));
  for (int column = 0; column < 4; ++column) matrix[column] += 0.0;  // turns -0 into 0
  return {plane.size_px, matrix};
}

std::optional<voxel::ImageText> image_text(const std::optional<PictureFrame>& frame) {
  if (!frame) return {};
  SortedJson rows = SortedJson::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back(SortedJson::array());
    for (int column = 0; column < 4; ++column) rows.back().push_back(frame->lps_from_pixel[column][row]);
  }
  return voxel::ImageText{
      keyword, SortedJson{{"size_px", {frame->size_px.x, frame->size_px.y}}, {"lps_from_pixel", rows}}.dump(
                   -1, ' ', true)};
}

PictureFrame read_frame(std::string_view png, const std::string& where) {
  voxel::PngText found;
  try {
    found = voxel::png_text(png, keyword);
  } catch (const voxel::InvalidInput& error) {
    refuse(where, error.what());
  }
  if (!found.text)
    refuse(where,
           "does not state the positions of its pixels: use an unchanged .png in true scale from octotomy "
           "render or slice");
  const SortedJson json = SortedJson::parse(*found.text, nullptr, false);
  PictureFrame frame;
  try {
    frame.size_px = {json.at("size_px").at(0).get<int>(), json.at("size_px").at(1).get<int>()};
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        frame.lps_from_pixel[column][row] =
            json.at("lps_from_pixel").at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column));
  } catch (const SortedJson::exception&) {
    refuse(where, "states the positions of its pixels in a form that cannot be read: draw the picture again");
  }
  const double right_mm = glm::length(frame.lps_from_pixel[0]),
               down_mm = glm::length(frame.lps_from_pixel[1]);
  if (!(right_mm > 0.0) || !(down_mm > 0.0) || !voxel::is_frame(frame.view()))
    refuse(where, "states positions of its pixels that are no plane in space: draw the picture again");
  if (frame.size_px != found.size_px)
    refuse(where, "was " + std::to_string(frame.size_px.x) + " x " + std::to_string(frame.size_px.y) +
                      " pixels when it was drawn and is " + std::to_string(found.size_px.x) + " x " +
                      std::to_string(found.size_px.y) +
                      ": its pixels have moved; use the picture in its original size");
  return frame;
}

PictureFrame read_frame(const std::filesystem::path& path) {
  voxel::need_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path.string(), "cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return read_frame(bytes, path.string());
}

std::string name_of(const voxel::View& view) {
  for (const char* name : {"anterior", "posterior", "left", "right", "superior", "inferior"})
    if (same(voxel::parse_view(name), view)) return name;
  const double elevation_deg = glm::degrees(std::asin(std::clamp(-view.look.z, -1.0, 1.0)));
  // For a view straight from above or below, the azimuth follows from `up` alone.
  const glm::dvec3 ahead =
      std::abs(view.look.z) < 1.0 - same_direction ? view.look : -std::copysign(1.0, view.look.z) * view.up;
  const double azimuth_deg = glm::degrees(std::atan2(-ahead.x, ahead.y));
  const std::string name = plain(azimuth_deg) + "," + plain(elevation_deg);
  return same(voxel::parse_view(name), view) ? name : "";
}

}  // namespace octotomy::planner
