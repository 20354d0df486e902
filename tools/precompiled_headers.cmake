# The headers of libraries that most sources include are compiled once, for the product and once more for its tests, which
# have googletest and another optimisation. A source still includes what it uses:
# tools/lint compiles it without them. nlohmann/json is not among them: each source that loads it repeats instantiations.
include_guard()

# cartvo_precompile(target LIBRARIES... OPTIONS... HEADERS...): an object library whose precompiled headers other targets use.
function(cartvo_precompile target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "LIBRARIES;OPTIONS;HEADERS")
  add_library(${target} OBJECT ${PROJECT_SOURCE_DIR}/tools/precompiled_headers.cpp)
  target_link_libraries(${target} PRIVATE cartvo_build_flags ${ARG_LIBRARIES})
  target_compile_options(${target} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(${target} PRIVATE ${ARG_HEADERS})
endfunction()

set(headers <algorithm> <array> <atomic> <chrono> <cmath> <filesystem> <fstream> <functional> <map> <memory> <mutex> <optional>
  <random> <regex> <set> <span> <sstream> <stdexcept> <string> <thread> <vector>
  <Eigen/Dense> <fmt/format.h> <opencv2/core.hpp> <opencv2/imgcodecs.hpp> <opencv2/imgproc.hpp>)
set(libraries Eigen3::Eigen opencv_core opencv_imgproc opencv_imgcodecs fmt::fmt)
cartvo_precompile(cartvo_headers LIBRARIES ${libraries} HEADERS ${headers})
if(BUILD_TESTING)
  find_package(GTest REQUIRED)
  cartvo_precompile(cartvo_test_headers LIBRARIES ${libraries} GTest::gmock OPTIONS ${CARTVO_TEST_OPTIONS}
    HEADERS ${headers} <gtest/gtest.h> <gmock/gmock.h>)
endif()

# Gives precompiled headers to the C++ targets of a folder and of the folders below it.
function(cartvo_reuse_headers folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    get_target_property(libraries ${target} LINK_LIBRARIES)
    get_target_property(sources ${target} SOURCES)
    # Not for the renderer, which is compiled for other processors.
    if(NOT type MATCHES "LIBRARY|EXECUTABLE" OR type STREQUAL INTERFACE_LIBRARY OR NOT sources MATCHES "\\.cpp"
        OR target MATCHES "^cartvo_(test_)?headers$|^cartvo_world$")
      continue()
    endif()
    if(libraries MATCHES "GTest::")
      set(headers cartvo_test_headers)
    elseif(libraries MATCHES "cartvo_")
      set(headers cartvo_headers)
    else()
      continue()
    endif()
    target_precompile_headers(${target} REUSE_FROM ${headers})
    # The compiler takes them only with the macros and the folders with which they were compiled.
    target_include_directories(${target} SYSTEM PRIVATE ${EIGEN3_INCLUDE_DIR} ${OpenCV_INCLUDE_DIRS})
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  endforeach()
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    cartvo_reuse_headers(${subfolder})
  endforeach()
endfunction()
cartvo_reuse_headers(${PROJECT_SOURCE_DIR})
