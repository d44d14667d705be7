// SPDX-License-Identifier: AGPL-3.0-or-later
// What certificates reckon besides comparing. Reference: the same sum as its definition says it, with a sine
// and a cosine for each side and vector; `ratio` is how many times ours that takes.
#include <chrono>
#include <cmath>
#include <complex>
#include <glm/glm.hpp>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

#include "tests/bench/benchmarks.h"
#include "verify/certificate/facet_count.h"

namespace octotomy::bench {
namespace {

using std::numbers::pi;
using verify::Facet;

/// Stars of 60 sides in planes of every direction, like the ends of scan windows at a scan's border; large
/// ones first.
std::vector<Facet> stars(int count) {
  std::vector<Facet> facets;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, turn = 2.0 * pi * i / std::numbers::phi;
    const double level = std::sqrt(1.0 - z * z), size = 20.0 - 10.0 * i / count;
    const glm::dvec3 normal(level * std::cos(turn), level * std::sin(turn), z);
    const glm::dvec3 u = glm::normalize(glm::cross(normal, glm::dvec3(0.31, 0.59, 0.75)));
    const glm::dvec3 v = glm::cross(normal, u), middle = 200.0 + 100.0 * normal;
    std::vector<glm::dvec3> rim;
    for (int corner = 0; corner < 60; ++corner) {
      const double angle = pi * corner / 30.0, radius = corner % 2 == 0 ? size : 0.9 * size;
      rim.push_back(middle + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    Facet& facet = facets.emplace_back();
    for (std::size_t corner = 0; corner < rim.size(); ++corner) {
      const glm::dvec3& next = rim[(corner + 1) % rim.size()];
      facet.sides.push_back({rim[corner], next});
      facet.area += 0.5 * glm::cross(rim[corner] - middle, next - middle);
    }
  }
  return facets;
}

/// The time in seconds of the sum by its definition.
double plain_seconds(const std::vector<Facet>& facets) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<glm::ivec3> vectors = verify::count_vectors(facets);
  std::vector<double> squares(vectors.size());
  tbb::parallel_for(std::size_t{0}, vectors.size(), [&](std::size_t n) {
    const glm::dvec3 k(vectors[n]);
    std::complex<double> total = 0.0;
    for (const Facet& facet : facets) {
      const glm::dvec3 normal = glm::normalize(facet.area);
      const double along = glm::dot(k, normal);
      const glm::dvec3 tangent = k - along * normal;
      std::complex<double> sum = 0.0;
      for (const auto& [from, to] : facet.sides) {
        const double half = pi * glm::dot(k, to - from);
        sum += glm::dot(tangent, glm::cross(to - from, normal)) *
               (std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half) *
               std::polar(1.0, -pi * glm::dot(k, from + to));
      }
      total += along / glm::dot(tangent, tangent) * sum;
    }
    squares[n] = std::norm(total);
  });
  benchmark::DoNotOptimize(squares.data());
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void count_variance(benchmark::State& state) {
  const std::vector<Facet> facets = stars(64);
  double ours = 0.0, plain = 0.0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(verify::count_variance(facets));
    ours += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    state.PauseTiming();
    plain += plain_seconds(facets);
    state.ResumeTiming();
  }
  state.counters["ratio"] = plain / ours;
}

}  // namespace

void register_verify() {
  add("verify/count_variance/64x60", count_variance);
}

}  // namespace octotomy::bench
