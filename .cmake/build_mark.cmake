# A mark in the program and in each part that it starts or loads: the digest of all sources that they are built of.
# Written anew whenever a source changes, so that parts of two builds never carry the same mark.
file(GLOB_RECURSE octotomy_marked RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS
     voxel/* brep/* convert/* verify/* planner/*)
list(PREPEND octotomy_marked CMakeLists.txt)
list(TRANSFORM octotomy_marked PREPEND ${CMAKE_SOURCE_DIR}/ OUTPUT_VARIABLE octotomy_marked_files)
list(JOIN octotomy_marked "\n" octotomy_marked_lines)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/build_mark.txt CONTENT "${octotomy_marked_lines}")
add_custom_command(
  OUTPUT ${CMAKE_BINARY_DIR}/build_mark.cpp
  COMMAND ${CMAKE_COMMAND} -D SOURCES=${CMAKE_BINARY_DIR}/build_mark.txt
          "-DBUILT_BY=${PROJECT_VERSION} ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          -D TEMPLATE=${CMAKE_SOURCE_DIR}/.cmake/build_mark.cpp.in -D OUTPUT=${CMAKE_BINARY_DIR}/build_mark.cpp
          -P ${CMAKE_SOURCE_DIR}/.cmake/digest_sources.cmake
  DEPENDS ${octotomy_marked_files} ${CMAKE_BINARY_DIR}/build_mark.txt ${CMAKE_SOURCE_DIR}/.cmake/build_mark.cpp.in
          ${CMAKE_SOURCE_DIR}/.cmake/digest_sources.cmake
  WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
  COMMENT "Marking the build"
  VERBATIM)
add_library(octotomy_build_mark OBJECT ${CMAKE_BINARY_DIR}/build_mark.cpp)
set_target_properties(octotomy_build_mark PROPERTIES POSITION_INDEPENDENT_CODE ON)
foreach(part octotomy octotomy-tetgen octotomy-mesh3 octotomy-mesh3-labels octotomy_dicom_codec octotomy_image_io)
  target_sources(${part} PRIVATE $<TARGET_OBJECTS:octotomy_build_mark>)
endforeach()
