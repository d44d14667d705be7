// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "planner/operation/table/sample_window.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Contours as regions on parallel slices: followed on a scan, edited, thinned, smoothed, moved out or in.
namespace octotomy::planner {

/// The contours of the window low..high on a scan's slices, in the view that looks along its third axis.
/// Slices without any are left out at either end. Throws std::runtime_error where the slices lie obliquely to
/// the patient's axes or nothing is in the window. The surface kernel's follower (brep/contour/contour.h);
/// the voxel kernel's own is voxel::contour_regions().
voxel::SliceMask slice_contours(const voxel::Scene& scene, double low, double high);

/// A window of a slice's own.
struct SliceWindow {
  double position_mm = 0.0;  ///< in the view of the contours
  SampleWindow window;
};
/// Reads POSITION=WINDOW: "30=250:". Throws std::runtime_error with an example.
SliceWindow parse_slice_window(const std::string& text);

/// Follows contours with separate windows for the slices at these positions. The other slices use `window`; without
/// it they have no contours. Throws std::runtime_error if no slice is within half a slice's distance of a position,
/// or two positions are of one slice.
voxel::SliceMask slice_contours(const voxel::Scene& scene, const std::optional<SampleWindow>& window,
                                const std::vector<SliceWindow>& own);

/// What is done to every contour, in this order.
struct Refinement {
  double least_area_mm2 = 0.0;           ///< smaller contours are removed, holes too
  double thin_mm = 0.0;                  ///< removes points within this distance of a straight piece
  std::optional<std::size_t> harmonics;  ///< smoothed by its lowest ones
  double offset_mm = 0.0;                ///< outward, or inward if below 0; contours that meet are united
};

/// If thinning or smoothing would make a contour cross itself, its harmonics are doubled repeatedly, or it stays
/// unchanged; `findings` lists each such contour. Throws std::runtime_error naming the slice's position if contours
/// cannot be moved, or if no contour is left.
voxel::SliceMask refined(const voxel::SliceMask& mask, const Refinement& refinement,
                         std::vector<std::string>& findings);

/// The edits of a file, made in order:
///   { "edits": [ { "slice": 0, "contour": 2, "do": "move", "point": 5, "to_mm": [u, v] }, ... ] }
/// with "do" one of move (point, to_mm), insert (piece, at_mm), delete (point), split (first, second), join
/// (piece, with, its_piece), remove, add (points_mm, without contour). Numbers count from 0 as the edits
/// before have left them; split puts the second part behind the last contour, join and remove close the gap.
/// Throws std::runtime_error naming the file, the edit and the fault; a contour that crosses itself is a
/// fault, too.
voxel::SliceMask edited(const voxel::SliceMask& mask, const std::filesystem::path& edits);

/// The mask in the format that read_slices() in region_file.h reads.
nlohmann::ordered_json to_json(const voxel::SliceMask& mask);

/// Freeman's codes of the contours on samples `spacing_mm` apart:
///   { "spacing_mm": 1, "slices": [ { "position_mm": z, "chains": [ { "start": [i, j], "steps": "0017" } ] }
///   ] }
nlohmann::ordered_json chain_codes(const voxel::SliceMask& mask, double spacing_mm);

}  // namespace octotomy::planner
