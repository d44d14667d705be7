// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {

/// A closed line along pixels' edges, as the list of its bends; the edge from the last bend to the first is
/// implied. Corner (x, y) lies half a pixel before the centre of pixel (x, y) along both axes. With x to the
/// right and y downwards, the enclosed pixels lie to the right of the line. Outer boundaries therefore have a
/// positive shoelace area, holes a negative one.
using PixelOutline = std::vector<glm::ivec2>;

/// The boundaries of a slice's set pixels. The areas of all outlines add up to the number of pixels, and by
/// the even-odd rule a pixel's centre is inside exactly if the pixel is set. Pixels that touch only at a
/// corner have separate outlines. Outlines are sorted by their first pixel, x fastest. Cost: one pass over
/// the slice.
std::vector<PixelOutline> pixel_outlines(const SliceBits& slice);

/// Twice the signed area, in square pixels: positive for an outer boundary.
long long doubled_area(const PixelOutline& outline);

}  // namespace octotomy::voxel
