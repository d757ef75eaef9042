# kervan_component(<area/name> SOURCES <file>... [LIBRARIES <target>...] [NO_INSTALL])
#
# Builds one component as a module that the container loads by its type, "control/vff": the file
# <area>/<name>.so below lib/kervan/components. Outside of Kervan's own tree, point KERVAN_COMPONENT_PATH at the folder
# that holds it: ${CMAKE_BINARY_DIR}/lib/kervan/components unless CMAKE_LIBRARY_OUTPUT_DIRECTORY says otherwise.
include_guard(GLOBAL)
include(GNUInstallDirs)

function(kervan_component type)
  cmake_parse_arguments(PARSE_ARGV 1 arg "NO_INSTALL" "" "SOURCES;LIBRARIES")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
    message(FATAL_ERROR "kervan_component(${type}): wanted SOURCES <file>... [LIBRARIES <target>...]")
  endif()
  if(NOT type MATCHES "^([a-z0-9_]+)/([a-z0-9_]+)$")
    message(FATAL_ERROR "kervan_component(${type}): a type is <area>/<name> in lower case, like control/vff")
  endif()
  set(area ${CMAKE_MATCH_1})
  set(name ${CMAKE_MATCH_2})
  set(folder ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
  if(NOT folder)
    set(folder ${CMAKE_BINARY_DIR}/lib)
  endif()

  set(target ${area}_${name}_component)
  add_library(${target} MODULE ${arg_SOURCES})
  target_link_libraries(${target} PRIVATE kervan::framework ${arg_LIBRARIES})
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  set_target_properties(${target} PROPERTIES
    PREFIX ""
    OUTPUT_NAME ${name}
    LIBRARY_OUTPUT_DIRECTORY ${folder}/kervan/components/${area}
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON
    INSTALL_RPATH "$ORIGIN/../../..")
  set_property(GLOBAL APPEND PROPERTY KERVAN_COMPONENT_TARGETS ${target})
  if(PROJECT_NAME STREQUAL kervan AND NOT arg_NO_INSTALL)
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/kervan/components/${area})
  endif()
endfunction()
