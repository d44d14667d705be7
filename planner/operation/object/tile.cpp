// SPDX-License-Identifier: AGPL-3.0-or-later
// An object from contours on parallel slices, typed, drawn in the page or of a file. The voxel kernel interpolates
// the slices' distances, the mesh kernel tiles them.
#include "planner/operation/object/tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/contour/sections_between.h"
#include "planner/operation/file/contour_findings.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/tiled_slices.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/solid/polygon_overlaps.h"
#include "voxel/space/error.h"
#include "voxel/space/view.h"

namespace octotomy::planner {
namespace {

constexpr const char* tile_name = "tile";

struct Tile {
  struct Slice {
    double position_mm = 0.0;
    Polygons polygons_mm;
  };
  std::string view = "inferior";
  std::vector<Slice> contours;
  std::filesystem::path slices;
  std::string structure;
  std::string between = "shape_based";
  std::optional<double> end_mm;

  bool has_file() const { return !slices.empty(); }
};

/// Adds an empty slice at either end, so that the object ends at this distance beyond its contours.
void add_ends(voxel::SliceMask& mask, double end_mm) {
  const auto is_empty = [](const voxel::SliceMask::Slice& slice) { return slice.polygons_mm.empty(); };
  auto& slices = mask.slices;
  while (!slices.empty() && is_empty(slices.back())) slices.pop_back();
  while (!slices.empty() && is_empty(slices.front())) slices.erase(slices.begin());
  if (slices.empty()) return;
  slices.insert(slices.begin(), {slices.front().position_mm - 2.0 * end_mm, {}});
  slices.push_back({slices.back().position_mm + 2.0 * end_mm, {}});
}

/// The mask of contours that are stated in the plan.
voxel::SliceMask mask_of(const Tile& tile) {
  voxel::SliceMask mask;
  mask.view = voxel::parse_view(tile.view);
  if (tile.between == "nearest") mask.between = voxel::SliceMask::Between::Nearest;
  for (const Tile::Slice& slice : tile.contours)
    mask.slices.push_back({slice.position_mm, slice.polygons_mm});
  std::stable_sort(mask.slices.begin(), mask.slices.end(),
                   [](const auto& a, const auto& b) { return a.position_mm < b.position_mm; });
  if (tile.end_mm) add_ends(mask, *tile.end_mm);
  return mask;
}

voxel::SliceMask drawn_in(const Tile& tile, const std::filesystem::path& folder,
                          std::vector<std::string>& findings) {
  if (!tile.has_file()) return mask_of(tile);
  voxel::SliceMask mask = read_slices(folder / tile.slices, tile.structure, findings);
  if (tile.end_mm) add_ends(mask, *tile.end_mm);
  return mask;
}

/// Refuses contours that cross themselves or each other, because they bound no area of an object.
void need_uncrossed(const Tile& tile, const FieldLocation& place) {
  for (std::size_t i = 0; i < tile.contours.size(); ++i) {
    const FieldLocation at = place.at("contours[" + std::to_string(i) + "]");
    const Polygons& polygons = tile.contours[i].polygons_mm;
    const auto told = [&](const glm::dvec2& p) { return "[" + plain(p.x) + ", " + plain(p.y) + "] mm"; };
    const std::vector<std::size_t> again = voxel::repeated_polygons(polygons, off_plane_mm());
    if (!again.empty())
      at.at("polygons_mm[" + std::to_string(again.front()) + "]")
          .refuse("repeats another contour of its slice: leave out one of them");
    const voxel::CrossingPolygons crossing = voxel::crossing_polygons(polygons, off_plane_mm());
    if (!crossing.all.empty())
      at.at("polygons_mm[" + std::to_string(crossing.all.front().polygon) + "]")
          .refuse("crosses itself or another contour of its slice near " + told(crossing.all.front().at_mm) +
                  ": draw one outline around both parts");
  }
}

void check(const Tile& tile, const FieldLocation& place) {
  if (place.scope == nullptr) return;
  if (tile.has_file() && !tile.contours.empty())
    place.at("slices").refuse("names a file of contours: leave 'contours' out, or the file");
  if (!tile.has_file() && tile.contours.empty())
    place.refuse("'contours' is missing: add 'contours', or a file of contours as 'slices'");
  if (tile.has_file()) return;
  if (tile.contours.size() == 1 && !tile.end_mm)
    place.at("contours")
        .refuse(
            "lie in one slice, so the object's thickness is unknown: add 'end_mm', the distance to which it "
            "extends on either side");
  const auto has_none = [](const Tile::Slice& slice) { return slice.polygons_mm.empty(); };
  if (std::all_of(tile.contours.begin(), tile.contours.end(), has_none))
    place.at("contours").refuse("have no polygon: draw at least one");
  for (std::size_t i = 0; i < tile.contours.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (tile.contours[i].position_mm == tile.contours[j].position_mm)
        place.at("contours[" + std::to_string(i) + "]")
            .at("position_mm")
            .refuse("is that of contours[" + std::to_string(j) +
                    "], too: state all polygons of a slice in one record");
  try {
    voxel::check(mask_of(tile));
  } catch (const std::invalid_argument& error) {
    if (fault_of(error) != Fault::Input) throw;
    place.at("contours").refuse(error.what());
  }
  need_uncrossed(tile, place);
}

std::string definition(const Tile& tile, const Objects&) {
  if (tile.has_file())
    return (tile.structure.empty() ? "contours" : "'" + tile.structure + "'") + " of " +
           tile.slices.filename().string() + ", tiled";
  std::size_t count = 0;
  for (const Tile::Slice& slice : tile.contours) count += slice.polygons_mm.size();
  return std::to_string(count) + (count == 1 ? " contour" : " contours") + " in view " + tile.view +
         ", tiled";
}

void voxels(const Tile& tile, const VoxelBench& bench, VoxelSide& made) {
  voxel::SliceMask mask = drawn_in(tile, bench.folder, made.findings);
  if (const auto cut = cut_at_cube(mask, bench.universe, "the object"))
    made.findings.push_back(*cut + ": draw within the plan's cube, which contains its scans");
  const voxel::Expression slices = std::move(mask);
  made.octree = bench.combined(slices);
  made.symbol = bench.within_universe(slices);
  made.lineage = "distances to the contours at voxel centres";
  if (made.octree.is_empty())
    throw std::runtime_error(
        "the contours enclose no voxel's centre: draw them within the universe, which spans " +
        plain(bench.box_mm()) + ", or choose smaller voxels");
}

void triangles(const Tile& tile, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "tile");
  std::vector<std::string> findings;
  const voxel::SliceMask mask = drawn_in(tile, bench.folder, findings);
  const TiledSlices tiled = tiled_slices(mask, brep::TileCost::shortest_span, bench.progress.stop);
  made.whole = tiled.solid;
  made.details = {{"slices", mask.slices.size()}, {"tiled_sections", tiled.sections}};
  made.lineage = "tiles between contours";
}

void bound(const Tile& tile, const BoundBench& bench, Object& made) {
  std::vector<std::string> findings;
  const voxel::SliceMask mask = drawn_in(tile, bench.folder, findings);
  made.bound.planes = planes_of(mask);
  made.bound.measured_apart_mm = tiles_apart_mm(mask);
  made.witness = witness_of(mask);
  made.ends_with_universe = true;
}

}  // namespace

bool is_tile(const Action& action) {
  return action.operation().name == tile_name;
}

voxel::Box tile_box(const Action& action, const std::filesystem::path& folder) {
  const Tile& tile = *static_cast<const Tile*>(action.value());
  std::vector<std::string> findings;
  const voxel::SliceMask mask = drawn_in(tile, folder, findings);
  const auto& slices = mask.slices;
  const std::size_t last = slices.size() - 1;
  constexpr double far = std::numeric_limits<double>::infinity();
  voxel::Box box{glm::dvec3(far), glm::dvec3(-far)};
  for (std::size_t s = 0; s <= last; ++s) {
    // Half-way to the neighbouring slice, or as far beyond the end.
    const double below_mm = slices[s == 0 ? 1 : s].position_mm - slices[s == 0 ? 0 : s - 1].position_mm;
    const double above_mm =
        slices[s == last ? last : s + 1].position_mm - slices[s == last ? last - 1 : s].position_mm;
    for (const auto& polygon : slices[s].polygons_mm)
      for (const glm::dvec2& p : polygon)
        for (const double by_mm : {-0.5 * below_mm, 0.5 * above_mm}) {
          const glm::dvec3 at =
              p.x * mask.view.right + p.y * mask.view.up + (slices[s].position_mm + by_mm) * mask.view.look;
          box = {glm::min(box.low_mm, at), glm::max(box.high_mm, at)};
        }
  }
  return box;
}

Operation tile_operation() {
  return Describe<Tile>(tile_name, "Makes an object from contours on parallel slices.", Makes::Object)
      .takes(field("view", &Tile::view,
                   "The view, in the scan's frame, in which the contours are drawn. It looks along the "
                   "normal of their slices.")
                 .read_if<Tile>([](const Tile& tile) { return !tile.has_file(); },
                                "is stated by the file: leave it out"))
      .takes(records("contours", &Tile::contours, "The slices with their contours, in any order.",
                     {field("position_mm", &Tile::Slice::position_mm,
                            "Position of the slice along the view's direction of sight, mm.")
                          .required(),
                      field("polygons_mm", &Tile::Slice::polygons_mm,
                            "Closed polygons of points [u, v] in the view's millimetres. A polygon within "
                            "another is a hole. Without polygons, the object ends half-way to this slice.")
                          .required()})
                 .from(1)
                 .to(5000)
                 .in_plans_only())
      .takes(field("slices", &Tile::slices,
                   "Instead of 'contours': a .json of regions on slices, which the operation contours "
                   "writes, or a DICOM structure set.")
                 .a_file())
      .takes(field("structure", &Tile::structure,
                   "For a structure set: the name or ROI number of the structure to use.")
                 .read_if<Tile>([](const Tile& tile) { return tile.has_file(); },
                                "applies only to a structure set: add the set as 'slices'"))
      .takes(field("between", &Tile::between,
                   "The object between two slices: shape_based interpolates the distances to both outlines; "
                   "nearest extends each outline unchanged to half-way.")
                 .one_of({"shape_based", "nearest"})
                 .read_if<Tile>([](const Tile& tile) { return !tile.has_file(); },
                                "is stated by the file: leave it out"))
      .takes(field("end_mm", &Tile::end_mm,
                   "The distance to which the object extends beyond its first and last contour, mm. Default: "
                   "half of the distance to the next slice.")
                 .greater_than(0.0)
                 .to(1000.0))
      .example(R"({"id": "tumour", "do": "tile", "view": "inferior", "contours": [
        {"position_mm": 20, "polygons_mm": [[[-10, 20], [10, 20], [10, 40], [-10, 40]]]},
        {"position_mm": 30, "polygons_mm": [[[-5, 25], [5, 25], [5, 35], [-5, 35]]]}]})")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
