# The page as one file, with the kernel in it: cmake -DESBUILD= -DSOURCE= -DKERNEL= -DOUT= -P page.cmake
get_filename_component(folder ${KERNEL} DIRECTORY)
file(ARCHIVE_CREATE OUTPUT ${folder}/page_kernel.gz PATHS ${KERNEL} FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9)
execute_process(COMMAND ${ESBUILD} ${SOURCE}/page.ts --bundle --minify --target=es2022 --charset=utf8 --log-level=warning
                        --format=iife --loader:.gz=binary --alias:page_kernel.gz=${folder}/page_kernel.gz --outfile=${folder}/page.js
                COMMAND_ERROR_IS_FATAL ANY)
file(READ ${folder}/page.js script)
file(READ ${SOURCE}/index.html page)
string(REPLACE "@SCRIPT@" "${script}" page "${page}")
file(WRITE ${OUT} "${page}")
