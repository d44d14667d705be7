# cmake -C .cmake/asan.cmake -B build/asan -G Ninja : address and undefined-behaviour sanitizers.
# clang, because one corefinement unit takes g++ 254 s and 3.8 GB with sanitizers and clang a quarter of that.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_C_COMPILER clang CACHE STRING "")
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1 -UNDEBUG" CACHE STRING "")
set(OCTOTOMY_SANITIZE "address,undefined" CACHE STRING "")
set(OCTOTOMY_WERROR ON CACHE BOOL "")
set(OCTOTOMY_PCH ON CACHE BOOL "")
set(OCTOTOMY_BATCHES ON CACHE BOOL "")
