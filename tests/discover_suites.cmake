# cmake -D PROGRAM=... -D EMULATOR=... -D PREFIX=... -D SEPARATE=... -D TESTS_FILE=... -P discover_suites.cmake: after the
# build of a test program, writes the CTest entries of its tests to TESTS_FILE. One entry runs all tests of a suite, in one process: a program
# that links OpenCV loads 250 libraries, which takes 0.3 s of the processor at each start. Tests that the patterns SEPARATE
# name (divided by colons) have an entry each, with the label `measuring`.
cmake_minimum_required(VERSION 3.25)

# An entry that skipped a test and failed none ends its output with the list of the skipped ones.
set(skipped "\\[  SKIPPED \\] [^\n]*\n+$")

# The names of the program's tests that `filter` selects, as SUITE.TEST.
function(list_tests filter result)
  execute_process(COMMAND ${EMULATOR} ${PROGRAM} --gtest_list_tests --gtest_filter=${filter}
    OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY TIMEOUT 120)
  set(tests "")
  string(REGEX REPLACE "[ ]*#[^\n]*" "" output "${output}")  # values of parameters
  string(REPLACE "\n" ";" lines "${output}")
  foreach(line IN LISTS lines)
    if(line MATCHES "^  (.+)$")
      list(APPEND tests "${suite}${CMAKE_MATCH_1}")
    elseif(line MATCHES "^[A-Za-z0-9_/]+\\.$")
      set(suite "${line}")
    endif()
  endforeach()
  set(${result} "${tests}" PARENT_SCOPE)
endfunction()

# Adds an entry to `script`.
function(add_entry name filter more)
  set(command ${EMULATOR} ${PROGRAM} --gtest_filter=${filter})
  list(JOIN command "]=] [=[" command)
  # The timeout ends stalled tests. The longest suite takes 260 s on a busy machine.
  string(APPEND script "add_test([=[${PREFIX}.${name}]=] [=[${command}]=])\n"
    "set_tests_properties([=[${PREFIX}.${name}]=] PROPERTIES TIMEOUT 1800 SKIP_REGULAR_EXPRESSION [=[${skipped}]=]${more})\n")
  set(script "${script}" PARENT_SCOPE)
endfunction()

set(script "")
list_tests("*-${SEPARATE}" tests)
list(TRANSFORM tests REPLACE "\\.[^.]*$" "" OUTPUT_VARIABLE suites)
list(REMOVE_DUPLICATES suites)
foreach(suite IN LISTS suites)
  add_entry("${suite}" "${suite}.*-${SEPARATE}" "")
endforeach()
if(SEPARATE)
  list_tests("${SEPARATE}" separate)
  foreach(test IN LISTS separate)
    add_entry("${test}" "${test}" " LABELS measuring")
  endforeach()
endif()
file(WRITE ${TESTS_FILE} "${script}")
