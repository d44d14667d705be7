// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "planner/operation/picture/render.h"
#include "voxel/view/composite.h"
#include "voxel/view/decide.h"
#include "voxel/view/radiograph.h"

// How pictures use the samples along rays (thesis 4.4.2.3), and how surfaces show their density (5.2.1.2).
namespace octotomy::planner {

/// The fields of decision functions, layers, ranges, opacity and density.
std::vector<Field> ray_fields();

/// Throws std::runtime_error for text that cannot be read, and for combinations in which one option has no
/// effect.
void check_ray_choices(const Render& render);

/// Whether rays end by a decision function, not at the objects' surfaces.
bool is_decided(const Render& render);
/// Whether surfaces show their samples.
bool shows_densities(const Render& render);
/// The decision for an object's samples; of a window LOW:HIGH, the range. Precondition: is_decided().
voxel::Decision decision_of(const Render& render, double low, double high);
/// The ranges that radiographs dissolve or heighten.
std::vector<voxel::RangeWeight> weights_of(const Render& render);
/// The opacity that composite pictures take from the gradient.
std::optional<voxel::GradientOpacity> gradient_opacity_of(const Render& render);
/// The colours of ranges of density.
std::vector<voxel::DensityColour> density_colours_of(const Render& render);

}  // namespace octotomy::planner
