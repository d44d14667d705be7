# embed(FILE NAME LIST) appends to the text in LIST a C++ array of characters NAME that holds a file's bytes.
function(embed file name list)
  file(READ ${file} hex HEX)
  # Character by character: a literal may have 65,536 of them.
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," hex "${hex}")
  string(REGEX REPLACE "(.....................................................................................................)," "\\1,\n" hex "${hex}")
  set(${list} "${${list}}const char ${name}[] = {\n${hex}};\n" PARENT_SCOPE)
endfunction()
