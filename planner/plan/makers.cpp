// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/makers.h"

#include <algorithm>
#include <string>
#include <vector>

namespace octotomy::planner {
namespace {

/// Merges the clauses of `from` into `to`, which stays sorted and without duplicates.
void add(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
  std::sort(to.begin(), to.end());
  to.erase(std::unique(to.begin(), to.end()), to.end());
}

}  // namespace

void add_makers(const MadeOf& from, bool found_values, Object& made) {
  const Operation& operation = from.action.operation();
  for (const std::string& name : objects_used(from.action)) {
    const Object& operand = from.objects.at(name);
    add(made.voxel.makers, operand.voxel.makers);
    add(made.mesh.makers, operand.mesh.makers);
    add(made.shared_values, operand.shared_values);
  }
  add(made.voxel.makers, {operation.name + ": " + made.voxel.lineage});
  if (made.mesh.whole) add(made.mesh.makers, {operation.name + ": " + made.mesh.lineage});
  // If the voxel kernel does not do the operation, the voxels are made from the mesh, so they have the mesh's
  // makers.
  if (!operation.voxel) add(made.voxel.makers, made.mesh.makers);
  if (found_values)
    add(made.shared_values, {operation.name + ": values that the step computes once for both kernels"});
  if (operation.is_of_head && from.objects.lps_from_head != glm::dmat3(1.0))
    add(made.shared_values, {operation.name + ": how the head is held"});
  for (const std::string& scan : scans_used(from.action))
    for (const ScanRecord& record : from.records)
      if (record.name == scan && !record.made_by.empty())
        add(made.shared_values, {"the samples of '" + scan + "', made by " + record.made_by});
}

}  // namespace octotomy::planner
