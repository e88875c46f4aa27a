# One list of the programs that a user starts or the program `chladni` starts itself. The build
# target `programs`, `chladni doctor`, the install tree and the tests are made from it.

add_custom_target(programs)  # what ./chladni builds before it runs a verb

# The build tree is laid out as the install tree is: the Python module looks for workers there.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/libexec)
file(CREATE_LINK ../bin ${PROJECT_BINARY_DIR}/libexec/chladni SYMBOLIC)

# add_worker(name "what it serves" [CONFINED] [COMPONENT component]): an executable that the others
# start. One that runs CONFINED (host/confinement.h) is tried so by `chladni doctor`. It is built by
# `programs` and installed where host/worker.cpp looks for it. One of another component than
# `programs` is in a Debian package of its own, chladni-<component>, and may be missing.
function(add_worker name serves)
  cmake_parse_arguments(PARSE_ARGV 2 own CONFINED COMPONENT "")
  set(confined false)
  if(own_CONFINED)
    set(confined true)
  endif()
  if(NOT own_COMPONENT)
    set(own_COMPONENT programs)
  endif()
  add_dependencies(programs ${name})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/chladni
          COMPONENT ${own_COMPONENT})
  set(package)
  if(NOT own_COMPONENT STREQUAL programs)
    set(package chladni-${own_COMPONENT})
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY CHLADNI_WORKERS
               "    Worker{\"${name}\", \"${serves}\", \"${package}\", true, ${confined}},\n")
endfunction()

# absent_worker(name "what it would serve"): one that this build goes without.
function(absent_worker name serves)
  set_property(GLOBAL APPEND_STRING PROPERTY CHLADNI_WORKERS
               "    Worker{\"${name}\", \"${serves}\", \"\", false, false},\n")
endfunction()

# Writes `header` with the workers that were added so far.
function(write_worker_list header)
  get_property(workers GLOBAL PROPERTY CHLADNI_WORKERS)
  file(CONFIGURE OUTPUT ${header} @ONLY CONTENT [[
// Made by cmake/Programs.cmake: the workers of this build.
#pragma once

#include <array>
#include <string_view>

namespace chladni::app {

struct Worker {
  std::string_view name, serves;
  std::string_view package;  ///< the Debian package that alone has it; empty: that of `chladni`
  bool built;
  bool confined;  ///< it runs without network, other files and other processes
};

inline constexpr auto kWorkers = std::to_array<Worker>({
@workers@});

}  // namespace chladni::app
]])
endfunction()
