// SPDX-License-Identifier: AGPL-3.0-or-later
#include <benchmark/benchmark.h>
#include <functional>
#include <memory>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tests/bench/benchmarks.h"
#include "tests/bench/dense_bits.h"
#include "tests/bench/subjects.h"
#include "voxel/combine.h"

namespace octotomy::bench {
namespace {

using voxel::Expression;
using voxel::Octree;

struct Pair {
  const char* name;
  const Octree& (*first)(int side);
  Expression (*second)(int side);
};

Octree evaluated(const Expression& expression, int side) {
  return voxel::combine(universe(side), expression);
}

// A static octree a side, built on first use: operands stay alive from one benchmark to the next.
template <Octree (*make)(int)>
const Octree& kept(int side) {
  static Octree at_256 = make(256);
  if (side == 256) return at_256;
  static Octree at_512 = make(512);
  return at_512;
}

Octree left_sphere(int side) {
  return evaluated(sphere(side, -0.06), side);
}
Octree right_sphere(int side) {
  return evaluated(sphere(side, 0.06), side);
}
Octree box(int side) {
  return evaluated(face_box(side), side);
}
Octree half_space(int side) {
  return evaluated(oblique_half_space(side), side);
}

const Pair pairs[] = {
    {"spheres", kept<left_sphere>, [](int side) { return Expression(kept<right_sphere>(side)); }},
    {"sphere_chequer", kept<left_sphere>, [](int side) { return Expression(kept<chequered_sphere>(side)); }},
    {"skull_box", kept<skull>, [](int side) { return Expression(kept<box>(side)); }},
    {"skull_halfspace", kept<skull>, [](int side) { return Expression(kept<half_space>(side)); }},
};

using Operator = Expression (*)(const Expression&, const Expression&);

void run(benchmark::State& state, const Pair& pair, Operator combine_two, int side) {
  const Octree& first = pair.first(side);
  const Expression expression = combine_two(first, pair.second(side));
  std::uint64_t voxels = 0;
  for (auto _ : state) {
    const Octree result = voxel::combine(first.universe(), expression);
    voxels = result.voxel_count();
    benchmark::DoNotOptimize(voxels);
  }
  state.counters["voxels"] = static_cast<double>(voxels);
}

// A new dense result of two dense operands, by threads over whole pages.
template <typename Operation>
void run_dense(benchmark::State& state, const Pair& pair, Operation operation, int side) {
  const DenseBits a = dense_bits_of(pair.first(side));
  const DenseBits b = dense_bits_of(evaluated(pair.second(side), side));
  for (auto _ : state) {
    const std::unique_ptr<std::uint64_t[]> result(new std::uint64_t[a.words.size()]);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, a.words.size(), 1 << 15), [&](const auto& part) {
      for (std::size_t i = part.begin(); i < part.end(); ++i) result[i] = operation(a.words[i], b.words[i]);
    });
    benchmark::DoNotOptimize(result.get());
    benchmark::ClobberMemory();
  }
}

void run_dense(benchmark::State& state, const Pair& pair, const std::string& name, int side) {
  if (name == "union") return run_dense(state, pair, std::bit_or<>(), side);
  if (name == "intersection") return run_dense(state, pair, std::bit_and<>(), side);
  run_dense(
      state, pair, [](std::uint64_t a, std::uint64_t b) { return a & ~b; }, side);
}

}  // namespace

void register_boolean() {
  const std::pair<const char*, Operator> operators[] = {
      {"union", [](const Expression& a, const Expression& b) { return a | b; }},
      {"intersection", [](const Expression& a, const Expression& b) { return a & b; }},
      {"difference", [](const Expression& a, const Expression& b) { return a - b; }},
  };
  for (const auto& [name, combine_two] : operators)
    for (const Pair& pair : pairs)
      for (const int side : {256, 512}) {
        const std::string task =
            "boolean/" + std::string(name) + "/" + pair.name + "/" + std::to_string(side);
        add(task, [=, &pair](benchmark::State& state) { run(state, pair, combine_two, side); });
        add("reference/dense_bits/" + task,
            [=, &pair, operation = std::string(name)](benchmark::State& state) {
              run_dense(state, pair, operation, side);
            });
      }
}

}  // namespace octotomy::bench
