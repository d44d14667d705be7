// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "planner/operation/picture/render.h"
#include "voxel/view/shade.h"

// The lights of pictures and the shares in which surfaces return them (thesis 5.1).
namespace octotomy::planner {

/// The fields of the lights and the shares.
std::vector<Field> light_fields();

/// Throws std::runtime_error for lights that cannot be read and for shares that would have no effect.
void check_lights(const Render& render);

/// The lights as typed, or the default ones; the diffuse share sets the strength of lights without one. Empty
/// if nothing was chosen. Throws as check_lights().
std::vector<voxel::Light> lights_of(const Render& render);

}  // namespace octotomy::planner
