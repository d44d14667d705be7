// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The volume of a predicate by regular sampling. The standard error of a point count on curved boundary of
// area S is c h^2 sqrt(S) with c between 0.20 and 0.32 (the lattice-point problem: the errors of boundary
// cells are independent, each a fraction of h^3, and there are about S / h^2 of them). S is estimated from
// the faces between unequal neighbours, whose area is 3/2 of that of an isotropic boundary.

#include "verify/phantom/sample_volume.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <vector>

namespace octotomy::verify {
namespace {

struct Count {
  std::uint64_t inside = 0;
  glm::dvec3 faces{0.0};  // by direction
};

}  // namespace

SampledVolume sample_volume(const voxel::Box& box, double step_mm,
                            const std::function<bool(const glm::dvec3&)>& inside) {
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  if (!(step_mm > 0.0) || !(extent_mm.x > 0.0) || !(extent_mm.y > 0.0) || !(extent_mm.z > 0.0))
    throw std::invalid_argument("sampling needs a box with a volume and a step above 0 mm, not " +
                                std::to_string(step_mm) + " mm");
  const glm::ivec3 dims = glm::max(glm::ivec3(glm::ceil(extent_mm / step_mm - 1e-9)), glm::ivec3(1));
  const glm::dvec3 cell_mm = extent_mm / glm::dvec3(dims);
  const auto row_length = static_cast<std::size_t>(dims.x);
  const auto plane = [&](int z) {
    std::vector<char> bits(row_length * static_cast<std::size_t>(dims.y));
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        bits[static_cast<std::size_t>(y) * row_length + static_cast<std::size_t>(x)] =
            inside(box.low_mm + (glm::dvec3(x, y, z) + 0.5) * cell_mm) ? 1 : 0;
    return bits;
  };

  // Each slab has a fixed number of planes. It also samples the first plane of the next slab, to count the
  // faces between both.
  constexpr int slab_planes = 16;
  const int slab_count = (dims.z + slab_planes - 1) / slab_planes;
  std::vector<Count> counts(static_cast<std::size_t>(slab_count));
  tbb::parallel_for(0, slab_count, [&](int slab) {
    Count& count = counts[static_cast<std::size_t>(slab)];
    std::vector<char> above = plane(slab * slab_planes);
    for (int z = slab * slab_planes; z < std::min((slab + 1) * slab_planes, dims.z); ++z) {
      const std::vector<char> bits = std::move(above);
      above = z + 1 < dims.z ? plane(z + 1) : bits;
      for (std::size_t i = 0; i < bits.size(); ++i) {
        count.inside += bits[i] != 0;
        count.faces.x += (i + 1) % row_length != 0 && bits[i] != bits[i + 1];
        count.faces.y += i + row_length < bits.size() && bits[i] != bits[i + row_length];
        count.faces.z += bits[i] != above[i];
      }
    }
  });

  Count total;
  for (const Count& count : counts) {
    total.inside += count.inside;
    total.faces += count.faces;
  }
  const double cell_mm3 = cell_mm.x * cell_mm.y * cell_mm.z;
  const double area_mm2 = glm::dot(total.faces, cell_mm3 / cell_mm) / 1.5;
  const double longest_mm = std::max({cell_mm.x, cell_mm.y, cell_mm.z});
  return {static_cast<double>(total.inside) * cell_mm3, 0.3 * longest_mm * longest_mm * std::sqrt(area_mm2)};
}

}  // namespace octotomy::verify
