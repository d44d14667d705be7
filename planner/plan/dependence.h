// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

// The dependences between a plan's steps, and keys of everything on which a step's answer depends.
namespace octotomy::planner {

/// The files that a step reads, as written in its fields: relative to the plan's folder.
std::vector<std::filesystem::path> files_read(const Step& step);

/// The ids of these steps and of all steps on which they depend. Throws std::invalid_argument if the plan has
/// no such step.
std::set<std::string> needed_for(const Plan& plan, const std::vector<std::string>& ids);

/// The subset of these steps whose voxel answer needs meshes: steps that only the mesh kernel evaluates,
/// steps that compute values on meshes, and all steps on which these depend.
std::set<std::string> needing_meshes(const Plan& plan, const std::set<std::string>& steps);

/// Steps' keys by their ids: the SHA-256 of everything that determines a step's answer. Steps with equal keys
/// have the same answer, in the same or in different plans. A key covers the operation and its values, the
/// keys of the steps and scans that it uses, positions of landmarks, the head's orientation, and the contents
/// of files that it reads. `scan_key` returns the key of a scan of the plan; `common` describes the inputs of
/// all steps, such as the universe. Cost: linear in steps; reads the files that steps name.
std::map<std::string, std::string> step_keys(
    const Plan& plan, const std::string& common,
    const std::function<std::string(const std::string& scan)>& scan_key);

}  // namespace octotomy::planner
