// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "planner/operation/picture/render.h"
#include "voxel/view/composite.h"
#include "voxel/view/decide.h"
#include "voxel/view/radiograph.h"

// Choices for the samples along rays (thesis 4.4.2.3), and for surfaces that show their density (5.2.1.2).
namespace octotomy::planner {

/// The fields of decision functions, layers, ranges, opacity and density.
std::vector<Field> ray_fields();

/// Throws std::runtime_error if a text cannot be read, or if options are combined so that one has no effect.
void check_ray_choices(const Render& render);

/// Whether rays end where a decision function holds, instead of at the objects' surfaces.
bool is_decided(const Render& render);
/// Whether surfaces show their samples.
bool shows_densities(const Render& render);
/// The decision function for an object's samples; of kind range, the range is LOW:HIGH of its window.
/// Precondition: is_decided().
voxel::Decision decision_of(const Render& render, double low, double high);
/// The ranges that radiographs dissolve or heighten, with their weights.
std::vector<voxel::RangeWeight> weights_of(const Render& render);
/// The ramp by which composite pictures compute opacity from the gradient; none if not requested.
std::optional<voxel::GradientOpacity> gradient_opacity_of(const Render& render);
/// The colours of ranges of samples.
std::vector<voxel::DensityColour> density_colours_of(const Render& render);

}  // namespace octotomy::planner
