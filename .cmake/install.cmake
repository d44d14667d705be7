# What `cmake --install` puts in place, in two parts: the program, and the libraries with what compiling against them
# takes. `cpack -G DEB` makes a Debian package of each.
include(CMakePackageConfigHelpers)
set(octotomy_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Octotomy)

# The program, what it starts and loads, and what shells and `man` read, as the program itself prints it.
install(TARGETS octotomy RUNTIME COMPONENT program)
install(TARGETS octotomy-tetgen octotomy-mesh3 octotomy-mesh3-labels octotomy_dicom_codec octotomy_image_io
        RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/octotomy COMPONENT program
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/octotomy COMPONENT program)
function(octotomy_install_printed destination name)
  install(CODE "
    execute_process(COMMAND $<TARGET_FILE:octotomy> ${ARGN} OUTPUT_FILE ${CMAKE_BINARY_DIR}/printed/${name} COMMAND_ERROR_IS_FATAL ANY)
    file(INSTALL ${CMAKE_BINARY_DIR}/printed/${name} DESTINATION \${CMAKE_INSTALL_PREFIX}/${destination})"
    COMPONENT program)
endfunction()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/printed)
octotomy_install_printed(${CMAKE_INSTALL_MANDIR}/man1 octotomy.1 --manual man)
octotomy_install_printed(${CMAKE_INSTALL_DATADIR}/bash-completion/completions octotomy --manual bash)
octotomy_install_printed(${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions _octotomy --manual zsh)
install(FILES ${CMAKE_SOURCE_DIR}/README.md ${CMAKE_SOURCE_DIR}/planner/le_fort_i.plan.json
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT program)

# The libraries, under the names Octotomy::voxel, Octotomy::voxel_tree and so on.
set(octotomy_libraries octotomy_options octotomy_itk octotomy_voxel octotomy_brep octotomy_convert octotomy_verify
    octotomy_planner)
foreach(folder voxel brep convert verify planner)
  get_target_property(rooms octotomy_${folder} INTERFACE_LINK_LIBRARIES)
  list(FILTER rooms INCLUDE REGEX "^octotomy_${folder}_")
  list(APPEND octotomy_libraries ${rooms})
endforeach()
foreach(library ${octotomy_libraries})
  string(REPLACE octotomy_ "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
endforeach()
install(TARGETS ${octotomy_libraries} EXPORT octotomy ARCHIVE COMPONENT development)
install(EXPORT octotomy NAMESPACE Octotomy:: FILE OctotomyTargets.cmake DESTINATION ${octotomy_package_dir}
        COMPONENT development)
configure_package_config_file(${CMAKE_SOURCE_DIR}/.cmake/OctotomyConfig.cmake.in
  ${CMAKE_BINARY_DIR}/package/OctotomyConfig.cmake INSTALL_DESTINATION ${octotomy_package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/OctotomyConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/OctotomyConfig.cmake ${CMAKE_BINARY_DIR}/package/OctotomyConfigVersion.cmake
        DESTINATION ${octotomy_package_dir} COMPONENT development)
install(FILES ${CMAKE_BINARY_DIR}/include/octotomy/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/octotomy/octotomy COMPONENT development)
install(CODE "
  set(SOURCE_DIR ${CMAKE_SOURCE_DIR})
  set(INCLUDE_DIR \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/octotomy)
  include(${CMAKE_SOURCE_DIR}/.cmake/install_headers.cmake)" COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME octotomy)
set(CPACK_PACKAGE_CONTACT "Octotomy <octotomy@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "plans an operation on a skull in two geometry kernels that check each other")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Octotomy, the program, with the meshers and codecs that it starts")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Libraries and headers of Octotomy, and its CMake package")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
if(TARGET octotomy_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Octotomy, both kernels and plans as a Python package")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-octotomy)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3-numpy, octotomy (= ${PROJECT_VERSION})")
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME octotomy)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS libcurl4)  # loaded at the first use
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liboctotomy-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libglm-dev, libtbb-dev, libzstd-dev, zlib1g-dev, libisal-dev, libexpat1-dev, liblz4-dev, libopenmesh-dev, libcgal-dev, libeigen3-dev, libinsighttoolkit5-dev, nlohmann-json3-dev, libssl-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "octotomy (= ${PROJECT_VERSION})")
include(CPack)
