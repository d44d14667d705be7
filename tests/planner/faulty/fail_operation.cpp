// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The operation "fail", an entry of the table in tests only: it breaks as a mistake in the program does.
#include <map>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "brep/mesh/error.h"
#include "planner/operation/table/operation.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

struct Fail {
  ObjectName object;
  std::string in = "voxel";
  std::string by = "logic_error";
};

void fail_in(const std::string& part, const Fail& fail) {
  if (fail.in != part) return;
  if (fail.by == "logic_error") throw std::logic_error("the test broke '" + part + "'");
  if (fail.by == "precondition") throw std::invalid_argument("the test broke '" + part + "'");
  if (fail.by == "map") static_cast<void>(std::map<int, int>{}.at(1));
  if (fail.by == "length") std::vector<int>().reserve(std::vector<int>().max_size() + 1);
  if (fail.by == "input") throw voxel::InvalidInput("the test refused '" + part + "'");
  if (fail.by == "too_large") throw brep::TooLarge("the test refused '" + part + "'");
  if (fail.by == "full_disk")
    throw std::system_error(std::make_error_code(std::errc::no_space_on_device), "the test's disk");
}

void check(const Fail& fail, const FieldLocation&) {
  fail_in("check", fail);
}

std::string definition(const Fail& fail, const Objects&) {
  return "what breaks in " + fail.in;
}

void voxels(const Fail& fail, const VoxelBench& bench, VoxelSide& made) {
  fail_in("voxel", fail);
  made.octree = bench.object(fail.object.name).octree;
  made.lineage = "the same voxels";
}

void triangles(const Fail& fail, const MeshBench& bench, MeshSide& made) {
  fail_in("mesh", fail);
  made.whole = bench.object(fail.object.name);
  made.lineage = "the same mesh";
}

void bound(const Fail& fail, const BoundBench&, Object&) {
  fail_in("bound", fail);
}

}  // namespace

Operation fail_operation();
Operation fail_operation() {
  return Describe<Fail>("fail", "Breaks as a mistake in the program does.", Makes::Object)
      .takes(field("object", &Fail::object, "The object.").required().positional("solid"))
      .takes(field("in", &Fail::in, "The function that breaks.").one_of({"check", "voxel", "mesh", "bound"}))
      .takes(field("by", &Fail::by, "What it throws.")
                 .one_of({"logic_error", "precondition", "map", "length", "input", "too_large", "full_disk"}))
      .example(R"({"id": "broken", "do": "fail", "object": "skull", "in": "mesh"})")
      .on_files("octotomy fail skull.stl --in mesh -o broken.stl")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
