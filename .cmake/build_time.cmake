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

# octotomy_optimize_less(TARGET...), octotomy_optimize_sources_less(SOURCE...): for what drives the kernels or a library
# and does not compute itself. g++ stops there to collect its garbage only past 2 GiB, a twentieth of its time.
if(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")
  set(OCTOTOMY_LESS_OPTIMIZED
      $<$<CONFIG:Release>:-O1> $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:--param=ggc-min-heapsize=2097152>)
endif()
function(octotomy_optimize_less)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE ${OCTOTOMY_LESS_OPTIMIZED})
  endforeach()
endfunction()
function(octotomy_optimize_sources_less)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS ${OCTOTOMY_LESS_OPTIMIZED})
endfunction()

# Sources compiled several at once: what their headers make of templates is then made once, which halves a cold build of
# the planner and more than halves one of the tests. An edit rebuilds its neighbours too, so the preset `dev` leaves it
# off. Rooms whose loops are the product's speed are not batched: how much a compiler inlines depends on a unit's size.
option(OCTOTOMY_BATCHES "Compile several sources at once: a faster cold build, a slower rebuild" OFF)

# octotomy_batch(SIZE TARGET [ALONE SOURCES...]): SIZE sources at once, but for those whose loops count.
function(octotomy_batch size target)
  if(OCTOTOMY_BATCHES)
    cmake_parse_arguments(ARG "" "" ALONE ${ARGN})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
    set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()
