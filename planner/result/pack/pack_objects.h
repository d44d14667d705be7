// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "planner/result/report/report.h"
#include "voxel/scan/dicom_source.h"

namespace octotomy::planner {

/// The DICOM series to which a result's DICOM objects refer.
struct SeriesOfPlan {
  std::string scan;  ///< name of the scan in the plan
  voxel::DicomSource series;
};

/// The DICOM series of the first scan of the plan that was read from DICOM and has no labels. None if there
/// is no such scan. Must be called before leave_out_names(), which removes the paths. Throws as
/// voxel::dicom_source() does.
std::optional<SeriesOfPlan> series_of(const Result& result);

/// Refuses a plan in which a text, such as a step's name, contains a word of the source's patient or study.
/// Such a text cannot be removed when the result is written. `where` is the plan's path. Throws
/// std::runtime_error with the word.
void need_unnamed(const nlohmann::ordered_json& plan, const voxel::DicomSource& source,
                  const std::string& where);

/// Writes a result as DICOM objects into `folder`:
/// - segmentation.dcm: a segment with the voxels of each object that is no tool and not empty;
/// - structures.dcm: the same objects as contours on the series' images;
/// - model_NNN.dcm: the surface of each object that the plan exports, as an encapsulated STL;
/// - plan.dcm and picture_NNN.dcm: the plan's text, and the views/*.png of `results`.
/// Patient and study are those of the series. For an anonymous result, decide_identity() with
/// IdentityChoice::Remove replaces them, and need_unnamed() is called. Equal results make equal files.
/// Returns {"scan", "identity": {"choice", "changes"}, "objects": [{"path", "kind", ...}], "findings"}.
/// Throws as the writers do, and Stopped.
nlohmann::ordered_json write_result_objects(const Result& result, const SeriesOfPlan& of,
                                            const std::filesystem::path& results,
                                            const std::filesystem::path& folder,
                                            const ExportOptions& options = {});

}  // namespace octotomy::planner
