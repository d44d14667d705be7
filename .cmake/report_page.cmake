# Bundles planner/result/page and writes it as a source: cmake -DESBUILD= -DPAGE= -DFOLDER= -DOUT= -P report_page.cmake
include(${CMAKE_CURRENT_LIST_DIR}/embed.cmake)
foreach(name main.ts report.css)
  execute_process(COMMAND ${ESBUILD} ${PAGE}/${name} --bundle --minify --target=es2022 --charset=utf8 --log-level=warning
                          --format=iife --outdir=${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
embed(${FOLDER}/main.js report_script arrays)
embed(${FOLDER}/report.css report_style arrays)
file(WRITE ${OUT} "// Made by .cmake/report_page.cmake of planner/result/page.
#include \"planner/result/report/drawn_page.h\"

namespace octotomy::planner {
namespace {

${arrays}
}  // namespace

std::string_view page_script() {
  return {report_script, sizeof report_script};
}
std::string_view page_style() {
  return {report_style, sizeof report_style};
}

}  // namespace octotomy::planner
")
