// SPDX-License-Identifier: AGPL-3.0-or-later
//
// By the divergence theorem, F(k) = i / (2 pi |k|^2) * sum over facets of (k . n) T(k), T the integral of
// exp(-2 pi i k . x) over the facet; and once more in the facet's plane, with t the part of k in it,
// T(k) = i / (2 pi |t|^2) * sum over sides of (t . m) L exp(-2 pi i k . middle) sinc(k . side), m the side's
// outward normal in the plane. If t vanishes, all of the facet is in phase, and T is its area.
#include "verify/facet_count.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tuple>

namespace octotomy::verify {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr int reach = 6;
constexpr int reach_along_normals = 64;
constexpr std::size_t normals_followed = 32;

/// sin(pi x) / (pi x)
double sinc(double x) {
  const double turn = pi * x;
  return std::abs(turn) < 1e-6 ? 1.0 - turn * turn / 6.0 : std::sin(turn) / turn;
}

Complex phase(double turns) {
  return std::polar(1.0, -2.0 * pi * turns);
}

/// Times -i |k|^2 2 pi, as all facets of one k share that.
Complex transform(const Facet& facet, const glm::dvec3& k) {
  const double area = glm::length(facet.area);
  const glm::dvec3 normal = facet.area / area;
  const double along = glm::dot(k, normal);
  const glm::dvec3 tangent = k - along * normal;
  const double square = glm::dot(tangent, tangent);
  // Below a ten-thousandth of a turn across the facet the phase is that of any of its points; sums over sides
  // would cancel to that share of their digits.
  if (square * area < 1e-8) return along * area * phase(glm::dot(k, facet.sides.front()[0]));
  Complex sum = 0.0;
  for (const auto& [from, to] : facet.sides) {
    const glm::dvec3 side = to - from;
    sum += glm::dot(tangent, glm::cross(side, normal)) * sinc(glm::dot(k, side)) *
           phase(glm::dot(k, 0.5 * (from + to)));
  }
  return Complex(0.0, along / (2.0 * pi * square)) * sum;
}

/// One of k and -k.
glm::ivec3 half_space(const glm::ivec3& k) {
  const bool lower = k.z != 0 ? k.z < 0 : k.y != 0 ? k.y < 0 : k.x < 0;
  return lower ? -k : k;
}

/// The vectors nearest to the multiples of a normal, nine in each step along its largest component.
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
        vectors.push_back(half_space(k));
      }
  }
}

/// The vectors k of the sum, one of each pair k and -k, in order. Precondition: large facets first.
std::vector<glm::ivec3> vectors_of(const std::vector<Facet>& facets) {
  assert(std::is_sorted(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return glm::dot(a.area, a.area) > glm::dot(b.area, b.area);
  }));
  std::vector<glm::ivec3> vectors;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (x != 0 || y != 0 || z != 0) vectors.push_back(half_space({x, y, z}));
  for (std::size_t i = 0; i < std::min(facets.size(), normals_followed); ++i)
    add_along(glm::normalize(facets[i].area), vectors);
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  };
  std::sort(vectors.begin(), vectors.end(), before);
  vectors.erase(std::unique(vectors.begin(), vectors.end()), vectors.end());
  return vectors;
}

}  // namespace

double count_variance(const std::vector<Facet>& facets) {
  std::vector<Facet> flat;
  for (const Facet& facet : facets)
    if (glm::dot(facet.area, facet.area) > 0.0) flat.push_back(facet);
  if (flat.empty()) return 0.0;
  std::stable_sort(flat.begin(), flat.end(), [](const Facet& a, const Facet& b) {
    return glm::dot(a.area, a.area) > glm::dot(b.area, b.area);
  });
  const std::vector<glm::ivec3> vectors = vectors_of(flat);
  struct Sum {
    double variance = 0.0, fourths = 0.0;
  };
  const Sum seen = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, vectors.size(), 64), Sum{},
      [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const glm::dvec3 k(vectors[i]);
          const double square = glm::dot(k, k);
          Complex total = 0.0;
          for (const Facet& facet : flat) total += transform(facet, k);
          sum.variance += 2.0 * std::norm(total) / (4.0 * pi * pi * square * square);
          sum.fourths += 2.0 / (square * square);
        }
        return sum;
      },
      [](const Sum& a, const Sum& b) {
        return Sum{a.variance + b.variance, a.fourths + b.fourths};
      });
  // Of facets that were followed the rest is small. All integer vectors but zero have a sum of 1 / |k|^4 of
  // 16.5323; spread evenly over the directions of both k and -k, normals have area / (2 pi) per solid angle.
  constexpr double epstein = 16.5323;
  double others = 0.0;
  for (std::size_t i = normals_followed; i < flat.size(); ++i) others += glm::length(flat[i].area);
  return seen.variance + (epstein - seen.fourths) / (4.0 * pi * pi) * others / (2.0 * pi);
}

}  // namespace octotomy::verify
