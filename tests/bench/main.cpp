// SPDX-License-Identifier: AGPL-3.0-or-later
// octotomy-bench: every claim of speed is a ratio of two names of one run. `--help` is Google Benchmark's.
#include <benchmark/benchmark.h>
#include <cstring>
#include <vector>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "tests/bench/benchmarks.h"

namespace {

// The memory bandwidth of this machine at present: 256 MiB copied, counted as bytes read.
void run_memcpy(benchmark::State& state) {
  const std::vector<char> source(std::size_t{256} << 20, 1);
  std::vector<char> target(source.size());
  for (auto _ : state) {
    std::memcpy(target.data(), source.data(), source.size());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(source.size()));
}

}  // namespace

int main(int argc, char** argv) {
#if defined(__GLIBC__)
  // Freed memory is kept for later allocations, ours and the peers', as in a program that draws frame after
  // frame.
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  octotomy::bench::add("reference/memcpy", run_memcpy);
  octotomy::bench::register_boolean();
  octotomy::bench::register_build();
  octotomy::bench::register_doors();
  octotomy::bench::register_measure();
  octotomy::bench::register_mesh_boolean();
  octotomy::bench::register_move();
  octotomy::bench::register_read();
  octotomy::bench::register_render();
  octotomy::bench::register_replan();
  octotomy::bench::register_verbs();
  octotomy::bench::register_verify();
#ifdef OCTOTOMY_HAS_OPENVDB
  octotomy::bench::register_openvdb();
#endif
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
