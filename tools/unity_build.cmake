# With CARTVO_UNITY: compiles several sources of a target as one. The compiler reads the headers of libraries once for all of
# them, and instantiates their templates once. In such a source, GCC warns of types in unnamed namespaces as if they were
# in headers.
target_compile_options(cartvo_build_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)

# The C++ sources of this project in the targets of a folder and the folders below it, one line for each target.
function(cartvo_list_sources folder result)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  set(lines "")
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(NOT type MATCHES "LIBRARY|EXECUTABLE" OR type STREQUAL INTERFACE_LIBRARY)
      continue()
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${target} SOURCES)
    get_target_property(source_dir ${target} SOURCE_DIR)
    set(line ${target})
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${source_dir} NORMALIZE)
      cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${source} is_generated)
      if(source MATCHES "\\.cpp$" AND NOT is_generated)
        list(APPEND line ${source})
        set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
      endif()
    endforeach()
    string(APPEND lines "${line}\n")
  endforeach()
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    cartvo_list_sources(${subfolder} below)
    string(APPEND lines "${below}")
  endforeach()
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()

set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/tools/unity_groups.py ${PROJECT_SOURCE_DIR}/tools/source_names.py)
cartvo_list_sources(${PROJECT_SOURCE_DIR} lines)
file(WRITE ${PROJECT_BINARY_DIR}/unity_sources.txt "${lines}")
find_package(Python3 REQUIRED COMPONENTS Interpreter)
execute_process(
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/unity_groups.py
    ${PROJECT_BINARY_DIR}/unity_sources.txt ${PROJECT_BINARY_DIR}/unity_groups.cmake
  COMMAND_ERROR_IS_FATAL ANY)
include(${PROJECT_BINARY_DIR}/unity_groups.cmake)
