// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "planner/plan/plan.h"

// Which steps of a plan depend on which, and what each one's answer depends on.
namespace octotomy::planner {

/// The files that a step reads, as its fields name them: relative to the plan's folder.
std::vector<std::filesystem::path> files_read(const Step& step);

/// The ids of the steps that these steps depend on, and these. Throws std::invalid_argument where the plan
/// has no such step.
std::set<std::string> needed_for(const Plan& plan, const std::vector<std::string>& ids);

/// Of these steps the ones whose voxel answer cannot be had without meshes: those that only the mesh kernel
/// does or that settle a value on meshes, and all that they depend on.
std::set<std::string> needing_meshes(const Plan& plan, const std::set<std::string>& steps);

/// Steps' keys by their ids: SHA-256 of everything that decides a step's answer. Two steps with one key have
/// the same answer, in one plan or in two: the operation and its values, the steps and scans it uses by their
/// own keys, landmarks by their places, how the head is held, and the files it reads by their content.
/// `scan_key` answers for a scan of the plan; `common` is what all of the steps depend on, as the universe.
/// Cost: linear in steps; reads the files that steps name.
std::map<std::string, std::string> step_keys(
    const Plan& plan, const std::string& common,
    const std::function<std::string(const std::string& scan)>& scan_key);

}  // namespace octotomy::planner
