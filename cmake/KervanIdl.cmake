# kervan_idl(<package> FILES <pkg/msg/A.idl>... [BASE_DIR <dir>] [DEPENDS <package>...] [EXPORT <export set>])
#
# Makes one shared library of an IDL package: target <package>_kervan, alias kervan::<package>, file
# lib<package>_kervan.so. It holds idlc's C descriptors and our C++ value types with their TypeSupport; link it and
#
#   #include "<package>/msg/A.hpp"          // struct <package>::msg::A
#   #include "<package>/all_types.hpp"      // every type of the package: AllTypes, all_type_supports()
#
# FILES     the IDL files, in ROS 2 layout below BASE_DIR: <package>/msg/<Name>.idl, one type a file
# BASE_DIR  the folder that #include paths begin at; default: the current source folder
# DEPENDS   other packages made by kervan_idl(), of this project or an installed one, whose types are used
# EXPORT    install library, headers and IDL files, the library as part of this export set
#
# Everything is generated in the build folder. What the generator refuses stops the build at file:line:column.
#
# Whoever includes this file sets
#   KERVAN_IDL_GENERATOR    the idlc back end: a target, or the path of its module
#   KERVAN_IDL_INCLUDE_DIR  the folder with the IDL files of Kervan's own packages
# and provides the target kervan::cdr.

include_guard(GLOBAL)
include(GNUInstallDirs)

function(kervan_idl package)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "BASE_DIR;EXPORT" "FILES;DEPENDS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "kervan_idl(${package}): unknown argument ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT arg_FILES)
    message(FATAL_ERROR "kervan_idl(${package}): FILES is missing; name at least one ${package}/msg/<Name>.idl")
  endif()
  if(NOT KERVAN_IDL_GENERATOR OR NOT KERVAN_IDL_INCLUDE_DIR)
    message(FATAL_ERROR "kervan_idl(${package}): KERVAN_IDL_GENERATOR and KERVAN_IDL_INCLUDE_DIR must be set")
  endif()
  if(NOT arg_BASE_DIR)
    set(arg_BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  cmake_path(ABSOLUTE_PATH arg_BASE_DIR NORMALIZE)

  if(NOT TARGET CycloneDDS::ddsc)
    find_package(CycloneDDS REQUIRED)
  endif()
  find_program(KERVAN_IDLC idlc REQUIRED DOC "The IDL compiler of Cyclone DDS, package cyclonedds-tools")
  if(TARGET "${KERVAN_IDL_GENERATOR}")
    set(generator "$<TARGET_FILE:${KERVAN_IDL_GENERATOR}>")
  else()
    set(generator "${KERVAN_IDL_GENERATOR}")
  endif()
  set(compile "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/KervanIdlCompile.cmake")

  # A package of this project may be based elsewhere; installed ones are all in KERVAN_IDL_INCLUDE_DIR.
  set(target ${package}_kervan)
  set(libraries "")
  set(include_dirs "${arg_BASE_DIR}")
  foreach(other IN LISTS arg_DEPENDS)
    list(APPEND libraries kervan::${other})
    if(TARGET ${other}_kervan)
      get_target_property(dir ${other}_kervan KERVAN_IDL_BASE_DIR)
      list(APPEND include_dirs "${dir}")
    endif()
  endforeach()
  list(APPEND include_dirs "${KERVAN_IDL_INCLUDE_DIR}")
  list(REMOVE_DUPLICATES include_dirs)
  list(TRANSFORM include_dirs PREPEND "-I" OUTPUT_VARIABLE include_options)

  # Of idlc's warnings two are about what our generator refuses or our reader checks.
  set(options -f case-sensitive -Wno-implicit-extensibility -Wno-enum-consecutive ${include_options}
      -b "${arg_BASE_DIR}")

  set(output_dir "${CMAKE_CURRENT_BINARY_DIR}/${package}_idl")
  set(generated_sources "")
  set(generated_headers "")
  set(type_names "")
  foreach(file IN LISTS arg_FILES)
    cmake_path(ABSOLUTE_PATH file NORMALIZE OUTPUT_VARIABLE path)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY "${arg_BASE_DIR}" OUTPUT_VARIABLE relative)
    if(NOT relative MATCHES "^(${package}/[A-Za-z0-9_]+/[A-Za-z0-9_]+)\\.idl$")
      message(FATAL_ERROR "kervan_idl(${package}): ${file} is not <BASE_DIR>/${package}/msg/<Name>.idl; "
                          "BASE_DIR is ${arg_BASE_DIR}")
    endif()
    set(name "${CMAKE_MATCH_1}")
    set(output "${output_dir}/${name}")
    add_custom_command(
      OUTPUT "${output}.hpp" "${output}.cpp" "${output}.h" "${output}.c"
      COMMAND ${CMAKE_COMMAND} "-DFILE=${path}" "-DIDLC=${KERVAN_IDLC}" "-DGENERATOR=${generator}"
              "-DOPTIONS=${options}" "-DOUTPUT_DIR=${output_dir}" "-DOUTPUT=${output}" -P "${compile}"
      DEPENDS "${path}" "${generator}" "${compile}"
      DEPFILE "${output}.d"
      COMMENT "IDL ${relative}"
      VERBATIM)
    list(APPEND generated_sources "${output}.cpp" "${output}.c")
    list(APPEND generated_headers "${output}.hpp")
    list(APPEND type_names "${name}")
  endforeach()

  _kervan_idl_all_types(${package} "${output_dir}" "${type_names}")
  list(APPEND generated_sources "${output_dir}/${package}/all_types.cpp")
  list(APPEND generated_headers "${output_dir}/${package}/all_types.hpp")

  add_library(${target} SHARED)
  add_library(kervan::${package} ALIAS ${target})
  target_sources(${target}
    PRIVATE ${generated_sources}
    PUBLIC FILE_SET HEADERS BASE_DIRS "${output_dir}" FILES ${generated_headers})
  target_compile_features(${target} PUBLIC cxx_std_20)
  # The descriptors are idlc's C code, so ddsc's headers are needed to build the package, but not to use it.
  target_link_libraries(${target} PUBLIC kervan::cdr ${libraries} PRIVATE CycloneDDS::ddsc)
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${package}
    KERVAN_IDL_BASE_DIR "${arg_BASE_DIR}"
    C_VISIBILITY_PRESET default
    CXX_VISIBILITY_PRESET default
    VISIBILITY_INLINES_HIDDEN OFF)

  if(arg_EXPORT)
    install(TARGETS ${target} EXPORT ${arg_EXPORT}
      LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
      FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kervan)
    # idlc's C headers are for packages that include this one's IDL; nobody else needs them.
    foreach(name IN LISTS type_names)
      cmake_path(GET name PARENT_PATH folder)
      install(FILES "${output_dir}/${name}.h" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kervan/${folder})
      install(FILES "${arg_BASE_DIR}/${name}.idl" DESTINATION ${CMAKE_INSTALL_DATADIR}/kervan/idl/${folder})
    endforeach()
  endif()
endfunction()

# Writes <package>/all_types.hpp and .cpp, from which a registry or a test gets every type without naming one.
# A file holds one struct of its own name; other structs in it are reached through that one.
function(_kervan_idl_all_types package output_dir type_names)
  set(includes "")
  set(types "")
  set(supports "")
  set(separator "")
  foreach(name IN LISTS type_names)
    string(REPLACE "/" "::" type "${name}")
    string(APPEND includes "#include \"${name}.hpp\"\n")
    string(APPEND types "${separator}\n    ::${type}")
    string(APPEND supports "${separator}\n      &::kervan::type_support<::${type}>()")
    set(separator ",")
  endforeach()
  file(CONFIGURE OUTPUT "${output_dir}/${package}/all_types.hpp" @ONLY CONTENT
[=[// Generated from the file list of kervan_idl(@package@); do not edit.
#pragma once

#include <vector>

#include "framework/dds/message.hpp"
@includes@
namespace @package@ {

using AllTypes = ::kervan::TypeList<@types@>;

/// The TypeSupport of every type above, in the same order.
[[gnu::visibility("default")]] std::vector<const ::kervan::TypeSupport*> all_type_supports();

}  // namespace @package@
]=])
  file(CONFIGURE OUTPUT "${output_dir}/${package}/all_types.cpp" @ONLY CONTENT
[=[// Generated from the file list of kervan_idl(@package@); do not edit.
#include "@package@/all_types.hpp"

namespace @package@ {

std::vector<const ::kervan::TypeSupport*> all_type_supports() {
  return {@supports@};
}

}  // namespace @package@
]=])
endfunction()
