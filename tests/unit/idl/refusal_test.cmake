# cmake -DFILE=<file.idl> -DBASE_DIR=<dir> -DIDLC=<idlc> -DGENERATOR=<back end> -DCOMPILE=<KervanIdlCompile.cmake>
#       -DOUTPUT_DIR=<dir> -P refusal_test.cmake
#
# Compiles an IDL file that must be refused with exactly the errors that its comments `// expect line:column: error: ...`
# say, in that order, and must leave nothing behind.

cmake_minimum_required(VERSION 3.25)

cmake_path(RELATIVE_PATH FILE BASE_DIRECTORY "${BASE_DIR}" OUTPUT_VARIABLE relative)
string(REGEX REPLACE "\\.idl$" "" name "${relative}")
set(output "${OUTPUT_DIR}/${name}")
file(REMOVE_RECURSE "${OUTPUT_DIR}")
file(MAKE_DIRECTORY "${OUTPUT_DIR}")

execute_process(
  COMMAND ${CMAKE_COMMAND} "-DFILE=${FILE}" "-DIDLC=${IDLC}" "-DGENERATOR=${GENERATOR}" "-DOUTPUT_DIR=${OUTPUT_DIR}"
          "-DOPTIONS=-f;case-sensitive;-Wno-implicit-extensibility;-Wno-enum-consecutive;-b;${BASE_DIR}"
          "-DOUTPUT=${output}" -P "${COMPILE}"
  RESULT_VARIABLE result ERROR_VARIABLE said OUTPUT_QUIET)

# Lists are avoided for the sake of the ; [ and ] in the messages.
string(REGEX MATCHALL "[^\n]*:[0-9]+:[0-9]+: [^\n]*" lines "${said}")
string(REPLACE "${FILE}:" "" lines "${lines}")
file(READ "${FILE}" text)
string(REGEX MATCHALL "// expect [^\n]*" expected "${text}")
string(REPLACE "// expect " "" expected "${expected}")

if(result EQUAL 0)
  message(FATAL_ERROR "was accepted; expected:\n${expected}")
endif()
if(NOT lines STREQUAL expected)
  message(FATAL_ERROR "expected:\n${expected}\nbut got:\n${lines}\nfrom:\n${said}")
endif()
file(GLOB_RECURSE left LIST_DIRECTORIES FALSE "${OUTPUT_DIR}/*")
if(left)
  message(FATAL_ERROR "left behind: ${left}")
endif()
