// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

// Which steps of a plan depend on each other, and keys that cover everything on which a step's answer
// depends.
namespace octotomy::planner {

/// The files that a step reads, as its fields state them; relative paths are relative to the plan's folder.
std::vector<std::filesystem::path> files_read(const Step& step);

/// The ids of these steps and of all steps on which they depend. Throws std::invalid_argument if the plan has
/// no step of an id.
std::set<std::string> needed_for(const Plan& plan, const std::vector<std::string>& ids);

/// Those of the given steps whose mesh is needed even for answers by voxels: steps that only the mesh kernel
/// evaluates, steps that compute values on meshes, and all steps on which these depend.
std::set<std::string> needing_meshes(const Plan& plan, const std::set<std::string>& steps);

/// A key for each step, by id: the SHA-256 of everything that determines the step's answer. Steps with equal
/// keys have equal answers, also in different plans. A key covers the operation and its values, the keys of
/// used steps and scans, the positions of landmarks, the head's orientation, and the contents of files that
/// the step reads. `scan_key` returns the key of a scan of the plan. `common` describes the common inputs of
/// all answers, such as the universe. Cost: linear in the number of steps; reads the files.
std::map<std::string, std::string> step_keys(
    const Plan& plan, const std::string& common,
    const std::function<std::string(const std::string& scan)>& scan_key);

}  // namespace octotomy::planner
