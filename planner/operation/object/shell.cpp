// SPDX-License-Identifier: AGPL-3.0-or-later
// The outer layer of an object: its points within a distance of its outside. Each kernel subtracts its own
// inward offset from its own representation of the object.
#include <cmath>
#include <optional>

#include "brep/boolean/boolean.h"
#include "brep/mesh/error.h"
#include "brep/shape/convex_inset.h"
#include "brep/shape/offset.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/offset_witness.h"
#include "verify/witness/witness.h"
#include "voxel/filter/offset.h"

namespace octotomy::planner {
namespace {

struct Shell {
  ObjectName object;
  double thickness_mm = 2.0;
};

std::string definition(const Shell& shell, const Objects&) {
  return "outer " + plain(shell.thickness_mm) + " mm of " + shell.object.name;
}

double cell_for(const Shell& shell) {
  return 0.25 * shell.thickness_mm;
}

/// The cell with which the inner surface was made. It is larger than cell_for() if the object is too large
/// for that cell.
double cell_of(const Shell& shell, const MeshSide& made) {
  const auto cell = made.details.find("cell_mm");
  return cell != made.details.end() && cell->is_number() ? cell->get<double>() : cell_for(shell);
}

/// The points that lie deeper than the thickness. The cells of their lattice are doubled until the lattice is
/// small enough.
brep::Solid core_of(const brep::Solid& solid, const Shell& shell, const brep::Progress& progress,
                    MeshSide& made) {
  constexpr int most_rounds = 4;
  for (int round = 0;; ++round) {
    const double cell_mm = std::ldexp(cell_for(shell), round);
    try {
      brep::Solid core =
          brep::offset(solid, {.by_mm = -shell.thickness_mm, .cell_mm = cell_mm, .progress = progress});
      if (round > 0) {
        made.details = {{"cell_mm", cell_mm}};
        made.findings.push_back("the object is too large for cells of " + plain(cell_for(shell)) +
                                " mm: its inner surface was made with cells of " + plain(cell_mm) +
                                " mm, so parts of the inside that are thinner may remain: cut out the part "
                                "of interest, for which smaller cells are possible");
      }
      return core;
    } catch (const brep::TooLarge&) {
      if (round + 1 == most_rounds) throw;
    }
  }
}

void voxels(const Shell& shell, const VoxelBench& bench, VoxelSide& made) {
  const VoxelSide& object = bench.object(shell.object.name);
  const voxel::Expression core = [&] {
    const Stopwatch watch(bench.timings, "offset_voxel");
    return voxel::Expression(
        voxel::offset(object.octree, *object.symbol, -shell.thickness_mm, bench.progress));
  }();
  made.octree = bench.combined(voxel::Expression(object.octree) - core);
  made.symbol = bench.within_universe(*object.symbol - core);
  made.lineage =
      "the octree without the points that lie deeper than the thickness below its surface between voxels";
}

void triangles(const Shell& shell, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "offset");
  const brep::Solid& solid = bench.object(shell.object.name);
  const brep::Progress progress{bench.progress.stop, bench.progress.report};
  const std::optional<brep::Solid> inset = brep::convex_inset(solid, shell.thickness_mm, progress);
  const brep::Solid core = inset ? *inset : core_of(solid, shell, progress, made);
  brep::BooleanResult rest = brep::boolean(solid, brep::Operation::Difference, core, bench.progress.stop);
  made.shift_mm = rest.shift_mm;
  made.findings.insert(made.findings.end(), rest.findings.begin(), rest.findings.end());
  made.whole = rest.solid;
  made.lineage = "the mesh less a level set of the distance to it";
}

void bound(const Shell& shell, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(shell.object.name);
  inherit(object, made);
  if (made.mesh.whole && object.mesh.whole) {
    const verify::OffsetOperand operand{object.witness, object.voxel.octree, *object.mesh.whole,
                                        is_whole_voxels(object.voxel)};
    const verify::WitnessedOffset asked{-shell.thickness_mm, cell_of(shell, made.mesh)};
    made.witness = verify::without(object.witness, verify::witness_of_offset(operand, asked));
    // The outer surface is that of the operand. Only the inner surface is computed from distances.
    const double area_mm2 = made.mesh.whole->measures().area_mm2,
                 inner_mm2 = area_mm2 - object.mesh.whole->measures().area_mm2;
    if (inner_mm2 > 0.0)
      made.bound.measured_apart_mm +=
          inner_mm2 / area_mm2 * verify::offset_allowance_mm(operand, asked, inner_mm2);
  }
  made.ends_with_universe = true;
}

}  // namespace

Operation shell_operation() {
  return Describe<Shell>("shell", "Keeps the outer layer of an object and removes the rest.", Makes::Object)
      .takes(field("object", &Shell::object, "The object.").required().positional("solid"))
      .takes(field("thickness_mm", &Shell::thickness_mm, "The thickness of the layer.").greater_than(0.0))
      .example(R"({"id": "crust", "do": "shell", "object": "skull", "thickness_mm": 2})")
      .on_files("octotomy shell skull.stl --thickness 2 -o crust.stl")
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
