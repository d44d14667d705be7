// SPDX-License-Identifier: AGPL-3.0-or-later
#include <benchmark/benchmark.h>
#include <functional>
#include <memory>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tests/bench/benchmarks.h"
#include "tests/bench/dense_bits.h"
#include "tests/bench/pairs.h"
#include "voxel/solid/combine.h"

namespace octotomy::bench {
namespace {

using voxel::Expression;
using voxel::Octree;
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

// A new dense result of two dense operands, computed by threads in parts of 256 KiB.
template <typename Operation>
void run_dense(benchmark::State& state, const Pair& pair, Operation operation, int side) {
  const DenseBits a = dense_bits_of(pair.first(side));
  const DenseBits b = dense_bits_of(pair.second(side));
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
    for (const Pair& pair : pairs())
      for (const int side : {256, 512}) {
        const std::string task =
            "boolean/" + std::string(name) + "/" + pair.name + "/" + std::to_string(side);
        add(task, [=, &pair, combine_two = combine_two](benchmark::State& state) {
          run(state, pair, combine_two, side);
        });
        add("reference/dense_bits/" + task,
            [=, &pair, operation = std::string(name)](benchmark::State& state) {
              run_dense(state, pair, operation, side);
            });
      }
}

}  // namespace octotomy::bench
