// SPDX-License-Identifier: AGPL-3.0-or-later
// answers FIRST COUNT [spoiled]: the voxel kernel's answers to random expressions, one line each: its number
// and a digest of the octree's voxels, all measures and the traced depths, bit by bit. Built as a program of
// this machine and as WebAssembly; the lines must be the same. Spoiled, one voxel is another in every answer.
// Ends with how often each leaf was met and, on this machine, the seconds of processor time.
//
// A case's generator is seeded with its number, that of its lattice with a 64th of it. Neither calls a
// function of libm, whose roundings differ from one library to the next: rotations come from quaternions.
#include <algorithm>
#include <array>
#include <bit>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

#include "voxel/measure/measure.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/expression.h"
#include "voxel/tree/build.h"
#include "voxel/tree/slice_bits.h"
#include "voxel/view/node_trace.h"

#ifndef __wasm__
#include <tbb/global_control.h>
#endif

namespace {

using namespace octotomy::voxel;

constexpr int leaf_kinds = 11;

/// FNV-1a over 64-bit words, with a last mixing step so that every input bit reaches every digit.
class Digest {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) sum_ = (sum_ ^ ((word >> (8 * byte)) & 255U)) * 1099511628211U;
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  void add(const glm::dvec3& p) {
    for (int axis = 0; axis < 3; ++axis) add(p[axis]);
  }
  std::uint64_t value() const { return (sum_ ^ (sum_ >> 29)) * 0xbf58476d1ce4e5b9U; }

 private:
  std::uint64_t sum_ = 14695981039346656037U;
};

/// One case's random numbers and the objects that its expression is made of.
class Question {
 public:
  Question(std::uint64_t number, std::array<std::uint64_t, leaf_kinds>& met)
      : random_(number / 64), met_(met) {
    // 64 cases share a lattice: the weights of areas are summed for each, which takes longer than a case.
    const double mm = real(0.4, 2.0);
    const bool cubic = below(2) == 0;
    const glm::dmat3 axes = below(2) == 0 ? glm::dmat3(1.0) : rotation();
    for (int axis = 0; axis < 3; ++axis)
      universe_.lps_from_voxel[axis] = glm::dvec4(axes[axis] * (cubic ? mm : mm * real(0.7, 1.4)), 0.0);
    universe_.lps_from_voxel[3] = glm::dvec4(place(80.0), 1.0);
    random_.seed(number);
    universe_.depth = below(8) == 0 ? 5 : 4;
  }

  const Universe& universe() const { return universe_; }
  std::uint64_t below(std::uint64_t count) { return random_() % count; }

  /// An expression of `leaves` leaves. The evaluation order of its parts is fixed.
  Expression expression(int leaves) {
    if (leaves == 1) return leaf();
    const int left = 1 + static_cast<int>(below(static_cast<std::uint64_t>(leaves - 1)));
    const Expression a = expression(left);
    const Expression b = expression(leaves - left);
    switch (below(6)) {
      case 0:
        return a & b;
      case 1:
        return a | b;
      case 2:
        return a - b;
      case 3:
        return a ^ b;
      case 4:
        return ~a | b;
      default: {
        if (below(2) == 0) return moved(a, motion()) | b;
        return reflected(a, mirror()) - b;
      }
    }
  }

 private:
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  glm::dvec3 place(double half) {
    const double x = real(-half, half), y = real(-half, half), z = real(-half, half);
    return {x, y, z};
  }
  glm::dvec3 inside() {
    const double x = real(0.1, 0.9), y = real(0.1, 0.9), z = real(0.1, 0.9);
    return universe_.lattice().lps_mm(glm::dvec3(x, y, z) * double(universe_.side()));
  }
  double length() { return real(0.1, 0.45) * universe_.side() * universe_.lattice().spacing_mm().x; }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 p = place(1.0);
      if (const double square = glm::dot(p, p); square > 0.01 && square < 1.0) return p / std::sqrt(square);
    }
  }
  glm::dmat3 rotation() {
    const glm::dvec3 axis = direction();
    const double half = real(-1.0, 1.0);
    const double scale = 1.0 / std::sqrt(1.0 + half * half);
    const double w = scale, x = half * scale * axis.x, y = half * scale * axis.y, z = half * scale * axis.z;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
            {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
            {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
  }
  glm::dmat4 motion() {
    glm::dmat4 moved(1.0);
    if (below(3) != 0) {
      moved = glm::dmat4(rotation());
      const glm::dvec3 about = inside();
      moved[3] = glm::dvec4(about - glm::dmat3(moved) * about + place(4.0), 1.0);
      return moved;
    }
    // By whole voxels, which the kernel knows.
    glm::dvec3 step(0.0);
    for (int axis = 0; axis < 3; ++axis)
      step += glm::dvec3(universe_.lps_from_voxel[axis]) * (static_cast<double>(below(9)) - 4.0);
    moved[3] = glm::dvec4(step, 1.0);
    return moved;
  }
  glm::dmat4 mirror() {
    const glm::dvec3 normal = direction();
    const double offset = glm::dot(normal, inside());
    glm::dmat4 mirrored(glm::dmat3(1.0) - 2.0 * glm::outerProduct(normal, normal));
    mirrored[3] = glm::dvec4(2.0 * offset * normal, 1.0);
    return mirrored;
  }
  View view() {
    const glm::dmat3 axes = rotation();
    return {axes[1], axes[2], glm::cross(axes[1], axes[2])};
  }
  std::vector<glm::dvec2> polygon(const View& view) {
    std::vector<glm::dvec2> points;
    for (std::uint64_t i = 3 + below(5); i > 0; --i) points.push_back(view.project(inside()));
    return points;
  }
  Octree voxels() {
    const std::uint64_t most = 1 + below(7);
    const int along = universe_.side() / 16;
    std::vector<std::array<std::uint64_t, 64>> blocks(static_cast<std::size_t>(along * along * along));
    for (auto& block : blocks)
      for (std::uint64_t& word : block) {
        word = random_();
        for (std::uint64_t i = 1; i < most; ++i) word |= random_();
        if (below(4) == 0) word = below(2) == 0 ? 0 : all_children;
      }
    return octree_of_blocks(universe_, [&](const glm::ivec3& block) {
      const auto number = static_cast<std::size_t>(block.x + along * (block.y + along * block.z));
      return make_leaf_block(0, all_children, blocks[number].data());
    });
  }
  Window window() {
    Scene scene;
    scene.lattice = universe_.lattice();
    Int16Samples samples(scene.lattice.sample_count());
    const glm::ivec3 slope{static_cast<int>(below(31)) - 15, static_cast<int>(below(31)) - 15,
                           static_cast<int>(below(31)) - 15};
    std::size_t at = 0;
    const int side = universe_.side();
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          samples[at++] = static_cast<std::int16_t>(slope.x * x + slope.y * y + slope.z * z +
                                                    static_cast<int>(random_() >> 58));
    scene.samples = std::move(samples);
    const double low = real(-500.0, 400.0);
    return {grey_octree_of(universe_, scene), low, low + real(20.0, 600.0)};
  }
  Expression leaf() {
    const std::uint64_t kind = below(leaf_kinds);
    ++met_[kind];
    switch (kind) {
      case 0:
        return voxels();
      case 1:
        return window();
      case 2: {
        const View from = view();
        RegionMask mask{{{from, {polygon(from), polygon(from)}}}};
        return mask;
      }
      case 3: {
        SliceMask mask;
        mask.view = view();
        const double gap = 0.25 * universe_.side() * universe_.lattice().spacing_mm().x;
        const double first = glm::dot(inside(), mask.view.look) - gap;
        for (int i = 0; i < 3; ++i) mask.slices.push_back({first + gap * i, {polygon(mask.view)}});
        mask.between = below(2) == 0 ? SliceMask::Between::ShapeBased : SliceMask::Between::Nearest;
        return mask;
      }
      case 4: {
        const glm::dvec3 normal = direction();
        return HalfSpace{normal, glm::dot(normal, inside())};
      }
      case 5: {
        const glm::dvec3 centre = inside();
        return Sphere{centre, length()};
      }
      case 6: {
        const glm::dvec3 a = inside(), b = inside();
        return Box{glm::min(a, b), glm::max(a, b) + 0.1};
      }
      case 7: {
        const glm::dvec3 centre = inside();
        const double x = length(), y = length(), z = length();
        return Ellipsoid{centre, {x, y, z}, rotation()};
      }
      case 8: {
        const glm::dvec3 centre = inside();
        const double x = length(), y = length(), z = length();
        return OrientedBox{centre, {x, y, z}, rotation()};
      }
      case 9: {
        const glm::dvec3 from = inside();
        const glm::dvec3 along = direction();
        const double far = length();
        return Cylinder{from, from + far * along, 0.5 * length()};
      }
      default: {
        const glm::dvec3 centre = inside();
        const glm::dvec3 axis = direction();
        const double ring = length();
        return Torus{centre, axis, ring, 0.4 * ring};
      }
    }
  }

  std::mt19937_64 random_;
  std::array<std::uint64_t, leaf_kinds>& met_;
  Universe universe_;
};

void add_voxels(Digest& digest, const Octree& octree, bool spoiled) {
  SliceBits slice;
  for (int z = 0; z < octree.universe().side(); ++z) {
    read_slice(octree, z, slice);
    if (spoiled && z == 7) slice.words[5] ^= 64U;
    for (const std::uint64_t word : slice.words) digest.add(word);
  }
}

void add_measures(Digest& digest, const Octree& octree) {
  const Measures measures = measure(octree);
  digest.add(measures.voxel_count);
  digest.add(measures.volume_mm3);
  if (measures.centroid_mm) digest.add(*measures.centroid_mm);
  if (measures.extents) {
    digest.add(measures.extents->low_mm);
    digest.add(measures.extents->high_mm);
  }
  digest.add(measures.area_crofton13_mm2);
  if (measures.area_lindblad_mm2) digest.add(*measures.area_lindblad_mm2);
  if (measures.inertia_mm5)
    for (int axis = 0; axis < 3; ++axis) digest.add((*measures.inertia_mm5)[axis]);
  digest.add(measures.exposed_mm2);
}

void add_columns(Digest& digest, const Octree& octree, Question& question) {
  AxisView axes;
  std::rotate(axes.axis.begin(), axes.axis.begin() + static_cast<int>(question.below(3)), axes.axis.end());
  for (bool& reversed : axes.reversed) reversed = question.below(2) == 1;
  DrawnObject object{"object", octree};
  for (const Seen& seen : node_trace({object}, axes).columns) {
    digest.add(static_cast<std::uint64_t>(seen.object + 1));
    if (seen.lit()) digest.add(static_cast<double>(seen.depth_mm));
  }
}

}  // namespace

int main(int count, char** words) {
  const std::uint64_t first = count > 1 ? std::strtoull(words[1], nullptr, 10) : 0;
  const std::uint64_t cases = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1000;
  const bool spoiled = count > 3;
#ifndef __wasm__
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
#endif
  std::array<std::uint64_t, leaf_kinds> met{};
  std::uint64_t empty = 0;
  for (std::uint64_t number = first; number < first + cases; ++number) {
    Question question(number, met);
    const Expression expression = question.expression(1 + static_cast<int>(question.below(6)));
    Digest digest;
    const Octree octree = combine(question.universe(), expression);
    add_voxels(digest, octree, spoiled);
    add_measures(digest, octree);
    add_columns(digest, octree, question);
    empty += octree.is_empty() ? 1U : 0U;
    std::printf("%" PRIu64 " %016" PRIx64 "\n", number, digest.value());
  }
  std::fprintf(stderr, "{\"empty\": %" PRIu64 ", \"leaves\": [", empty);
  for (int kind = 0; kind < leaf_kinds; ++kind)
    std::fprintf(stderr, "%s%" PRIu64, kind == 0 ? "" : ", ", met[static_cast<std::size_t>(kind)]);
  std::fprintf(stderr, "]}\n");
#ifndef __wasm__
  std::fprintf(stderr, "{\"seconds\": %.3f}\n", static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
#endif
}
