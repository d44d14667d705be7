// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "planner/operation/picture/render.h"
#include "voxel/view/shade.h"

// The lights of pictures, and the shares of light that surfaces reflect (thesis 5.1).
namespace octotomy::planner {

/// The fields of the lights and the shares.
std::vector<Field> light_fields();

/// Throws std::runtime_error if a light cannot be read, or if a share would have no effect.
void check_lights(const Render& render);

/// The typed lights, or the default ones. The diffuse share determines the strength of lights that state
/// none. Empty if the user chose nothing. Throws as check_lights().
std::vector<voxel::Light> lights_of(const Render& render);

}  // namespace octotomy::planner
