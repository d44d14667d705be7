// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "voxel/scan/read_scene.h"

namespace CLI {
class Validator;
}  // namespace CLI

// Common options of verbs that read a scan.
namespace octotomy::planner::cli {

/// The options for reading a scan, as text.
struct ScanIn {
  std::string series, slices, spacing, frame, unit;
  bool join = false;
  std::vector<std::string> raw;  ///< DIMS TYPE
  bool big_endian = false;
  std::uint64_t offset = 0;
};

/// Adds --series, --join, --slices, --frame, --unit, --spacing, --raw, --big-endian and --offset to a verb's
/// help, under a heading that names the scan.
void add_scan_options(CLI::App& verb, ScanIn& in, const std::string& heading = "scan");

/// Throws std::runtime_error if options for a scan are given but all `files` are meshes or octrees, because
/// they would have no effect. --frame and --unit also apply to meshes.
void need_options_fit(const CLI::App& verb, const std::vector<std::string>& files);

/// Accepts an existing path, or a pattern of image files.
CLI::Validator scan_path();

/// The options for reading a scan. Throws CLI::ValidationError if an option is invalid.
voxel::ReadOptions read_options(const Program& program, const ScanIn& in);

/// Reads the scan, with the time added to "read" and progress on a terminal; `slices_final` as in
/// voxel::ReadOptions. Throws as voxel::read_scene() does.
voxel::Scene read_scan(const Program& program, const std::filesystem::path& path, const ScanIn& in,
                       Timings& timings, const voxel::SlicesFinal& slices_final = {});

/// Whether a scene was read from DICOM, by its audit.
bool is_dicom(const voxel::Scene& scene);

}  // namespace octotomy::planner::cli
