# Puts every NAME.KIND.json of the current folder into the program: the source ${out} defines
# octotomy::planner::KIND_files(), pairs of NAME and text.
function(octotomy_json_texts kind out)
  file(GLOB files CONFIGURE_DEPENDS *.${kind}.json)
  set(entries "")
  foreach(file ${files})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    string(APPEND entries "      {\"${name}\", R\"json(${text})json\"},\n")
  endforeach()
  configure_file(${CMAKE_SOURCE_DIR}/.cmake/json_texts.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/${kind}_files.cpp @ONLY)
  set(${out} ${CMAKE_CURRENT_BINARY_DIR}/${kind}_files.cpp PARENT_SCOPE)
endfunction()
