# What makes a cold build faster.
#
# Precompiled headers: one set of external headers for each group of targets whose flags agree. Half of a cold build was
# reading them. Headers of the project are in none, so that an edit rebuilds no more than before.
option(OCTOTOMY_PCH "Precompiled headers: a faster cold build, which does not see a missing #include" OFF)

# octotomy_precompiled(GROUP [EXECUTABLES] LIBRARIES... HEADERS...): the set that octotomy_precompile() shares. Programs
# are compiled with another kind of position-independent code than libraries, so they need a set of their own.
function(octotomy_precompiled group)
  if(NOT OCTOTOMY_PCH)
    return()
  endif()
  cmake_parse_arguments(ARG "EXECUTABLES" "" "LIBRARIES;HEADERS" ${ARGN})
  set(owner octotomy_precompiled_${group})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled/${group}.cpp CONTENT "int main() {}\n")
  if(ARG_EXECUTABLES)
    add_executable(${owner} EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/precompiled/${group}.cpp)
  else()
    add_library(${owner} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/precompiled/${group}.cpp)
  endif()
  target_link_libraries(${owner} PRIVATE octotomy_options ${ARG_LIBRARIES})
  list(TRANSFORM ARG_HEADERS REPLACE "(.+)" "<\\1>")
  target_precompile_headers(${owner} PRIVATE ${ARG_HEADERS})
endfunction()

# octotomy_precompile(GROUP TARGET...)
function(octotomy_precompile group)
  if(OCTOTOMY_PCH)
    foreach(target ${ARGN})
      target_precompile_headers(${target} REUSE_FROM octotomy_precompiled_${group})
    endforeach()
  endif()
endfunction()

# Without the first, ccache sees nothing behind a precompiled header; without the second, clang's differ at every build.
if(OCTOTOMY_PCH)
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>
                      "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()

set(OCTOTOMY_STANDARD_HEADERS algorithm array bit cmath cstdint filesystem fstream functional limits map memory numbers
    numeric optional set span stdexcept stop_token string string_view unordered_map utility variant vector glm/glm.hpp
    glm/gtc/matrix_transform.hpp)

# octotomy_optimize_less(TARGET...): for what drives the kernels and does not compute itself.
function(octotomy_optimize_less)
  if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
    foreach(target ${ARGN})
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    endforeach()
  endif()
endfunction()

# Sources compiled several at once: what their headers make of templates is then made once, which halves a cold build of
# the planner and of its tests. An edit rebuilds its neighbours too, so the preset `dev` leaves it off.
option(OCTOTOMY_BATCHES "Compile several sources at once: a faster cold build, a slower rebuild" OFF)

# octotomy_batch(SIZE TARGET...): SIZE sources at once.
function(octotomy_batch size)
  if(OCTOTOMY_BATCHES)
    set_target_properties(${ARGN} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  endif()
endfunction()
