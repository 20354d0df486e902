# cmake -D FOLDER=... -D HELP=FILE.md -D OUTPUT=... -P embed_files.cmake: writes the page's files, and the text of its help,
# as the C++ source of pageFiles().
set(type_html "text/html; charset=utf-8")
set(type_css "text/css; charset=utf-8")
set(type_js "text/javascript; charset=utf-8")
set(type_md "text/plain; charset=utf-8")
file(GLOB files ${FOLDER}/*.html ${FOLDER}/*.css ${FOLDER}/*.js)
set(contents "")
set(entries "")
set(count 0)
foreach(file ${files} ${HELP})
  get_filename_component(name ${file} NAME)
  string(REGEX REPLACE ".*\\." "" extension ${name})
  file(READ ${file} content)
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
