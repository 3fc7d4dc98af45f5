# cmake -DOUT=FILE -DROOT=DIR "-DFILES=a;b" -P source_versions.cmake: a line {"path", "hash"}, for
# every file, paths from ROOT.
set(text "")
foreach(file IN LISTS FILES)
  file(SHA256 ${ROOT}/${file} hash)
  string(APPEND text "{\"${file}\", \"${hash}\"},\n")
endforeach()
file(WRITE ${OUT} "${text}")
