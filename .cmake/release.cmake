# cmake -C .cmake/release.cmake -B build/release -G Ninja : what users run.
set(CMAKE_BUILD_TYPE Release CACHE STRING "")
set(OCTOTOMY_PCH ON CACHE BOOL "")
set(OCTOTOMY_BATCHES ON CACHE BOOL "")
set(OCTOTOMY_HARDEN ON CACHE BOOL "")
