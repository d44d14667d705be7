# Bundles planner/browser/page and writes it as a source: cmake -DESBUILD= -DBROWSER= -DFOLDER= -DOUT= -P page.cmake
include(${CMAKE_CURRENT_LIST_DIR}/embed.cmake)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
function(bundle source target)
  execute_process(COMMAND ${ESBUILD} ${source} --bundle --minify --target=es2022 --charset=utf8 --log-level=warning
                          --outfile=${FOLDER}/${target} ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
if(EXISTS ${BROWSER}/main.ts)
  bundle(${BROWSER}/main.ts app.js --format=iife)
endif()
if(EXISTS ${BROWSER}/app.css)
  bundle(${BROWSER}/app.css app.css --external:/icon.svg)
endif()
foreach(name index.html icon.svg)
  if(EXISTS ${BROWSER}/${name})
    file(COPY ${BROWSER}/${name} DESTINATION ${FOLDER})
  endif()
endforeach()
if(NOT EXISTS ${FOLDER}/index.html)
  file(WRITE ${FOLDER}/index.html "<!doctype html><title>Octotomy</title><p>This build has no page.</p>\n")
endif()

set(entries "")
set(arrays "")
set(number 0)
foreach(pair "app.js=text/javascript; charset=utf-8" "app.css=text/css; charset=utf-8"
             "index.html=text/html; charset=utf-8" "icon.svg=image/svg+xml")
  string(REGEX MATCH "^([^=]+)=(.+)$" unused "${pair}")
  set(name ${CMAKE_MATCH_1})
  set(type "${CMAKE_MATCH_2}")
  if(NOT EXISTS ${FOLDER}/${name})
    continue()
  endif()
  embed(${FOLDER}/${name} file_${number} arrays)
  file(SIZE ${FOLDER}/${name} size)
  string(APPEND entries "      {\"/${name}\", \"${type}\", {file_${number}, ${size}}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE ${OUT} "// Made by .cmake/page.cmake of planner/browser/page.
#include \"planner/browser/server/page.h\"

namespace octotomy::planner::serve {
namespace {

${arrays}
}  // namespace

const std::vector<PageFile>& page_files() {
  static const std::vector<PageFile> all{
${entries}  };
  return all;
}

}  // namespace octotomy::planner::serve
")
