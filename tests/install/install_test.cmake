# Installs into a folder of its own, runs what is installed from there, and builds and runs the example against it.
# Set BINARY_DIR, SOURCE_DIR, CXX.
set(root ${BINARY_DIR}/install_test)
file(REMOVE_RECURSE ${root})
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()
foreach(component program development)
  run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${root}/usr --component ${component})
endforeach()
file(MAKE_DIRECTORY ${root}/example)
# By what lies beside it alone: the tetrahedra are a helper's, the picture is a module's.
run(${root}/usr/bin/octotomy phantom sphere --radius 10 -o ${root}/ball.octree)
run(${root}/usr/bin/octotomy mesh ${root}/ball.octree --surface cuberille -o ${root}/ball.stl)
run(${root}/usr/bin/octotomy tet ${root}/ball.stl -o ${root}/ball.vtu)
run(${root}/usr/bin/octotomy render ${root}/ball.octree -o ${root}/ball.png)
run(bash -n ${root}/usr/share/bash-completion/completions/octotomy)
run(grep -q "^\\.TH OCTOTOMY 1" ${root}/usr/share/man/man1/octotomy.1)
# An example as of somebody else; a helper is named by the setting, since the program lies elsewhere.
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${root}/example -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_PREFIX_PATH=${root}/usr -DCMAKE_BUILD_TYPE=Debug)
run(${CMAKE_COMMAND} --build ${root}/example)
run(${root}/example/tree_example ${root}/ball.octree)
run(${CMAKE_COMMAND} -E env OCTOTOMY_HELPERS=${root}/usr/libexec/octotomy ${root}/example/box_example)
execute_process(COMMAND ldd ${root}/example/tree_example OUTPUT_VARIABLE linked COMMAND_ERROR_IS_FATAL ANY)
if(linked MATCHES "ITK|gdcm|OpenMesh|gmp|OpenImageIO")
  message(FATAL_ERROR "the tree alone links:\n${linked}")
endif()
# The twin: without the setting nothing is found.
execute_process(COMMAND ${CMAKE_COMMAND} -E env OCTOTOMY_HELPERS=/nowhere ${root}/example/box_example RESULT_VARIABLE status
                ERROR_VARIABLE words)
if(status EQUAL 0 OR NOT words MATCHES "OCTOTOMY_HELPERS")
  message(FATAL_ERROR "a helper that is not there was found: ${words}")
endif()
