# cmake -C .cmake/fuzz.cmake -B build/fuzz -G Ninja && cmake --build build/fuzz --target fuzzers : libFuzzer on what
# parses, then build/fuzz/fuzz_octree_file -max_total_time=600 tests/fuzz/octree_file
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1 -UNDEBUG" CACHE STRING "")
set(OCTOTOMY_SANITIZE "address,undefined,fuzzer-no-link" CACHE STRING "")
set(OCTOTOMY_WERROR ON CACHE BOOL "")
set(OCTOTOMY_PCH ON CACHE BOOL "")
