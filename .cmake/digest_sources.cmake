# Run by the build: writes OUTPUT from TEMPLATE with the digest of BUILT_BY and of the files that SOURCES lists.
file(STRINGS ${SOURCES} sources)
set(digests "${BUILT_BY}")
foreach(source ${sources})
  file(SHA256 ${source} digest)
  string(APPEND digests " ${source} ${digest}")
endforeach()
string(SHA256 OCTOTOMY_BUILD "${digests}")
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
