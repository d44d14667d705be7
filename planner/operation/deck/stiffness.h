// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "convert/deck/materials.h"
#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// How elements get their stiffness from a scan in HU.
struct Stiffness {
  ScanName scan;
  std::vector<double> density;  ///< slope and intercept: g/cm3 = density[1] + density[0] * HU; empty: not
                                ///< calibrated
  std::string law = convert::MaterialOptions{}.law;
  int bins = convert::MaterialOptions{}.bins;
  double surface_depth_mm = convert::MaterialOptions{}.surface_depth_mm;
  double poisson_ratio = convert::MaterialOptions{}.poisson_ratio;
};

/// The fields of Stiffness except the scan.
std::vector<Field> stiffness_fields();

/// Assigns a material to each element from the scan's samples in it: adds materials, fields and a note to the
/// deck. Returns findings. `scan_from_deck` maps the deck's points to positions in the scan, LPS to LPS.
/// Throws std::runtime_error if an element lies outside the scan.
std::vector<std::string> add_stiffness(const Stiffness& stiffness, const convert::Tetrahedra& tetrahedra,
                                       const glm::dmat4& scan_from_deck, const voxel::Scene& scan,
                                       const voxel::Progress& progress, convert::DeckOptions& deck);

}  // namespace octotomy::planner
