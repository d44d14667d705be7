// SPDX-License-Identifier: AGPL-3.0-or-later
// The same work in OpenVDB: topology operations on mask grids with the operands kept, and GridTransformer.
#include <string>
#include <utility>

#include "tests/bench/benchmarks.h"
#include "tests/bench/dense_bits.h"
#include "tests/bench/openvdb_peer.h"
#include "tests/bench/pairs.h"
#include "tests/bench/subjects.h"

namespace octotomy::bench {
namespace {

void run_boolean(benchmark::State& state, const Pair& pair, int side, OpenVdbPeer::Operation operation) {
  const OpenVdbPeer a(side, dense_bits_of(pair.first(side)).words);
  const OpenVdbPeer b(side, dense_bits_of(pair.second(side)).words);
  for (auto _ : state) benchmark::DoNotOptimize(a.combine(operation, b, false));
  state.counters["voxels"] = static_cast<double>(a.combine(operation, b, true));
  state.counters["bytes"] = static_cast<double>(a.bytes());
  state.counters["octotomy_bytes"] = static_cast<double>(voxel::bytes_memory(pair.first(side)));
}

void run_rotation(benchmark::State& state, int side) {
  const OpenVdbPeer still(side, dense_bits_of(skull(side)).words);
  const glm::dmat4 lps_from_voxel = universe(side).lps_from_voxel;
  const glm::dmat4 matrix = glm::inverse(lps_from_voxel) * moved_from_still(rotation()) * lps_from_voxel;
  std::array<double, 16> target_from_source;
  for (int i = 0; i < 16; ++i) target_from_source[static_cast<std::size_t>(i)] = matrix[i / 4][i % 4];
  for (auto _ : state) benchmark::DoNotOptimize(still.transform(target_from_source, false));
  state.counters["voxels"] = static_cast<double>(still.transform(target_from_source, true));
}

}  // namespace

void register_openvdb() {
  const std::pair<const char*, OpenVdbPeer::Operation> operations[] = {
      {"union", OpenVdbPeer::Operation::Union},
      {"intersection", OpenVdbPeer::Operation::Intersection},
      {"difference", OpenVdbPeer::Operation::Difference},
  };
  for (const auto& [name, operation] : operations)
    for (const Pair& pair : pairs())
      for (const int side : {256, 512})
        add("peer/openvdb/boolean/" + std::string(name) + "/" + pair.name + "/" + std::to_string(side),
            [=, &pair, operation = operation](benchmark::State& state) {
              run_boolean(state, pair, side, operation);
            });
  for (const int side : {256, 512})
    add("peer/openvdb/move/rotate/skull/" + std::to_string(side),
        [=](benchmark::State& state) { run_rotation(state, side); });
}

}  // namespace octotomy::bench
