// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/mask_file.h"

#include <cmath>
#include <limits>

#include "planner/operation/file/contour_findings.h"
#include "planner/operation/file/drawn_region.h"
#include "planner/operation/file/octree_in.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/measure/octree_summary.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/plan_universe.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The mask's bounds along the patient's axes, from regions in views along these axes.
class Bounds {
 public:
  void add(const glm::dvec3& direction, double low_mm, double high_mm) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(direction[axis]) != 1.0) continue;
      box_.low_mm[axis] = std::max(box_.low_mm[axis], direction[axis] > 0 ? low_mm : -high_mm);
      box_.high_mm[axis] = std::min(box_.high_mm[axis], direction[axis] > 0 ? high_mm : -low_mm);
    }
  }
  void add(const voxel::View& view, const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high = -low;
    for (const auto& polygon : polygons_mm)
      for (const glm::dvec2& point : polygon) {
        low = glm::min(low, point);
        high = glm::max(high, point);
      }
    add(view.right, low.x, high.x);
    add(view.up, low.y, high.y);
  }
  voxel::Box box() const {
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(box_.high_mm[axis] - box_.low_mm[axis]) || box_.high_mm[axis] <= box_.low_mm[axis])
        throw std::runtime_error(
            "the regions do not bound the mask along x, y and z: draw a region in another view, too, or "
            "choose the voxels by --like FILE");
    return box_;
  }

 private:
  static constexpr double far = std::numeric_limits<double>::infinity();
  voxel::Box box_{glm::dvec3(-far), glm::dvec3(far)};
};

/// The voxels of the file --like. An octree states neither an identity nor the end of the scan's samples.
struct Like {
  voxel::Universe universe;
  voxel::Identity identity = {};
  std::optional<voxel::Lattice> scan = std::nullopt;
};

Like like_file(const fs::path& path, const std::optional<double>& voxel_mm, const FileBench& bench) {
  if (is_octree(path)) {
    if (voxel_mm)
      throw std::runtime_error(path.string() +
                               ": --like with an octree already determines the voxels: leave --voxel out");
    return {voxel::universe(voxel::read_octree(path))};
  }
  const voxel::Scene scene = bench.read_scan(path);
  return {universe_of(scene, voxel_mm), scene.identity, scene.lattice};
}

/// The regions on slices that bound the mask, with findings on them. Throws if they state another patient
/// than the scan.
voxel::SliceMask slices_of(const Mask& asked, const std::optional<Like>& like,
                           std::vector<std::string>& findings) {
  DrawnSlices drawn = read_slices(asked.slices, SlicesOptions{asked.structure, asked.bridge_mm});
  if (drawn.identity && like)
    findings =
        need_same_patient({asked.like.string(), like->identity}, {asked.slices.string(), *drawn.identity},
                          asked.other_identity, "--other-identity");
  else if (asked.other_identity)
    throw std::runtime_error(
        "--other-identity applies only to a structure set (--slices) and a scan (--like): state both, or "
        "leave it out");
  if (like && like->scan)
    if (auto beyond = beyond_scan(drawn.mask, *like->scan, asked.slices.string()))
      findings.push_back(std::move(*beyond));
  if (like && like->scan && drawn.identity)
    if (auto lacking = slices_without_contours(drawn.mask, *like->scan, asked.slices.string()))
      findings.push_back(std::move(*lacking));
  if (like)
    if (auto cut = cut_at_cube(drawn.mask, like->universe, asked.slices.string()))
      findings.push_back(*cut + "; without --like, the cube is made as large as the contours");
  findings.insert(findings.end(), drawn.findings.begin(), drawn.findings.end());
  return std::move(drawn.mask);
}

/// The universe around the volume that regions and slices enclose, with voxels of `voxel_mm`.
voxel::Universe universe_around(const voxel::RegionMask& regions,
                                const std::optional<voxel::SliceMask>& slices, double voxel_mm) {
  Bounds bounds;
  for (const voxel::Region& region : regions.regions) bounds.add(region.view, region.polygons_mm);
  if (slices) {
    const auto& all = slices->slices;
    std::vector<std::vector<glm::dvec2>> drawn;
    for (const auto& slice : all)
      drawn.insert(drawn.end(), slice.polygons_mm.begin(), slice.polygons_mm.end());
    bounds.add(slices->view, drawn);
    const std::size_t last = all.size() - 1;
    bounds.add(slices->view.look, all[0].position_mm - 0.5 * (all[1].position_mm - all[0].position_mm),
               all[last].position_mm + 0.5 * (all[last].position_mm - all[last - 1].position_mm));
  }
  return voxel::universe_around(bounds.box(), voxel_mm);
}

/// The mask as a step that encloses the same volume in any plan of the scan, at any head position; null if no
/// step can.
Json step_of(const std::vector<DrawnRegion>& drawn, bool is_cut_further) {
  Json regions = Json::array();
  for (const DrawnRegion& each : drawn) {
    if (each.view.empty()) return nullptr;
    Json polygons = Json::array();
    for (const auto& polygon : each.region.polygons_mm) {
      polygons.push_back(Json::array());
      for (const glm::dvec2& p : polygon) polygons.back().push_back({p.x, p.y});
    }
    regions.push_back({{"view", each.view}, {"polygons_mm", polygons}});
  }
  if (drawn.empty() || is_cut_further) return nullptr;
  return {{"id", "mask"}, {"do", "mask"}, {"regions", regions}, {"views_of", "scan"}};
}

}  // namespace

FileAnswer mask_file(const Mask& asked, const FileBench& bench) {
  need_octree_extension(asked.out);
  need_folder_of(asked.out);
  if (asked.region_files.empty() && asked.region_pixels.empty() && asked.slices.empty())
    throw std::runtime_error(
        "a mask needs --region VIEW:FILE.json, --region-pixels PICTURE.png:X,Y... or --slices FILE");
  std::vector<DrawnRegion> drawn;
  std::vector<std::string> findings;
  std::optional<voxel::SliceMask> slices;
  std::optional<voxel::Expression> expression;
  std::optional<voxel::Universe> universe;
  std::optional<Like> like;
  if (!asked.like.empty()) like = like_file(asked.like, asked.voxel_mm, bench);
  if (like) universe = like->universe;
  {
    const Stopwatch watch(bench.timings, "read");
    for (const std::string& region : asked.region_files) drawn.push_back(read_drawn_region(region));
    for (const std::string& pixels : asked.region_pixels) drawn.push_back(region_of_pixels(pixels));
    if (!asked.slices.empty()) slices = slices_of(asked, like, findings);
    if (!asked.edit.empty()) {
      const voxel::OctreeFile old = voxel::read_octree(asked.edit);
      const auto* octree = std::get_if<voxel::Octree>(&old.tree);
      if (octree == nullptr)
        throw std::runtime_error(asked.edit.string() + ": only a binary octree can be edited as a mask");
      if (!universe && asked.voxel_mm)
        throw std::runtime_error(
            asked.edit.string() +
            ": the mask of --edit determines the voxels: leave --voxel out, or name a scan by --like");
      if (!universe) universe = octree->universe();
      expression = *octree;
    }
  }
  voxel::RegionMask regions;
  for (const DrawnRegion& each : drawn) regions.regions.push_back(each.region);
  const auto also = [&](const voxel::Expression& part) {
    expression = expression ? *expression & part : part;
  };
  if (!regions.regions.empty()) also(regions);
  if (slices) also(*slices);
  if (!universe) universe = universe_around(regions, slices, asked.voxel_mm.value_or(1.0));
  voxel::OctreeFile file{voxel::Octree::empty(*universe), asked.out.stem().string(), ""};
  {
    const Stopwatch watch(bench.timings, "combine");
    file.tree = voxel::combine(*universe, *expression);
  }
  for (const DrawnRegion& each : drawn)
    findings.insert(findings.end(), each.findings.begin(), each.findings.end());
  if (std::get<voxel::Octree>(file.tree).is_empty())
    findings.emplace_back(
        "the mask contains no voxel, because its regions do not overlap or lie outside of the universe: draw "
        "them again");
  Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION}, {"regions", asked.region_files}};
  if (!asked.region_pixels.empty()) made["region_pixels"] = asked.region_pixels;
  if (slices) made["slices"] = asked.slices.filename().string();
  if (!asked.structure.empty()) made["structure"] = asked.structure;
  if (!asked.edit.empty()) made["edited"] = asked.edit.filename().string();
  file.metadata = json_text(made);
  FileAnswer answer = octree_written(file, asked.out, bench.stop, bench.timings, findings);
  answer.json["step"] = step_of(drawn, slices || !asked.edit.empty());
  return answer;
}

}  // namespace octotomy::planner
