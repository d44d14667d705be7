// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/slice_pane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "planner/browser/server/jpeg.h"
#include "planner/browser/server/pane_fields.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/picture/slice.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/operation.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner::serve {
namespace {

constexpr glm::vec3 threshold_tint{255.0f, 196.0f, 0.0f};
constexpr float tint_share = 0.45f;

/// The request as fields of the operation `slice`.
Slice slice_asked(const Json& said, const voxel::Scene& scene) {
  Slice slice;
  const glm::ivec2 size_px = size_px_of(said);
  const voxel::Box box = voxel::bounds(scene.lattice);
  const glm::dvec3 at_mm = point_of(said, "at_mm").value_or(0.5 * (box.low_mm + box.high_mm));
  slice.path = "slice.png";
  slice.plain = true;
  slice.pixel_mm = number_of(said, "pixel_mm")
                       .value_or(1.1 * glm::length(box.high_mm - box.low_mm) / std::sqrt(3.0) /
                                 glm::min(size_px.x, size_px.y));
  if (!(*slice.pixel_mm > 0.0)) throw std::runtime_error("pixel_mm: must be above zero");
  if (const Json window = said.value("window", Json()); window.is_array() && window.size() == 2)
    slice.level = {window[0].get<double>(), std::max(window[1].get<double>(), 1e-6)};
  const Json plane = said.value("plane", Json("axial"));
  if (plane.is_object() && plane.contains("curve_mm")) {
    for (const Json& point : plane["curve_mm"])
      slice.curve_mm.emplace_back(point.at(0).get<double>(), point.at(1).get<double>(),
                                  point.at(2).get<double>());
    if (const auto height = number_of(plane, "height_mm")) slice.height_mm = *height;
    return slice;
  }
  slice.size = std::to_string(size_px.x) + "x" + std::to_string(size_px.y);
  slice.centre_mm = point_of(said, "centre_mm").value_or(at_mm);
  if (plane.is_object()) {
    const auto normal = point_of(plane, "normal");
    if (!normal) throw std::runtime_error("plane: needs a normal");
    slice.oblique = {at_mm, *normal};
    slice.up = point_of(plane, "up");
  } else if (plane == "axial") {
    slice.axial = exact(at_mm.z);
  } else if (plane == "coronal") {
    slice.coronal = exact(at_mm.y);
  } else if (plane == "sagittal") {
    slice.sagittal = exact(at_mm.x);
  } else {
    throw std::runtime_error(
        "plane: must be axial, coronal, sagittal, or an object with a normal or curve_mm");
  }
  return slice;
}

void set_pixel(std::vector<std::uint8_t>& rgb, std::size_t pixel, const glm::vec3& colour, float share) {
  for (int channel = 0; channel < 3; ++channel) {
    std::uint8_t& byte = rgb[3 * pixel + static_cast<std::size_t>(channel)];
    byte = static_cast<std::uint8_t>(
        std::lround((1.0f - share) * static_cast<float>(byte) + share * colour[channel]));
  }
}

/// Tints the samples between two bounds. A bound that is null does not limit them.
void draw_threshold(const Json& threshold, SlicePicture& picture) {
  if (!threshold.is_array() || threshold.size() != 2) return;
  for (std::size_t i = 0; i < picture.samples.inside.size(); ++i) {
    const double value = picture.samples.image.values[i];
    if (picture.samples.inside[i] != 0 && (threshold[0].is_null() || value >= threshold[0].get<double>()) &&
        (threshold[1].is_null() || value <= threshold[1].get<double>()))
      set_pixel(picture.rgb, i, threshold_tint, tint_share);
  }
}

/// The frame of a slice's pixels as JSON. For a curved slice, the frame is that at the middle of its curve.
Json sheet_frame(const voxel::Sheet& sheet) {
  const glm::ivec2 size_px = sheet.size_px();
  const std::size_t left = static_cast<std::size_t>((size_px.x - 1) / 2);
  const std::size_t right = std::min(left + 1, sheet.columns_mm.size() - 1);
  voxel::View view;
  view.up = -sheet.down;
  if (right > left) view.right = glm::normalize(sheet.columns_mm[right] - sheet.columns_mm[left]);
  view.look = glm::cross(view.up, view.right);
  glm::dvec3 middle_mm = sheet.columns_mm[left];
  if (size_px.x % 2 == 0) middle_mm = 0.5 * (middle_mm + sheet.columns_mm[right]);
  return view_frame_json(view, middle_mm + sheet.down * (0.5 * (size_px.y - 1) * sheet.pixel_mm),
                         sheet.pixel_mm);
}

}  // namespace

Message draw_slice(Session& session, const Request& request, const std::stop_token& stop) {
  const Json& said = request.said;
  const Snapshot snapshot = session.snapshot();
  if (!snapshot.evaluation || snapshot.evaluation->loaded.empty())
    throw std::runtime_error("no scan is open");
  const auto& loaded = snapshot.evaluation->loaded;
  const auto named = loaded.find(said.value("scan", loaded.begin()->first));
  if (named == loaded.end()) throw std::runtime_error("scan: the plan has no scan of that name");
  const voxel::Scene& scene = named->second->scene();
  Slice slice = slice_asked(said, scene);
  Session::Preview preview;
  std::string replaced;
  const Json asked = said.value("preview", Json());
  if (asked.is_object()) {
    replaced = asked.at("object");
    const auto against = asked.value("against", std::vector<std::string>{});
    preview =
        session.preview(asked, said.value("overlap", false) ? against : std::vector<std::string>{}, stop);
  }
  std::vector<Outlined> outlined, hatched;
  std::vector<std::string> hatch_colours;
  Json drawn = Json::array();
  for (const Json& entry : said.value("objects", Json::array())) {
    if (!entry.contains("id")) continue;
    const std::string id = entry["id"];
    const bool is_dragged = preview.evaluation && id == replaced;
    const std::string sought = is_dragged ? Session::Preview::moved : id;
    for (const Object& object : (is_dragged ? *preview.evaluation : *snapshot.evaluation).objects) {
      if (object.id != sought || object.voxel.octree.is_empty()) continue;
      drawn.push_back(id);
      if (entry.value("hatched", false)) {
        hatch_colours.push_back(entry.value("colour", text_of_colour(interference_colour())));
        slice.hatched.push_back({id});
        hatched.push_back({id, object.voxel.octree, true});
        continue;
      }
      slice.colours.push_back(entry.value("colour", text_of_colour(colour_of(outlined.size() + 1))));
      slice.objects.push_back({id});
      outlined.push_back({id, object.voxel.octree});
    }
  }
  // The previewed object is added if no drawn object was replaced by it.
  if (const Object* made = preview.object(); made != nullptr && !made->voxel.octree.is_empty() &&
                                             std::find(drawn.begin(), drawn.end(), replaced) == drawn.end()) {
    drawn.push_back(replaced);
    hatch_colours.push_back(said["preview"].value("colour", text_of_colour(colour_of(outlined.size() + 1))));
    slice.hatched.push_back({made->id});
    hatched.push_back({made->id, made->voxel.octree, true});
  }
  if (preview.evaluation)
    for (const Object& object : preview.evaluation->objects)
      if (object.id == Session::Preview::overlap && !object.voxel.octree.is_empty()) {
        hatch_colours.push_back(text_of_colour(interference_colour()));
        hatched.push_back({object.id, object.voxel.octree, true});
      }
  const Json difference = difference_json(asked, preview);
  if (!difference.is_null())
    for (const DifferencePart& part : difference_parts) {
      const voxel::Octree& octree = preview.evaluation->object(part.id).voxel.octree;
      if (part.id == Session::Preview::common || octree.is_empty()) continue;
      hatch_colours.emplace_back(part.colour);
      hatched.push_back({part.id, octree, true});
    }
  outlined.insert(outlined.end(), hatched.begin(), hatched.end());
  slice.colours.insert(slice.colours.end(), hatch_colours.begin(), hatch_colours.end());
  Timings timings;
  SlicePicture picture = slice_of(slice, scene, outlined, timings, stop);
  const glm::ivec2 size_px = picture.sheet.size_px();
  const bool is_moving = said.value("dragging", false);
  Json header{{"id", request.id},
              {"pane", said.value("pane", 0)},
              {"quality", is_moving ? "moving" : "rest"},
              {"width", size_px.x},
              {"height", size_px.y},
              {"objects", drawn},
              {"letters", picture.said.at("letters")},
              {"view_frame", sheet_frame(picture.sheet)}};
  Session::describe(preview, header);
  if (!difference.is_null()) header["difference"] = difference;
  const Json threshold = said.value("threshold", Json());
  draw_threshold(threshold, picture);
  if (is_moving) return packed(header, {{"jpeg", jpeg_of(size_px, picture.rgb)}});
  if (threshold.is_null() && !preview.evaluation) {
    slice.scan.name = named->first;
    Json step{{"do", "slice"}};
    step.update(print_fields(find_operation("slice")->fields, &slice));
    header["step"] = step;
  }
  std::vector<float>& values = picture.samples.image.values;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (picture.samples.inside[i] == 0) values[i] = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::uint8_t> png =
      voxel::encode_image("png", size_px, picture.rgb, image_text(picture.frame));
  return packed(header, {{"png", std::string(png.begin(), png.end())},
                         {"value", deflated(values.data(), 4 * values.size())}});
}

}  // namespace octotomy::planner::serve
