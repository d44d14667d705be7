// SPDX-License-Identifier: AGPL-3.0-or-later
// The solid within a distance of an object, or the points of the object that are farther than that from its
// outside. Each kernel measures distances to its own representation of the object: to points of the surface
// between its voxels, or to its triangles.
#include "brep/shape/offset.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "brep/mesh/error.h"
#include "brep/shape/convex_inset.h"
#include "brep/shape/decimate.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "voxel/filter/offset.h"

namespace octotomy::planner {
namespace {

struct Offset {
  ObjectName object;
  double by_mm = 0.0;
  std::optional<double> cell_mm;
};

void check(const Offset& offset, const FieldLocation& place) {
  if (offset.by_mm == 0.0)
    place.at("by_mm").refuse("0 moves nothing: state a distance outward, or a negative number for inward");
}

/// The cell of the lattice of distances: half of the distance, so that rounded edges are resolved; at least
/// 1/100 of the solid's greatest extent.
double cell_for(const brep::Solid& solid, double by_mm) {
  const glm::dvec3 extent = solid.size().high_mm - solid.size().low_mm;
  return std::max(0.5 * std::abs(by_mm), std::max({extent.x, extent.y, extent.z}) / 100.0);
}

/// A lattice's surface without triangles that flat parts do not need. The remaining points do not move. The
/// allowed error is 1/50 of a cell, which exceeds the error of the offset's points and is less than that of
/// chords across cells.
brep::Solid fewer(const brep::Solid& surface, double cell_mm, std::vector<std::string>& findings) {
  if (surface.empty()) return surface;
  brep::DecimateOptions options;
  options.max_error_mm = cell_mm / 50.0;
  options.max_normal_deviation_deg = 15.0;
  try {
    return brep::trusted_solid(brep::decimate(surface, options), brep::Proof::Construction);
  } catch (const brep::Error& error) {
    if (error.code() != brep::ErrorCode::Geometry) throw;
    findings.push_back(std::string("the number of triangles was not reduced, because this failed: ") +
                       error.what());
    return surface;
  }
}

/// Adds a finding on walls or clefts that are too thin for the lattice. Throws if they are more than 1 % of
/// the surface.
void tell_missed(const brep::Solid& solid, const brep::Solid& moved, const brep::OffsetOptions& options,
                 std::vector<std::string>& findings) {
  constexpr double most_share = 0.01;
  const brep::MissedWalls missed = brep::missed_walls(solid, moved, options);
  if (missed.area_share == 0.0) return;
  const std::string told =
      "walls or clefts thinner than a cell of " + plain(options.cell_mm) + " mm were missed, " +
      three_figures(100.0 * missed.area_share) + " % of the surface, the first at (" + plain(missed.at_mm.x) +
      ", " + plain(missed.at_mm.y) + ", " + plain(missed.at_mm.z) + ") mm: choose smaller cells";
  if (missed.area_share > most_share) throw brep::Error(brep::ErrorCode::Geometry, told);
  findings.push_back(told);
}

std::string definition(const Offset& offset, const Objects&) {
  return offset.object.name + " offset by " + plain(offset.by_mm) + " mm";
}

void voxels(const Offset& offset, const VoxelBench& bench, VoxelSide& made) {
  const VoxelSide& object = bench.object(offset.object.name);
  const voxel::Expression moved = [&] {
    const Stopwatch watch(bench.timings, "offset_voxel");
    return voxel::Expression(voxel::offset(object.octree, *object.symbol, offset.by_mm, bench.progress));
  }();
  made.octree = bench.combined(moved);
  made.symbol = bench.within_universe(moved);
  made.lineage = "distances to the points where the surface passes between voxels";
}

/// A level set with its cells, and the half-width of its volume. That is the change of the volume with cells
/// twice as large, which is three times the error at second order, plus the tolerance of flat parts times the
/// area.
struct LevelSet {
  brep::Solid moved;
  brep::OffsetOptions options;
  double half_width_mm3 = 0.0;
};

LevelSet level_set(const brep::Solid& solid, const brep::OffsetOptions& options, bool may_refine) {
  constexpr double wanted_share = 0.01;  // of the volume
  constexpr int most_rounds = 3;
  brep::OffsetOptions coarse = options;
  coarse.cell_mm *= 2.0;
  double coarse_mm3 = brep::volume_mm3(brep::offset(solid, coarse));
  LevelSet found{brep::offset(solid, options), options};
  for (int round = 0;; ++round) {
    const double mm3 = brep::volume_mm3(found.moved);
    found.half_width_mm3 = std::abs(coarse_mm3 - mm3) +
                           brep::offset_tolerance_mm(found.options) / 4.0 * found.moved.size().area_mm2;
    if (!may_refine || round == most_rounds || found.half_width_mm3 <= wanted_share * mm3) return found;
    brep::OffsetOptions finer = found.options;
    finer.cell_mm *= 0.5;
    try {
      found = {brep::offset(solid, finer), finer};
    } catch (const brep::TooLarge&) {
      return found;  // the lattice cannot be finer; the half-width states the remaining error
    }
    coarse_mm3 = mm3;
  }
}

void triangles(const Offset& offset, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "offset");
  const brep::Solid& solid = bench.object(offset.object.name);
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  if (offset.by_mm < 0.0) {
    if (const std::optional<brep::Solid> inset = brep::convex_inset(solid, -offset.by_mm, progress)) {
      const double mm3 = brep::volume_mm3(*inset);
      made.details = {{"by_mm", offset.by_mm},
                      {"cell_mm", nullptr},
                      {"volume",
                       {{"value", mm3},
                        {"unit", "mm3"},
                        {"half_width", 1e-9 * brep::volume_mm3(solid)},
                        {"coverage", 0.99},
                        {"sources", {"rounding"}}}},
                      {"volume_change_mm3", mm3 - brep::volume_mm3(solid)}};
      made.whole = *inset;
      made.lineage = "moved half-spaces of the convex mesh's sides";
      return;
    }
  }
  brep::OffsetOptions options{.by_mm = offset.by_mm,
                              .cell_mm = offset.cell_mm.value_or(cell_for(solid, offset.by_mm))};
  options.progress = progress;
  const LevelSet found = level_set(solid, options, !offset.cell_mm);
  options = found.options;
  const brep::Solid moved = fewer(found.moved, options.cell_mm, made.findings);
  tell_missed(solid, moved, options, made.findings);
  const double mm3 = brep::volume_mm3(moved);
  made.details = {{"by_mm", offset.by_mm},
                  {"cell_mm", options.cell_mm},
                  {"volume",
                   {{"value", mm3},
                    {"unit", "mm3"},
                    {"half_width", found.half_width_mm3 + std::abs(mm3 - brep::volume_mm3(found.moved))},
                    {"coverage", 0.99},
                    {"sources", {"cells of the level set", "chords of its triangles", "thinning"}}}},
                  {"volume_change_mm3", mm3 - brep::volume_mm3(solid)}};
  made.whole = moved;
  made.lineage = "level set of the distance to the mesh";
}

/// The cell with which the mesh was made. Unless the user chose one, it may be finer than cell_for(), because
/// the volume required this.
double cell_of(const Offset& offset, const brep::Solid& operand, const MeshSide& made) {
  const auto cell = made.details.find("cell_mm");
  return cell != made.details.end() && cell->is_number()
             ? cell->get<double>()
             : offset.cell_mm.value_or(cell_for(operand, offset.by_mm));
}

void bound(const Offset& offset, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(offset.object.name);
  made.bound.spacing_mm = object.bound.spacing_mm;
  made.bound.shift_mm = object.bound.shift_mm;
  if (made.mesh.whole && object.mesh.whole) {
    const verify::OffsetOperand operand{object.witness, object.voxel.octree, *object.mesh.whole,
                                        is_whole_voxels(object.voxel)};
    const verify::WitnessedOffset asked{offset.by_mm, cell_of(offset, *object.mesh.whole, made.mesh)};
    made.witness = verify::witness_of_offset(operand, asked);
    made.bound.measured_apart_mm =
        object.bound.measured_apart_mm +
        verify::offset_allowance_mm(operand, asked, made.mesh.whole->measures().area_mm2);
  }
  made.bound.reshaped = {offset.object.name};
  made.ends_with_universe = true;
}

}  // namespace

Operation offset_operation() {
  return Describe<Offset>("offset",
                          "Moves an object's surface outward or inward, for margins and clearances.",
                          Makes::Object)
      .takes(field("object", &Offset::object, "The object.").required().positional("solid"))
      .takes(field("by_mm", &Offset::by_mm,
                   "The distance by which the surface moves outward, or inward if it is negative. It must "
                   "not be 0.")
                 .required())
      .takes(field("cell_mm", &Offset::cell_mm,
                   "Cell size, about the edge of the smallest triangles. Default: half of the distance or a "
                   "100th of the object, whichever is larger, then halved up to three times until the volume "
                   "is known to 1 %. A convex object moves inward exactly, without cells.")
                 .greater_than(0.0))
      .example(R"({"id": "margin", "do": "offset", "object": "tumour", "by_mm": 5})")
      .on_files(
          "octotomy offset tumour.stl --by 5 -o margin.stl\n"
          "  octotomy offset skull.stl --by -1 --cell 0.4 -o core.ply --json")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
