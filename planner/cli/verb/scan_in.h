// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"
#include "voxel/scan/read_scene.h"

namespace CLI {
class Validator;
}  // namespace CLI

// Options that verbs share if they read a scan.
namespace octotomy::planner::cli {

/// The texts of the options for reading a scan.
struct ScanIn {
  std::string series, slices, spacing, frame, unit;
  bool join = false;
  std::vector<std::string> raw;  ///< DIMS TYPE
  bool big_endian = false;
  std::uint64_t offset = 0;
};

/// Adds --series, --join, --slices, --frame, --unit, --spacing, --raw, --big-endian and --offset to a verb.
/// The help lists them under `heading`.
void add_scan_options(CLI::App& verb, ScanIn& in, const std::string& heading = "scan");

/// Throws std::runtime_error if options for reading a scan are given although all `files` are meshes or
/// octrees, to which they do not apply. --frame and --unit also apply to meshes.
void need_options_fit(const CLI::App& verb, const std::vector<std::string>& files);

/// A validator that accepts an existing path or a pattern of image files.
CLI::Validator scan_path();

/// The options as voxel::ReadOptions. Throws CLI::ValidationError if the text of an option is invalid.
voxel::ReadOptions read_options(const Program& program, const ScanIn& in);

/// Reads a scan and stores its audit for say(). Adds the time to the stage "read" and shows progress on a
/// terminal. `slices_final` as in voxel::ReadOptions. Throws as voxel::read_scene() does.
voxel::Scene read_scan(const Program& program, const std::filesystem::path& path, const ScanIn& in,
                       Timings& timings, const voxel::SlicesFinal& slices_final = {});

/// Whether a scene was read from DICOM, according to its audit.
bool is_dicom(const voxel::Scene& scene);

}  // namespace octotomy::planner::cli
