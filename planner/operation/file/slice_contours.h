// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "planner/operation/table/sample_window.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Contours on parallel slices: traced in a scan, edited, thinned, smoothed, and offset outward or inward.
namespace octotomy::planner {

/// The contours of the window low..high on a scan's slices, in the view that looks along its third axis.
/// Empty slices at either end are left out except the innermost one. Throws std::runtime_error if the slices
/// are oblique to the patient's axes or no sample is in the window. The contours are traced by the surface
/// kernel (brep/contour/contour.h); the voxel kernel has voxel::contour_regions().
voxel::SliceMask slice_contours(const voxel::Scene& scene, double low, double high);

/// A separate window for one slice.
struct SliceWindow {
  double position_mm = 0.0;  ///< in the view of the contours
  SampleWindow window;
};
/// Reads POSITION=WINDOW, for example "30=250:". Throws std::runtime_error that states an example.
SliceWindow parse_slice_window(const std::string& text);

/// Traces contours with separate windows for the slices at the positions in `own`. The other slices use
/// `window`; without it they stay empty. Throws std::runtime_error if no slice is within half a slice's
/// distance of a position, or if two positions lie in the same slice.
voxel::SliceMask slice_contours(const voxel::Scene& scene, const std::optional<SampleWindow>& window,
                                const std::vector<SliceWindow>& own);

/// Changes of every contour, made in this order.
struct Refinement {
  double least_area_mm2 = 0.0;           ///< in mm2; smaller contours are removed, including holes
  double thin_mm = 0.0;                  ///< removes points closer than this to a straight piece, in mm
  std::optional<std::size_t> harmonics;  ///< number of the lowest Fourier harmonics that a smoothed contour
                                         ///< has; none: no smoothing
  double offset_mm = 0.0;                ///< outward, or inward if negative, in mm; contours that then
                                         ///< overlap are united
};

/// Changes the contours of a mask. If thinning or smoothing would make a contour cross itself, the number of
/// harmonics is doubled repeatedly, or the contour stays unchanged; `findings` lists each such contour.
/// Throws std::runtime_error that names the slice's position if an offset fails, or if no contour remains.
voxel::SliceMask refined(const voxel::SliceMask& mask, const Refinement& refinement,
                         std::vector<std::string>& findings);

/// Makes the edits of a file, in their order:
///   { "edits": [ { "slice": 0, "contour": 2, "do": "move", "point": 5, "to_mm": [u, v] }, ... ] } with "do"
/// one of move (point, to_mm), insert (piece, at_mm), delete (point), split (first, second), join (piece,
/// with, its_piece), remove, add (points_mm, without contour). Numbers count from 0 in the state that the
/// earlier edits left. The second part of a split becomes the slice's last contour. After join and remove,
/// the numbers of later contours decrease by one. Throws std::runtime_error naming the file, the edit and the
/// fault; a contour that crosses itself is a fault, too.
voxel::SliceMask edited(const voxel::SliceMask& mask, const std::filesystem::path& edits);

/// The mask as JSON in the form that read_slices() in region_file.h reads.
nlohmann::ordered_json to_json(const voxel::SliceMask& mask);

/// The contours as Freeman's chain codes on a grid of `spacing_mm`:
///   { "spacing_mm": 1, "slices": [ { "position_mm": z, "chains": [ { "start": [i, j], "steps": "0017" } ] }
///   ] }
nlohmann::ordered_json chain_codes(const voxel::SliceMask& mask, double spacing_mm);

}  // namespace octotomy::planner
