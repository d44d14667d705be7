# cmake -C .cmake/tsan.cmake -B build/tsan -G Ninja : thread sanitizer.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1 -UNDEBUG" CACHE STRING "")
set(OCTOTOMY_SANITIZE "thread" CACHE STRING "")
set(OCTOTOMY_WERROR ON CACHE BOOL "")
# TBB as installed was built without the sanitizer, which then sees races in whatever TBB hands over.
set(OCTOTOMY_PLAIN_THREADS ON CACHE BOOL "")
set(OCTOTOMY_PCH ON CACHE BOOL "")
set(OCTOTOMY_BATCHES ON CACHE BOOL "")
