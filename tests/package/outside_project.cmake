# Installs the build tree and uses it from the outside, as somebody does who has nothing but the installation.
cmake_minimum_required(VERSION 3.25)

set(prefix ${WORK_DIR}/prefix)
set(shop ${WORK_DIR}/shop)
set(other_layout ${WORK_DIR}/other_layout)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
# Nothing of the caller's shell may help the installed program to find its parts.
foreach(variable LD_LIBRARY_PATH KERVAN_SHARE KERVAN_COMPONENT_PATH CMAKE_PREFIX_PATH kervan_DIR DESTDIR)
  unset(ENV{${variable}})
endforeach()

# run(COMMAND...): shows what the command said if it fails; `output` has its standard output.
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK_DIR}
    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE complained)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "exit code ${result}: ${command}\n${said}${complained}")
  endif()
  set(output "${said}" PARENT_SCOPE)
endfunction()

function(expect what actual expected)
  if(NOT actual STREQUAL expected)
    message(FATAL_ERROR "${what} is '${actual}', not '${expected}'")
  endif()
endfunction()

function(build source folder)
  run(${CMAKE_COMMAND} -S ${source} -B ${folder} -G ${GENERATOR} -Dkervan_DIR=${prefix}/${LIBDIR}/cmake/kervan
    -DCMAKE_C_COMPILER=${C_COMPILER} -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
    -DCMAKE_BUILD_TYPE=None "-DCMAKE_C_FLAGS=${C_FLAGS}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
  run(${CMAKE_COMMAND} --build ${folder})
endfunction()

# --- The installation needs nothing of the tree it was built in.
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
file(GLOB libraries ${prefix}/${LIBDIR}/*.so)
file(GLOB_RECURSE modules ${prefix}/${LIBDIR}/kervan/*.so)
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${prefix}/bin/kervan LIBRARIES ${libraries} MODULES ${modules}
  RESOLVED_DEPENDENCIES_VAR resolved UNRESOLVED_DEPENDENCIES_VAR unresolved)
expect("the list of libraries that are not found" "${unresolved}" "")
list(FILTER resolved INCLUDE REGEX "^${BUILD_DIR}/lib/")
expect("the list of libraries found in the build tree only" "${resolved}" "")

file(GLOB_RECURSE package_files ${prefix}/${LIBDIR}/cmake/*)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(FIND "${text}" "${BUILD_DIR}" place)
  expect("the place of the build folder in ${file}" ${place} -1)
endforeach()

# --- A contract and a component of one's own.
build(${SOURCE_DIR}/shop ${shop})
run(${CMAKE_CTEST_COMMAND} --test-dir ${shop} --output-on-failure --no-tests=error)

# --- They run together with the installed ones.
set(ENV{KERVAN_COMPONENT_PATH} ${shop}/lib/kervan/components)
run(${prefix}/bin/kervan describe shop/courier --json)
string(JSON type GET "${output}" type)
expect("the described type" "${type}" "shop/courier")
run(${prefix}/bin/kervan check ${SOURCE_DIR}/shop/delivery.yaml)
run(${prefix}/bin/kervan run ${SOURCE_DIR}/shop/delivery.yaml --json)
string(REGEX MATCH "[^\n]*\n?$" line "${output}")
string(JSON result GET "${line}" result)
string(JSON reached GET "${line}" robots r1 reached)
string(JSON trace GET "${line}" trace_hash)
expect("the result of the run" "${result}" "success")
expect("whether r1 reached its goal" "${reached}" "ON")
run(${prefix}/bin/kervan run ${SOURCE_DIR}/shop/delivery.yaml --json)
string(REGEX MATCH "[^\n]*\n?$" line "${output}")
string(JSON again GET "${line}" trace_hash)
expect("the trace hash of the second run" "${again}" "${trace}")

# --- A module that was built with another layout of a contract is refused, not misread.
build(${SOURCE_DIR}/other_layout ${other_layout})
set(ENV{KERVAN_COMPONENT_PATH} ${shop}/lib/kervan/components:${other_layout}/lib/kervan/components)
foreach(verb check run)
  execute_process(COMMAND ${prefix}/bin/kervan ${verb} ${SOURCE_DIR}/other_layout/weighed_delivery.yaml
    WORKING_DIRECTORY ${WORK_DIR} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE complained)
  expect("the exit code of ${verb} with two layouts of Parcel" "${result}" 2)
  if(NOT complained MATCHES "/weighed_delivery.yaml:20:21: .*built with another layout of shop_msgs::msg::Parcel")
    message(FATAL_ERROR "${verb} with two layouts of Parcel said: ${complained}")
  endif()
endforeach()
