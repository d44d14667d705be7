// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <benchmark/benchmark.h>
#include <string>

namespace octotomy::bench {

/// Adds a benchmark. Read its wall-clock time, `real_time`, because the processor time covers only one
/// thread.
template <typename Run>
void add(const std::string& name, const Run& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMicrosecond);
}

void register_boolean();
void register_build();
void register_doors();
void register_measure();
void register_mesh_boolean();
void register_move();
void register_read();
void register_render();
void register_replan();   ///< a plan whose last motion changes
void register_verbs();    ///< whole verbs of the program beside
void register_verify();   ///< what certificates reckon
void register_openvdb();  ///< peers; defined where OpenVDB is installed

}  // namespace octotomy::bench
