# cmake -D FOLDER=... -D OUTPUT=... -P embed_files.cmake: writes the page's files as the C++ source of pageFiles().
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
file(GLOB files RELATIVE ${FOLDER} ${FOLDER}/*.html ${FOLDER}/*.css ${FOLDER}/*.js)
set(contents "")
set(entries "")
set(count 0)
foreach(name ${files})
  string(REGEX REPLACE ".*\\." "" extension ${name})
  file(READ ${FOLDER}/${name} content)
  set(path "/${name}")
  if(name STREQUAL "index.html")
    set(path "/")
  endif()
  string(APPEND contents "constexpr std::string_view kFile${count} = R\"page(${content})page\";\n")
  string(APPEND entries "    PageFile{\"${path}\", \"${type_${extension}}\", kFile${count}},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(WRITE ${OUTPUT} "// Generated from daemon/page/web by embed_files.cmake.
#include \"daemon/page/page_files.hpp\"

#include <array>

namespace cartvo::daemon {
namespace {

${contents}
constexpr std::array kFiles{
${entries}};

}  // namespace

std::span<const PageFile> pageFiles() {
  return kFiles;
}

}  // namespace cartvo::daemon
")
