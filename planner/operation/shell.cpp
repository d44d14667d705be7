// SPDX-License-Identifier: AGPL-3.0-or-later
// The outer layer of an object: its points within a distance of its outside. As of an offset, the mesh kernel
// answers alone.
#include "brep/boolean/boolean.h"
#include "brep/shape/offset.h"
#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"

namespace octotomy::planner {
namespace {

struct Shell {
  ObjectName object;
  double thickness_mm = 2.0;
};

std::string definition(const Shell& shell, const Objects&) {
  return "outer " + plain(shell.thickness_mm) + " mm of " + shell.object.name;
}

void triangles(const Shell& shell, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "offset");
  const brep::Solid& solid = bench.object(shell.object.name);
  const brep::Solid core = brep::offset(solid, {.by_mm = -shell.thickness_mm,
                                                .cell_mm = 0.25 * shell.thickness_mm,
                                                .progress = {bench.progress.stop, bench.progress.report}});
  brep::BooleanResult rest = brep::boolean(solid, brep::Operation::Difference, core, bench.progress.stop);
  made.shift_mm = rest.shift_mm;
  made.findings = rest.findings;
  made.whole = rest.solid;
  made.lineage = "the mesh less a level set of the distance to it";
}

void bound(const Shell& shell, const BoundBench& bench, Object& made) {
  inherit(bench.objects.at(shell.object.name), made);
  made.ends_with_universe = true;
}

}  // namespace

Operation shell_operation() {
  return Describe<Shell>("shell", "Keeps the outer layer of an object.", Makes::Object)
      .takes(field("object", &Shell::object, "The object.").required().positional("solid"))
      .takes(field("thickness_mm", &Shell::thickness_mm, "The thickness of the layer.").greater_than(0.0))
      .example(R"({"id": "crust", "do": "shell", "object": "skull", "thickness_mm": 2})")
      .on_files("octotomy shell skull.stl --thickness 2 -o crust.stl")
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
