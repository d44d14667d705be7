// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/doubtful_places.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/slice.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/drawn_page.h"
#include "voxel/filter/headrest.h"
#include "voxel/filter/streak_clamp.h"
#include "voxel/measure/measure.h"
#include "voxel/scan/image_file.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

constexpr int picture_px = 320;
constexpr std::size_t most_gaps = 4;
/// Smaller volumes get no picture: they are single voxels at the edge of a filling, or dust.
constexpr double least_metal_mm3 = 2.0, least_headrest_mm3 = 1000.0;
constexpr glm::vec3 tint{255.0f, 140.0f, 0.0f};
constexpr float tint_share = 0.55f;

using Tinted = std::function<bool(const glm::dvec3& p_mm, double sample)>;

struct Place {
  std::string check, sentence;
  glm::dvec3 at_mm{0.0};
  std::string plane;  ///< "axial", "coronal" or "sagittal"
  Tinted tinted;
};

/// A picture of the whole slice through a place, with the doubtful samples tinted.
std::string picture_of(const Place& place, const voxel::Scene& scene, const std::stop_token& stop) {
  const voxel::Box box = voxel::bounds(scene.lattice);
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  Slice slice;
  slice.path = "place.png";
  slice.plain = true;
  slice.size = std::to_string(picture_px) + "x" + std::to_string(picture_px);
  slice.centre_mm = 0.5 * (box.low_mm + box.high_mm);
  slice.pixel_mm = std::max({extent_mm.x, extent_mm.y, extent_mm.z}) / picture_px;
  const auto through = [](double mm) { return Json(mm).dump(); };
  if (place.plane == "axial") slice.axial = through(place.at_mm.z);
  if (place.plane == "coronal") slice.coronal = through(place.at_mm.y);
  if (place.plane == "sagittal") slice.sagittal = through(place.at_mm.x);
  Timings timings;
  SlicePicture picture = slice_of(slice, scene, {}, timings, stop);
  const glm::ivec2 size_px = picture.sheet.size_px();
  for (int row = 0; row < size_px.y; ++row)
    for (int column = 0; column < size_px.x; ++column) {
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(size_px.x) +
                         static_cast<std::size_t>(column);
      if (picture.samples.inside[pixel] == 0 ||
          !place.tinted(picture.sheet.lps_mm(column, row), picture.samples.image.values[pixel]))
        continue;
      for (int channel = 0; channel < 3; ++channel) {
        std::uint8_t& byte = picture.rgb[3 * pixel + static_cast<std::size_t>(channel)];
        byte = static_cast<std::uint8_t>(
            std::lround((1.0f - tint_share) * static_cast<float>(byte) + tint_share * tint[channel]));
      }
    }
  return base64(voxel::encode_image("png", size_px, picture.rgb));
}

void add_gaps(const voxel::Scene& scene, std::vector<Place>& places) {
  std::vector<voxel::Hole> holes = scene.holes;
  std::stable_sort(holes.begin(), holes.end(),
                   [](const voxel::Hole& a, const voxel::Hole& b) { return a.length_mm() > b.length_mm(); });
  const std::string count = std::to_string(holes.size());
  if (holes.size() > most_gaps) holes.resize(most_gaps);
  const voxel::Box box = voxel::bounds(scene.lattice);
  const glm::dvec3 middle_mm = 0.5 * (box.low_mm + box.high_mm);
  for (const voxel::Hole& hole : holes) {
    const double half_way_mm = 0.5 * (hole.low_mm + hole.high_mm);
    places.push_back({"gap",
                      "no image measured a slab of " + three_figures(hole.length_mm()) +
                          " mm: its samples are interpolated (" + count + (count == "1" ? " gap" : " gaps") +
                          " in this scan)",
                      middle_mm + hole.normal * (half_way_mm - glm::dot(middle_mm, hole.normal)),
                      std::abs(hole.normal.x) > 0.5 ? "coronal" : "sagittal",
                      [hole](const glm::dvec3& p_mm, double) {
                        const double at_mm = glm::dot(p_mm, hole.normal);
                        return at_mm > hole.low_mm && at_mm < hole.high_mm;
                      }});
  }
}

/// Samples as dense as metal: the number of voxels, the number of slices that contain any, and the centroid
/// in the slice that contains most.
struct Metal {
  std::uint64_t voxels = 0;
  int slices = 0;
  glm::dvec3 at_mm{0.0};
};
Metal metal_in(const voxel::Scene& scene, double from) {
  Metal metal;
  const glm::ivec3 dims = scene.lattice.dims;
  std::uint64_t most = 0;
  std::visit(
      [&](const auto& samples) {
        std::size_t i = 0;
        for (int z = 0; z < dims.z; ++z) {
          std::uint64_t count = 0;
          glm::dvec3 sum(0.0);
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x, ++i)
              if (static_cast<double>(samples[i]) >= from) {
                ++count;
                sum += glm::dvec3(x, y, z);
              }
          metal.voxels += count;
          metal.slices += count > 0 ? 1 : 0;
          if (count <= most) continue;
          most = count;
          metal.at_mm =
              glm::dvec3(scene.lattice.lps_from_voxel * glm::dvec4(sum / static_cast<double>(count), 1.0));
        }
      },
      scene.samples);
  return metal;
}

void add_metal(const voxel::Scene& scene, std::vector<Place>& places) {
  const double from = voxel::StreakOptions().metal;
  const Metal metal = metal_in(scene, from);
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const double mm3 = static_cast<double>(metal.voxels) * spacing_mm.x * spacing_mm.y * spacing_mm.z;
  if (mm3 < least_metal_mm3) return;
  places.push_back(
      {"metal",
       three_figures(mm3) + " mm\u00b3 in " + std::to_string(metal.slices) +
           (metal.slices == 1 ? " slice are" : " slices are") + " as dense as metal (" + grouped(from, 0) +
           " HU or more): look whether streaks cross bone; 'clamp_streaks' lessens them",
       metal.at_mm, "axial", [from](const glm::dvec3&, double sample) { return sample >= from; }});
}

void add_headrest(const voxel::Scene& scene, std::vector<Place>& places) {
  if (!std::holds_alternative<voxel::Int16Samples>(scene.samples)) return;
  try {
    const voxel::HeadrestRemoval removal = voxel::remove_headrest(scene);
    if (removal.solid_mm3 < least_headrest_mm3) return;
    const auto centroid_mm = voxel::measure(removal.solid).centroid_mm;
    if (!centroid_mm) return;
    const voxel::Octree solid = removal.solid;
    const glm::dmat4 voxel_from_lps = glm::inverse(solid.universe().lattice().lps_from_voxel);
    places.push_back(
        {"headrest",
         three_figures(removal.solid_mm3 / 1000.0) +
             " cm\u00b3 behind the patient look like a table or headrest: 'remove_headrest' removes them",
         *centroid_mm, "axial", [solid, voxel_from_lps](const glm::dvec3& p_mm, double) {
           return solid.contains(glm::ivec3(glm::round(glm::dvec3(voxel_from_lps * glm::dvec4(p_mm, 1.0)))));
         }});
  } catch (const std::exception& error) {
    // Without a patient or anything solid in the scan there is no headrest to report.
    if (fault_of(error) != Fault::Input && fault_of(error) != Fault::Geometry) throw;
  }
}

}  // namespace

Json doubtful_places(Session& session, const Json& said, const Watched& watched) {
  const Snapshot snapshot = session.snapshot();
  const std::string name = said.at("scan");
  if (!snapshot.evaluation || !snapshot.evaluation->loaded.contains(name))
    throw voxel::Error(voxel::ErrorCode::Input, "scan: the plan has no scan '" + name + "'");
  const voxel::Scene& scene = snapshot.evaluation->loaded.at(name)->scene();
  std::vector<Place> places;
  add_gaps(scene, places);
  if (scene.meaning == voxel::Meaning::Hounsfield) {
    add_metal(scene, places);
    if (watched.progress) watched.progress("looking for a headrest", 0.3);
    add_headrest(scene, places);
  }
  Json list = Json::array();
  for (const Place& place : places)
    list.push_back({{"check", place.check},
                    {"sentence", place.sentence},
                    {"at_mm", planner::to_json(place.at_mm)},
                    {"plane", place.plane},
                    {"png", picture_of(place, scene, watched.stop)}});
  return {{"places", list}};
}

}  // namespace octotomy::planner::serve
