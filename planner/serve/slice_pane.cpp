// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/serve/slice_pane.h"

#include <cmath>
#include <limits>

#include "planner/picture/colour.h"
#include "planner/serve/jpeg.h"
#include "planner/serve/pane_fields.h"
#include "voxel/scan/image_file.h"
#include "voxel/solid/combine.h"
#include "voxel/view/reformat.h"

namespace octotomy::planner::serve {
namespace {

constexpr glm::vec3 threshold_tint{255.0f, 196.0f, 0.0f};
constexpr float tint_share = 0.45f;

/// The plane's view: a name's, in the radiological convention, or one by its normal.
voxel::View view_of(const Json& plane) {
  if (plane.is_string()) {
    const std::string name = plane;
    if (name == "axial") return voxel::parse_view("inferior");
    if (name == "coronal") return voxel::parse_view("anterior");
    if (name == "sagittal") return voxel::parse_view("left");
    throw std::runtime_error("plane: '" + name + "' is none of axial, coronal and sagittal");
  }
  const auto normal = point_of(plane, "normal");
  const glm::dvec3 up = point_of(plane, "up").value_or(glm::dvec3(0, 0, 1));
  if (!normal || !(glm::length(*normal) > 0.0)) throw std::runtime_error("plane: needs a normal");
  voxel::View view;
  view.look = glm::normalize(*normal);
  const glm::dvec3 across = up - view.look * glm::dot(up, view.look);
  if (!(glm::length(across) > 0.0)) throw std::runtime_error("plane: 'up' points along the normal");
  view.up = glm::normalize(across);
  view.right = glm::cross(view.look, view.up);
  return view;
}

/// A pane's rectangle of a plane.
voxel::Sheet sheet_of(const voxel::View& view, const glm::dvec3& centre_mm, const glm::ivec2& size_px,
                      double pixel_mm) {
  voxel::Sheet sheet;
  sheet.down = -view.up;
  sheet.pixel_mm = pixel_mm;
  sheet.height_px = size_px.y;
  const glm::dvec3 top = centre_mm + view.up * (0.5 * (size_px.y - 1) * pixel_mm);
  for (int column = 0; column < size_px.x; ++column)
    sheet.columns_mm.push_back(top + view.right * ((column - 0.5 * (size_px.x - 1)) * pixel_mm));
  return sheet;
}

void set_pixel(std::vector<std::uint8_t>& rgb, std::size_t pixel, const glm::vec3& colour, float share) {
  for (int channel = 0; channel < 3; ++channel) {
    std::uint8_t& byte = rgb[3 * pixel + static_cast<std::size_t>(channel)];
    byte = static_cast<std::uint8_t>(
        std::lround((1.0f - share) * static_cast<float>(byte) + share * colour[channel]));
  }
}

void draw_outlines(const Snapshot& snapshot, const Json& objects, const voxel::Sheet& sheet,
                   std::vector<std::uint8_t>& rgb, Json& drawn) {
  for (const Json& entry : objects) {
    if (!entry.contains("id")) continue;
    const std::string id = entry["id"];
    for (const Object& object : snapshot.evaluation->objects) {
      if (object.id != id || object.voxel.octree.is_empty()) continue;
      const auto edge = voxel::outline(voxel::cut(object.voxel.octree, sheet), sheet.size_px());
      const glm::vec3 colour =
          255.0f * need_colour(entry.value("colour", text_of_colour(colour_of(drawn.size() + 1))));
      for (std::size_t i = 0; i < edge.size(); ++i)
        if (edge[i] != 0) set_pixel(rgb, i, colour, 1.0f);
      drawn.push_back(id);
    }
  }
}

}  // namespace

Message draw_slice(const Desk& desk, const Request& request, const std::stop_token& stop) {
  const Json& said = request.said;
  const Snapshot snapshot = desk.snapshot();
  if (!snapshot.evaluation || snapshot.evaluation->loaded.empty())
    throw std::runtime_error("no scan is open");
  const auto& loaded = snapshot.evaluation->loaded;
  const auto named = loaded.find(said.value("scan", loaded.begin()->first));
  if (named == loaded.end()) throw std::runtime_error("scan: there is none of that name");
  const voxel::Scene& scene = named->second->scene();
  const glm::ivec2 size_px = size_px_of(said);
  const voxel::View view = view_of(said.value("plane", Json("axial")));
  const voxel::Box box = voxel::bounds(scene.lattice);
  const glm::dvec3 middle_mm = 0.5 * (box.low_mm + box.high_mm);
  const glm::dvec3 at_mm = point_of(said, "at_mm").value_or(middle_mm);
  const double pixel_mm = number_of(said, "pixel_mm")
                              .value_or(1.1 * glm::length(box.high_mm - box.low_mm) / std::sqrt(3.0) /
                                        glm::min(size_px.x, size_px.y));
  if (!(pixel_mm > 0.0)) throw std::runtime_error("pixel_mm: must be above zero");
  const glm::dvec3 wanted = point_of(said, "centre_mm").value_or(at_mm);
  const glm::dvec3 centre_mm = wanted + view.look * glm::dot(at_mm - wanted, view.look);
  const voxel::Sheet sheet = sheet_of(view, centre_mm, size_px, pixel_mm);
  const voxel::SheetSamples samples = voxel::sample(scene, sheet, voxel::Interpolation::Linear, {stop, {}});

  double level = 500.0, width = 2000.0;
  if (const Json window = said.value("window", Json()); window.is_array() && window.size() == 2) {
    level = window[0].get<double>();
    width = window[1].get<double>();
  }
  std::vector<std::uint8_t> rgb =
      voxel::grey_tones(samples.image, level - 0.5 * width, level + 0.5 * std::max(width, 1e-6));
  const Json threshold = said.value("threshold", Json());
  for (std::size_t i = 0; i < samples.inside.size(); ++i) {
    if (samples.inside[i] == 0) {
      std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0);
    } else if (threshold.is_array() && threshold.size() == 2) {
      const double value = samples.image.values[i];
      const bool is_in = (threshold[0].is_null() || value >= threshold[0].get<double>()) &&
                         (threshold[1].is_null() || value <= threshold[1].get<double>());
      if (is_in) set_pixel(rgb, i, threshold_tint, tint_share);
    }
  }
  Json drawn = Json::array();
  draw_outlines(snapshot, said.value("objects", Json::array()), sheet, rgb, drawn);

  const bool is_moving = said.value("dragging", false);
  const voxel::EdgeLetters letters = voxel::edge_letters(sheet);
  const Json header{
      {"id", request.id},
      {"pane", said.value("pane", 0)},
      {"quality", is_moving ? "moving" : "rest"},
      {"width", size_px.x},
      {"height", size_px.y},
      {"objects", drawn},
      {"letters",
       {{"left", letters.left}, {"right", letters.right}, {"top", letters.top}, {"bottom", letters.bottom}}},
      {"view_frame", view_frame_json(view, centre_mm, pixel_mm)}};
  if (is_moving) return packed(header, {{"jpeg", jpeg_of(size_px, rgb)}});
  std::vector<float> values = samples.image.values;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (samples.inside[i] == 0) values[i] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::uint8_t> png = voxel::encode_image("png", size_px, rgb);
  return packed(header, {{"png", std::string(png.begin(), png.end())},
                         {"value", deflated(values.data(), 4 * values.size())}});
}

}  // namespace octotomy::planner::serve
