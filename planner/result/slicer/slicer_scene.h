// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "planner/operation/file/itk_transform.h"
#include "planner/plan/evaluate.h"

namespace octotomy::planner {

/// Writes an evaluated plan as a scene of 3D Slicer: a folder with scene.mrml and Data/, or one .mrb, a zip
/// archive of that folder, by the extension. All files are in LPS and millimetres and state this:
/// - each scan as .nrrd;
/// - all objects as the segments of one .seg.nrrd, in layers where they overlap; masks are left out;
/// - each object that has a surface as a model, .vtp. The model of a moved object is its surface before the
///   motion, under a linear transform that Slicer shows and can change;
/// - each motion as an ITK transform, .tfm or .h5. As ITK defines it, it maps positions after the motion to
///   those before;
/// - as .mrk.json, all at their places before any motion: the plan's landmarks, its saws and the sides of its
///   masks as planes, the regions of its masks as closed curves; and each screw's axis as a line, at its
///   object's place.
/// Equal plans make equal files. Returns the names in {"scans", "segments", "models", "transforms",
/// "landmarks"}, and the files in {"planes", "curves", "lines"}. Precondition: the evaluation has stored its
/// scans (EvaluateOptions::keep_scans). Throws voxel::Error (Input) if `path` is a folder with files in it,
/// voxel::Error and brep::Error as the writers do, and Stopped; then nothing is written. Sources: 3D Slicer's
/// documentation, "MRML overview", "Coordinate systems" and the schema of its markups; ITK's Software Guide
/// on transform files.
nlohmann::ordered_json write_slicer_scene(const Plan& plan, const Evaluation& evaluation,
                                          const std::filesystem::path& path,
                                          TransformFormat transforms = TransformFormat::Text,
                                          const std::stop_token& stop = {});

}  // namespace octotomy::planner
