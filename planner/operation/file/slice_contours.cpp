// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/slice_contours.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "brep/contour/chain_code.h"
#include "brep/contour/contour_edit.h"
#include "brep/contour/fourier_smooth.h"
#include "brep/contour/offset_contours.h"
#include "brep/contour/thin.h"
#include "brep/mesh/error.h"
#include "convert/surface/trace_contours.h"
#include "planner/operation/file/picture_frame.h"
#include "planner/operation/table/comma_numbers.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/crop.h"
#include "voxel/filter/slice_contour.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

using Polygon = std::vector<glm::dvec2>;

std::string place_of(const voxel::SliceMask::Slice& slice) {
  return "the slice at " + std::to_string(slice.position_mm) + " mm";
}

[[noreturn]] void refuse_crossing(const brep::Contour& contour,
                                  const std::pair<std::size_t, std::size_t>& pieces,
                                  const std::string& where) {
  const glm::dvec2 at = contour.points_mm[pieces.first];
  throw std::runtime_error(where + ": a contour crosses itself between its pieces " +
                           std::to_string(pieces.first) + " and " + std::to_string(pieces.second) +
                           ", near [" + std::to_string(at.x) + ", " + std::to_string(at.y) + "]");
}

/// Removes empty slices at either end except the innermost one, because an empty slice marks the object's
/// end.
void drop_empty_ends(std::vector<voxel::SliceMask::Slice>& slices) {
  const auto empty = [](const auto& slice) { return slice.polygons_mm.empty(); };
  while (slices.size() > 2 && empty(slices.back()) && empty(slices[slices.size() - 2])) slices.pop_back();
  std::size_t leading = 0;
  while (leading + 2 < slices.size() && empty(slices[leading]) && empty(slices[leading + 1])) ++leading;
  slices.erase(slices.begin(), slices.begin() + static_cast<std::ptrdiff_t>(leading));
}

/// The points of a contour; none if it crosses itself.
std::optional<Polygon> uncrossed(const brep::Contour& contour) {
  if (brep::first_crossing(contour)) return std::nullopt;
  return contour.points_mm;
}

struct Refined {
  Polygon points_mm;
  std::size_t harmonics = 0;  ///< number of harmonics used, if more than requested were needed to avoid a
                              ///< crossing; else 0
  bool is_left = false;       ///< the contour stays unchanged, because it would cross itself
};

/// Thins and smooths a contour. If the smoothed contour crosses itself, doubles the number of harmonics
/// repeatedly, up to a quarter of the contour's points. If it still crosses itself, returns it unchanged.
Refined refined_contour(const Polygon& points_mm, const Refinement& refinement) {
  brep::Contour contour{points_mm};
  if (refinement.thin_mm > 0.0) contour = brep::thin(contour, refinement.thin_mm);
  if (!refinement.harmonics) {
    if (refinement.thin_mm > 0.0 && brep::first_crossing(contour)) return {points_mm, 0, true};
    return {contour.points_mm};
  }
  const std::size_t most = std::max(*refinement.harmonics, contour.points_mm.size() / 4);
  for (std::size_t harmonics = *refinement.harmonics; harmonics <= most; harmonics *= 2)
    if (std::optional<Polygon> smooth = uncrossed(brep::fourier_smooth(
            contour, {.harmonics = harmonics, .points = std::max(contour.points_mm.size(), 4 * harmonics)})))
      return {std::move(*smooth), harmonics == *refinement.harmonics ? 0 : harmonics};
  return {points_mm, 0, true};
}

/// Refines a polygon as refined_contour() does. Adds a finding if it is smoothed less than requested or stays
/// unchanged.
Polygon refined_at(const Polygon& polygon, const Refinement& refinement, const voxel::SliceMask::Slice& slice,
                   std::vector<std::string>& findings) {
  Refined done = refined_contour(polygon, refinement);
  if (done.is_left)
    findings.push_back(place_of(slice) + ": a contour of " + std::to_string(polygon.size()) +
                       " points stays unchanged, because it would cross itself after thinning or smoothing");
  else if (done.harmonics > 0)
    findings.push_back(place_of(slice) + ": a contour of " + std::to_string(polygon.size()) +
                       " points would cross itself if smoothed to " + std::to_string(*refinement.harmonics) +
                       " harmonics and has " + std::to_string(done.harmonics));
  return std::move(done.points_mm);
}

/// A contour while it is edited.
struct EditedContour {
  brep::Contour contour;
  bool is_uncrossed = false;  ///< it was checked and does not cross itself
};
/// Of each slice.
using EditedSlices = std::vector<std::vector<EditedContour>>;

/// One edit of a file: its JSON, its place in the file, and the contours of its slice.
class Edit {
 public:
  Edit(const nlohmann::json& json, std::string where, EditedSlices& slices)
      : json_(json), where_(std::move(where)), contours_(slices[index("slice", slices.size())]) {}

  void make() {
    const std::string what = word_of(need(json_, "do", where_), where_ + ".do");
    if (what == "add") {
      known({"points_mm"}, false);
      brep::Contour added;
      for (const nlohmann::json& point : need(json_, "points_mm", where_))
        added.points_mm.push_back(point_of(point, where_ + ".points_mm"));
      if (added.points_mm.size() < 3) refuse(where_ + ".points_mm", "must be three points or more");
      contours_.push_back({std::move(added)});
      return check(contours_.size() - 1);
    }
    const std::size_t number = index("contour", contours_.size());
    const brep::Contour& contour = contours_[number].contour;
    if (what == "move") {
      known({"point", "to_mm"});
      put(number, brep::point_moved(contour, count("point"), point("to_mm")));
      check_about(number, count("point"));
    } else if (what == "insert") {
      known({"piece", "at_mm"});
      put(number, brep::point_inserted(contour, count("piece"), point("at_mm")));
      check_about(number, count("piece") + 1);
    } else if (what == "delete") {
      known({"point"});
      put(number, brep::point_deleted(contour, count("point")));
      check_edit(number, {piece_before(number, count("point"))});
    } else if (what == "split") {
      known({"first", "second"});
      auto [first, second] = brep::split(contour, count("first"), count("second"));
      put(number, std::move(first));
      contours_.push_back({std::move(second), contours_[number].is_uncrossed});
      // The last piece of either part closes it, so only that piece is new.
      for (const std::size_t part : {number, contours_.size() - 1}) check_edit(part, {piece_before(part, 0)});
    } else if (what == "join") {
      known({"piece", "with", "its_piece"});
      const std::size_t other = index("with", contours_.size());
      if (other == number) refuse(where_ + ".with", "is the contour itself");
      put(number, brep::joined(contour, count("piece"), contours_[other].contour, count("its_piece")));
      check(number);
      remove(other);
    } else if (what == "remove") {
      known({});
      remove(number);
    } else {
      refuse(where_ + ".do", "must be move, insert, delete, split, join, remove or add, not '" + what + "'");
    }
  }

 private:
  std::size_t count(const std::string& key) const {
    return count_of(need(json_, key, where_), where_ + "." + key);
  }
  std::size_t index(const std::string& key, std::size_t end) const {
    const std::size_t number = count(key);
    if (number >= end) refuse(where_ + "." + key, "there are " + std::to_string(end) + ", counted from 0");
    return number;
  }
  glm::dvec2 point(const std::string& key) const {
    return point_of(need(json_, key, where_), where_ + "." + key);
  }
  void known(std::vector<std::string> keys, bool of_a_contour = true) const {
    keys.insert(keys.end(), {"slice", "do"});
    if (of_a_contour) keys.emplace_back("contour");
    check_keys(json_, where_, keys);
  }
  void put(std::size_t number, brep::Contour contour) { contours_[number].contour = std::move(contour); }
  void remove(std::size_t number) {
    contours_.erase(contours_.begin() + static_cast<std::ptrdiff_t>(number));
  }
  /// The number of the piece that ends at a point. `point` may be one beyond the last point.
  std::size_t piece_before(std::size_t number, std::size_t point) const {
    return point == 0 ? contours_[number].contour.points_mm.size() - 1 : point - 1;
  }
  /// Throws if a contour crosses itself.
  void check(std::size_t number) {
    const brep::Contour& contour = contours_[number].contour;
    if (const auto crossing = brep::first_crossing(contour)) refuse_crossing(contour, *crossing, where_);
    contours_[number].is_uncrossed = true;
  }
  /// Throws if a contour crosses itself, after an edit that changed only these pieces.
  void check_edit(std::size_t number, const std::vector<std::size_t>& changed) {
    if (!contours_[number].is_uncrossed) return check(number);
    const brep::Contour& contour = contours_[number].contour;
    if (const auto crossing = brep::first_crossing_of(contour, changed))
      refuse_crossing(contour, *crossing, where_);
  }
  /// Throws if a contour crosses itself, after an edit that moved or inserted only this point.
  void check_about(std::size_t number, std::size_t point) {
    check_edit(number, {piece_before(number, point), point});
  }

  const nlohmann::json& json_;
  std::string where_;
  std::vector<EditedContour>& contours_;
};

/// The view along the normal of a scan's slices. Throws if the slices are oblique to the patient's axes.
voxel::View view_of_slices(const voxel::Scene& scene) {
  try {
    return voxel::parse_view(voxel::contour_view(scene.lattice));
  } catch (const voxel::InvalidInput& error) {
    throw std::runtime_error(std::string(error.what()) +
                             ": straighten the scan first, for example by octotomy prepare");
  }
}

/// The mask of the contours in a scan's slices.
voxel::SliceMask mask_of(const voxel::Scene& scene, const std::vector<brep::Section>& sections) {
  voxel::SliceMask mask;
  mask.view = view_of_slices(scene);
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  bool is_empty = true;
  for (const brep::Section& section : sections) {
    const auto lps = [&](const glm::dvec2& p) {
      return scene.lattice.lps_mm(glm::dvec3(p, section.z_mm) / spacing);
    };
    voxel::SliceMask::Slice slice;
    slice.position_mm = glm::dot(lps({0.0, 0.0}), mask.view.look);
    for (const brep::Contour& contour : section.contours) {
      slice.polygons_mm.emplace_back();
      for (const glm::dvec2& p : contour.points_mm)
        slice.polygons_mm.back().push_back(mask.view.project(lps(p)));
    }
    is_empty = is_empty && slice.polygons_mm.empty();
    mask.slices.push_back(std::move(slice));
  }
  if (is_empty) throw std::runtime_error("no slice has samples in the window: choose another window");
  if (mask.slices.size() < 2)
    throw std::runtime_error("the scan has one slice, but contours on parallel slices need at least two");
  if (mask.slices.front().position_mm > mask.slices.back().position_mm)
    std::reverse(mask.slices.begin(), mask.slices.end());
  drop_empty_ends(mask.slices);
  return mask;
}

/// The number of the slice nearest to a position in the view of the contours. Throws if none is within half a
/// slice's distance.
int slice_at(const voxel::Scene& scene, double position_mm) {
  const voxel::View view = view_of_slices(scene);
  const double first_mm = glm::dot(scene.lattice.lps_mm(glm::dvec3(0.0)), view.look);
  const double step_mm = glm::dot(scene.lattice.lps_mm({0.0, 0.0, 1.0}), view.look) - first_mm;
  const double k = std::round((position_mm - first_mm) / step_mm);
  if (!(k >= 0.0 && k < scene.lattice.dims.z)) {
    const double last_mm = first_mm + step_mm * (scene.lattice.dims.z - 1);
    throw std::runtime_error("there is no slice at " + plain(position_mm) + " mm: slices lie from " +
                             plain(std::min(first_mm, last_mm)) + " to " +
                             plain(std::max(first_mm, last_mm)) + " mm");
  }
  return static_cast<int>(k);
}

}  // namespace

voxel::SliceMask slice_contours(const voxel::Scene& scene, double low, double high) {
  return mask_of(scene, convert::trace_contours(scene, low, high));
}

SliceWindow parse_slice_window(const std::string& text) {
  const auto equals = text.find('=');
  const std::optional<double> position_mm = number_in(text.substr(0, equals));
  if (equals == std::string::npos || !position_mm)
    throw std::runtime_error("'" + text +
                             "' is not a window of a slice: write POSITION=LOW:HIGH, for example 30=250:");
  return {*position_mm, parse_sample_window(text.substr(equals + 1))};
}

voxel::SliceMask slice_contours(const voxel::Scene& scene, const std::optional<SampleWindow>& window,
                                const std::vector<SliceWindow>& own) {
  std::vector<brep::Section> sections;
  if (window) {
    sections = convert::trace_contours(scene, window->low, window->high_or_infinity());
  } else {
    const double slice_mm = scene.lattice.spacing_mm().z;
    for (int k = 0; k < scene.lattice.dims.z; ++k) sections.push_back({k * slice_mm, {}});
  }
  if (own.empty()) return mask_of(scene, sections);
  std::set<int> done;
  for (const SliceWindow& slice : own) {
    const int k = slice_at(scene, slice.position_mm);
    if (!done.insert(k).second)
      throw std::runtime_error("the slice at " + plain(slice.position_mm) +
                               " mm has two separate windows: leave out one of them");
    const voxel::Scene alone =
        voxel::crop(scene, {{0, 0, k}, {scene.lattice.dims.x - 1, scene.lattice.dims.y - 1, k}});
    sections[static_cast<std::size_t>(k)].contours = std::move(
        convert::trace_contours(alone, slice.window.low, slice.window.high_or_infinity()).front().contours);
  }
  return mask_of(scene, sections);
}

voxel::SliceMask refined(const voxel::SliceMask& mask, const Refinement& refinement,
                         std::vector<std::string>& findings) {
  voxel::SliceMask result = mask;
  bool is_empty = true;
  for (voxel::SliceMask::Slice& slice : result.slices) {
    std::vector<brep::Contour> contours;
    for (const Polygon& polygon : slice.polygons_mm)
      if (std::abs(brep::signed_area_mm2({polygon})) >= refinement.least_area_mm2)
        contours.push_back({refined_at(polygon, refinement, slice, findings)});
    try {
      if (refinement.offset_mm != 0.0) contours = brep::offset(contours, refinement.offset_mm);
    } catch (const brep::InvalidInput& error) {
      throw std::runtime_error(place_of(slice) + ": " + error.what());
    }
    slice.polygons_mm.clear();
    for (brep::Contour& contour : contours) slice.polygons_mm.push_back(std::move(contour.points_mm));
    is_empty = is_empty && slice.polygons_mm.empty();
  }
  if (is_empty)
    throw std::runtime_error(
        "no contour remains: reduce the thinning, the smoothing, the least area or the inward offset");
  return result;
}

voxel::SliceMask edited(const voxel::SliceMask& mask, const std::filesystem::path& edits) {
  const nlohmann::json json = read_json(edits);
  check_keys(json, edits.string(), {"edits"});
  const nlohmann::json& list = need(json, "edits", edits.string());
  if (!list.is_array()) refuse(edits.string() + ": edits", "must be a list");
  EditedSlices slices;
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    slices.emplace_back();
    for (const Polygon& polygon : slice.polygons_mm) slices.back().push_back({{polygon}});
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string where = edits.string() + ": edits[" + std::to_string(i) + "]";
    if (!list[i].is_object()) refuse(where, "must be an object");
    try {
      Edit(list[i], where, slices).make();
    } catch (const brep::InvalidInput& error) {
      refuse(where, error.what());
    }
  }
  voxel::SliceMask result = mask;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    result.slices[k].polygons_mm.clear();
    for (EditedContour& edited : slices[k])
      result.slices[k].polygons_mm.push_back(std::move(edited.contour.points_mm));
  }
  return result;
}

Json to_json(const voxel::SliceMask& mask) {
  Json slices = Json::array();
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    Json polygons = Json::array();
    for (const Polygon& polygon : slice.polygons_mm) {
      polygons.emplace_back(Json::array());
      for (const glm::dvec2& p : polygon) polygons.back().push_back({p.x, p.y});
    }
    slices.push_back({{"position_mm", slice.position_mm}, {"polygons_mm", std::move(polygons)}});
  }
  return {{"view", name_of(mask.view)},
          {"between", mask.between == voxel::SliceMask::Between::Nearest ? "nearest" : "shape_based"},
          {"slices", std::move(slices)}};
}

Json chain_codes(const voxel::SliceMask& mask, double spacing_mm) {
  Json slices = Json::array();
  for (const voxel::SliceMask::Slice& slice : mask.slices) {
    Json chains = Json::array();
    for (const Polygon& polygon : slice.polygons_mm) {
      const brep::ChainCode code = brep::chain_code({polygon}, glm::dvec2(spacing_mm));
      std::string steps;
      for (const std::uint8_t step : code.steps) steps.push_back(static_cast<char>('0' + step));
      chains.push_back({{"start", {code.start.x, code.start.y}}, {"steps", steps}});
    }
    slices.push_back({{"position_mm", slice.position_mm}, {"chains", std::move(chains)}});
  }
  return {{"spacing_mm", spacing_mm}, {"slices", std::move(slices)}};
}

}  // namespace octotomy::planner
