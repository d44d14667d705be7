// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "voxel/scan/read_scene.h"

namespace CLI {
class Validator;
}  // namespace CLI

// What the verbs that read a scan have in common.
namespace octotomy::planner::cli {

/// The options about it, as text.
struct ScanIn {
  std::string series, slices, spacing, frame, unit;
  bool join = false;
  std::vector<std::string> raw;  ///< DIMS TYPE
  bool big_endian = false;
  std::uint64_t offset = 0;
};

/// Adds --series, --join, --slices, --frame, --unit, --spacing, --raw, --big-endian and --offset to a verb's
/// help, under a heading that says whose they are.
void add_scan_options(CLI::App& verb, ScanIn& in, const std::string& heading = "scan");

/// Throws std::runtime_error where options about a scan are given to `files` that are all meshes or octrees:
/// they would change nothing. --frame and --unit are those of meshes, too.
void need_options_fit(const CLI::App& verb, const std::vector<std::string>& files);

/// A path that is there, or a pattern of image files.
CLI::Validator scan_path();

/// Throws CLI::ValidationError where an option cannot be understood.
voxel::ReadOptions read_options(const Program& program, const ScanIn& in);

/// Reads the scan; "read" in the timings, progress on a terminal; `slices_final` as in voxel::ReadOptions.
/// Throws as voxel::read_scene().
voxel::Scene read_scan(const Program& program, const std::filesystem::path& path, const ScanIn& in,
                       Timings& timings, const voxel::SlicesFinal& slices_final = {});

/// Whether a scene was read from DICOM, by its audit.
bool is_dicom(const voxel::Scene& scene);

}  // namespace octotomy::planner::cli
