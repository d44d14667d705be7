# cmake -C .cmake/dev.cmake -B build/dev -G Ninja : asserts on, warnings are errors, no precompiled headers.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g1 -UNDEBUG" CACHE STRING "")
set(OCTOTOMY_WERROR ON CACHE BOOL "")
