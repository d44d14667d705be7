// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "planner/result/pack/pack_objects.h"

namespace octotomy::planner {

/// The version of the format of packs. It must change if a checker of earlier packs would misread new ones.
inline constexpr int pack_format = 1;

struct PackOptions {
  ExportOptions files = {};
  /// The DICOM series to which DICOM objects in the pack refer. None: the pack has no DICOM objects.
  std::optional<SeriesOfPlan> objects_of = std::nullopt;
};

/// Writes a result as a zip archive that can be checked without this program. Equal results make equal
/// archives, because times are left out. Entries:
/// - plan.plan.json: the plan's text as it was read;
/// - result/: the files of write_result_files();
/// - witness/NUMBER/NAME.npy: witness_arrays() of each object;
/// - dicom/: the files of write_result_objects(), if `options` asks for them;
/// - NOTICE.txt: licences, and a list of the parts that the archive does not contain;
/// - manifest.json, last: every other entry with its length and SHA-256; the objects with their entries; the
///   scans with their lattice and SHA-256; the versions of the program and its libraries.
/// The manifest states "identity": "removed" for a result after leave_out_names(), and "unnamed" for any
/// other anonymous one, so that a replay leaves out the same names. The archive contains no samples of the
/// scans, except the cells of witness_arrays(). Precondition: the evaluation has stored its scans
/// (EvaluateOptions::keep_scans), and `options.files` requests no PDF. Returns the manifest. Throws as
/// write_result_files(), and voxel::Error (Resource) if the disk is full; then the file at `path` is
/// unchanged.
nlohmann::ordered_json write_pack(Result& result, const std::filesystem::path& path,
                                  const PackOptions& options = {});

}  // namespace octotomy::planner
