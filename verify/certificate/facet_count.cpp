// SPDX-License-Identifier: AGPL-3.0-or-later
//
// By the divergence theorem, F(k) = i / (2 pi |k|^2) * sum over facets of (k . n) T(k), T the integral of
// exp(-2 pi i k . x) over the facet; and once more in the facet's plane, with t the part of k in it,
// T(k) = i / (2 pi |t|^2) * sum over sides of (t . m) L J(k), m the side's outward normal in the plane, L its
// length and J the mean of exp(-2 pi i k . x) along it. If t vanishes, all of the facet is in phase, and T is
// its area.
//   1  Lay each facet's sides end to end, so that a point between two sides is evaluated once. Join sides
//      that continue in a straight line, as along the cells of a scan.
//   2  For up to `part_sides` sides at a time, compute the phases exp(-2 pi i x) of the points' coordinates
//      (only the fraction of x matters), and by multiplication their powers up to the largest component of
//      any k.
//   3  For each k the product of three powers is a point's phase. J is the difference of a side's two phases
//      divided by its turn, or a series where the turn is so small that the difference has lost digits.
// A power of 65 errs by at most 65 roundings of a complex product, sqrt(5) half-units each (Brent, Percival
// and Zimmermann, 2007): a phase by 5e-14 and J, for turns above 0.01, by 1e-11. The series leaves 2e-13.
#include "verify/certificate/facet_count.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>
#include <tuple>

namespace octotomy::verify {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr int longest_wave = 6;
constexpr int reach_along_normals = 64;
constexpr std::size_t normals_followed = 32;

/// Largest number of sides of a facet in one Part, so that the powers of their phases fit a core's cache.
constexpr std::size_t part_sides = 48;
/// Number of groups of parts. Each group is summed by one thread. The number is fixed, so that the order of a
/// sum does not depend on the number of threads.
constexpr std::size_t sum_groups = 32;

/// Sides end to end: side i goes from points[i] to points[i + 1]. A side that does not count leads from the
/// end of one outline of the facet to the start of the next.
struct Path {
  std::vector<glm::dvec3> points;
  std::vector<bool> counts;  ///< by side: whether it belongs to the facet
};

bool before(const glm::dvec3& a, const glm::dvec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// Returns the path without the points on the straight line between their neighbours.
Path straightened(const Path& path) {
  constexpr double off_line_voxels = 1e-9;
  Path made;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const bool between = i > 0 && i < path.counts.size() && path.counts[i - 1] && path.counts[i];
    if (between) {
      const glm::dvec3 side = path.points[i] - made.points.back(),
                       along = path.points[i + 1] - made.points.back();
      if (glm::dot(side, path.points[i + 1] - path.points[i]) > 0.0 &&
          glm::length(glm::cross(side, along)) < off_line_voxels * glm::length(along))
        continue;
    }
    if (i > 0) made.counts.push_back(path.counts[i - 1]);
    made.points.push_back(path.points[i]);
  }
  return made;
}

Path path_of(std::vector<std::array<glm::dvec3, 2>> sides) {
  std::sort(sides.begin(), sides.end(), [](const auto& a, const auto& b) {
    return a[0] != b[0] ? before(a[0], b[0]) : before(a[1], b[1]);
  });
  std::vector<bool> used(sides.size(), false);
  Path path;
  const auto take = [&](std::size_t i) {
    used[i] = true;
    path.counts.push_back(true);
    path.points.push_back(sides[i][1]);
  };
  for (std::size_t first = 0; first < sides.size(); ++first) {
    if (used[first]) continue;
    if (!path.points.empty()) path.counts.push_back(false);
    path.points.push_back(sides[first][0]);
    take(first);
    for (bool found = true; found;) {
      auto next = static_cast<std::size_t>(
          std::lower_bound(sides.begin(), sides.end(), path.points.back(),
                           [](const auto& side, const glm::dvec3& from) { return before(side[0], from); }) -
          sides.begin());
      while (next < sides.size() && used[next] && sides[next][0] == path.points.back()) ++next;
      found = next < sides.size() && sides[next][0] == path.points.back();
      if (found) take(next);
    }
  }
  return straightened(path);
}

/// Up to part_sides sides of one facet. Computes their contribution to the sum over facets for each vector k.
class Part {
 public:
  Part(const Facet& facet, const Path& path, std::size_t first, std::size_t last)
      : area_(glm::length(facet.area)),
        normal_(facet.area / area_),
        is_first_(first == 0),
        sides_(last - first) {
    for (std::size_t i = first; i <= last; ++i) points_.push_back(path.points[i]);
    for (std::size_t i = first; i < last; ++i) {
      const glm::dvec3 side = path.points[i + 1] - path.points[i];
      const glm::dvec3 outward = path.counts[i] ? glm::cross(side, normal_) : glm::dvec3(0.0);
      for (int axis = 0; axis < 3; ++axis) {
        side_[axis].push_back(2.0 * pi * side[axis]);
        outward_[axis].push_back(outward[axis]);
      }
    }
  }

  /// Adds the part's contribution to the total of each vector k. Contributions are multiplied by -i |k|^2 2
  /// pi, a factor that is the same for all facets. `most`: the largest absolute value of each component of
  /// the vectors.
  void add(const std::vector<glm::ivec3>& vectors, const glm::ivec3& most, std::vector<Complex>& totals) {
    for (int axis = 0; axis < 3; ++axis) take_powers(axis, most[axis]);
    multiply(power_[1][0], power_[2][0], false, false, yz_);
    for (std::size_t i = 0; i < vectors.size(); ++i) totals[i] += share(vectors[i]);
  }

 private:
  /// The real and the imaginary parts of the points' phases.
  struct Phases {
    std::array<double, part_sides + 1> re, im;
  };

  void take_powers(int axis, int most) {
    std::vector<Phases>& power = power_[axis];
    power.resize(static_cast<std::size_t>(most) + 1);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double x = points_[i][axis];
      const Complex once = std::polar(1.0, -2.0 * pi * (x - std::floor(x)));
      power[0].re[i] = 1.0;
      power[0].im[i] = 0.0;
      for (std::size_t n = 1; n < power.size(); ++n) {
        const double re = power[n - 1].re[i], im = power[n - 1].im[i];
        power[n].re[i] = re * once.real() - im * once.imag();
        power[n].im[i] = re * once.imag() + im * once.real();
      }
    }
  }

  void take_phases(const glm::ivec3& k) {
    const auto of = [&](int axis) -> const Phases& {
      return power_[axis][static_cast<std::size_t>(std::abs(k[axis]))];
    };
    if (k.y != last_.y || k.z != last_.z) multiply(of(1), of(2), k.y < 0, k.z < 0, yz_);
    last_ = k;
    multiply(of(0), yz_, k.x < 0, false, phase_);
  }

  void multiply(const Phases& a, const Phases& b, bool conjugate_a, bool conjugate_b, Phases& made) const {
    const double of_a = conjugate_a ? -1.0 : 1.0, of_b = conjugate_b ? -1.0 : 1.0;
    for (std::size_t i = 0; i <= sides_; ++i) {
      const double a_im = of_a * a.im[i], b_im = of_b * b.im[i];
      made.re[i] = a.re[i] * b.re[i] - a_im * b_im;
      made.im[i] = a.re[i] * b_im + a_im * b.re[i];
    }
  }

  Complex share(const glm::ivec3& k_integer) {
    const glm::dvec3 k(k_integer);
    const double along = glm::dot(k, normal_);
    const glm::dvec3 tangent = k - along * normal_;
    const double square = glm::dot(tangent, tangent);
    take_phases(k_integer);
    // If the phase changes by less than a ten-thousandth of a turn across the facet, the facet counts with
    // the phase of its first point. The sum over sides would lose four digits or more by cancellation.
    if (square * area_ < 1e-8)
      return is_first_ ? along * area_ * Complex(phase_.re[0], phase_.im[0]) : Complex(0.0);
    constexpr double small_turn = 0.01;
    long small = 0;
    for (std::size_t i = 0; i < sides_; ++i) {
      const double turn = k.x * side_[0][i] + k.y * side_[1][i] + k.z * side_[2][i];
      const double weight = k.x * outward_[0][i] + k.y * outward_[1][i] + k.z * outward_[2][i];
      const bool is_small = std::abs(turn) < small_turn;
      const double over = (is_small ? 0.0 : weight) / (is_small ? 1.0 : turn);
      small += is_small ? 1 : 0;
      turn_[i] = turn;
      weight_[i] = weight;
      re_[i] = over * (phase_.im[i] - phase_.im[i + 1]);
      im_[i] = over * (phase_.re[i + 1] - phase_.re[i]);
    }
    Complex sum = 0.0;
    for (std::size_t i = 0; i < sides_; ++i) sum += Complex(re_[i], im_[i]);
    if (small > 0)
      for (std::size_t i = 0; i < sides_; ++i) {
        const double turn = turn_[i], square_turn = turn * turn;
        if (std::abs(turn) < small_turn)
          sum += weight_[i] * Complex(phase_.re[i], phase_.im[i]) *
                 Complex(1.0 - square_turn / 6.0 * (1.0 - square_turn / 20.0),
                         -turn / 2.0 * (1.0 - square_turn / 12.0));
      }
    return Complex(0.0, along / (2.0 * pi * square)) * sum;
  }

  double area_;
  glm::dvec3 normal_;
  bool is_first_;
  std::size_t sides_;
  std::vector<glm::dvec3> points_;
  /// by axis, for each side: its phase in radians for k = 1, and its outward weight
  std::array<std::vector<double>, 3> side_, outward_;
  std::array<std::vector<Phases>, 3> power_;
  glm::ivec3 last_{0};
  Phases yz_, phase_;
  std::array<double, part_sides> turn_, weight_, re_, im_;
};

/// Returns the same vector for k and for -k: one of the two.
glm::ivec3 one_of_opposites(const glm::ivec3& k) {
  const bool lower = k.z != 0 ? k.z < 0 : k.y != 0 ? k.y < 0 : k.x < 0;
  return lower ? -k : k;
}

/// Adds the integer vectors nearest to the multiples of a normal: nine for each step along the normal's
/// largest component.
void add_along(const glm::dvec3& normal, std::vector<glm::ivec3>& vectors) {
  int most = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) > std::abs(normal[most])) most = axis;
  const int u = (most + 1) % 3, v = (most + 2) % 3;
  for (int step = 1; step <= reach_along_normals; ++step) {
    const glm::ivec3 nearest(glm::round(normal * (step / normal[most])));
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        glm::ivec3 k = nearest;
        k[u] += i;
        k[v] += j;
        vectors.push_back(one_of_opposites(k));
      }
  }
}

}  // namespace

std::vector<glm::ivec3> count_vectors(const std::vector<Facet>& facets) {
  assert(std::is_sorted(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return glm::dot(a.area, a.area) > glm::dot(b.area, b.area);
  }));
  std::vector<glm::ivec3> vectors;
  for (int z = -longest_wave; z <= longest_wave; ++z)
    for (int y = -longest_wave; y <= longest_wave; ++y)
      for (int x = -longest_wave; x <= longest_wave; ++x)
        if (x != 0 || y != 0 || z != 0) vectors.push_back(one_of_opposites({x, y, z}));
  for (std::size_t i = 0; i < std::min(facets.size(), normals_followed); ++i)
    add_along(glm::normalize(facets[i].area), vectors);
  const auto earlier = [](const glm::ivec3& a, const glm::ivec3& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  };
  std::sort(vectors.begin(), vectors.end(), earlier);
  vectors.erase(std::unique(vectors.begin(), vectors.end()), vectors.end());
  return vectors;
}

double count_variance(const std::vector<Facet>& facets) {
  std::vector<Facet> flat;
  for (const Facet& facet : facets)
    if (glm::dot(facet.area, facet.area) > 0.0) flat.push_back(facet);
  if (flat.empty()) return 0.0;
  std::stable_sort(flat.begin(), flat.end(), [](const Facet& a, const Facet& b) {
    return glm::dot(a.area, a.area) > glm::dot(b.area, b.area);
  });
  const std::vector<glm::ivec3> vectors = count_vectors(flat);
  glm::ivec3 most(0);
  for (const glm::ivec3& k : vectors) most = glm::max(most, glm::abs(k));
  std::vector<Path> paths(flat.size());
  tbb::parallel_for(std::size_t{0}, flat.size(), [&](std::size_t i) { paths[i] = path_of(flat[i].sides); });
  std::vector<std::pair<std::size_t, std::size_t>> parts;  // a facet and the part's first side
  for (std::size_t i = 0; i < flat.size(); ++i)
    for (std::size_t first = 0; first < paths[i].counts.size(); first += part_sides)
      parts.push_back({i, first});
  std::vector<std::vector<Complex>> totals(sum_groups);
  tbb::parallel_for(std::size_t{0}, sum_groups, [&](std::size_t group) {
    totals[group].resize(vectors.size());
    for (std::size_t n = group * parts.size() / sum_groups; n < (group + 1) * parts.size() / sum_groups;
         ++n) {
      const auto& [i, first] = parts[n];
      const std::size_t last = std::min(first + part_sides, paths[i].counts.size());
      Part(flat[i], paths[i], first, last).add(vectors, most, totals[group]);
    }
  });
  struct Sum {
    double variance = 0.0, fourths = 0.0;
  } seen;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const double square = glm::dot(glm::dvec3(vectors[i]), glm::dvec3(vectors[i]));
    Complex total = 0.0;
    for (const std::vector<Complex>& of_group : totals) total += of_group[i];
    seen.variance += 2.0 * std::norm(total) / (4.0 * pi * pi * square * square);
    seen.fourths += 2.0 / (square * square);
  }
  // Terms beyond `seen` are small for facets whose normals were followed. For the other facets they are
  // estimated: the sum of 1 / |k|^4 over all integer vectors but zero is 16.5323, and normals spread evenly
  // over the directions of both k and -k have area / (2 pi) per solid angle.
  constexpr double epstein = 16.5323;
  double others = 0.0;
  for (std::size_t i = normals_followed; i < flat.size(); ++i) others += glm::length(flat[i].area);
  return seen.variance + (epstein - seen.fourths) / (4.0 * pi * pi) * others / (2.0 * pi);
}

}  // namespace octotomy::verify
