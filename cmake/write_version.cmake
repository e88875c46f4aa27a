# cmake -D SOURCE= -D VERSION= -D OUTPUT= -P write_version.cmake: the version with its commit, as
# C++; written only where it changed, so that nothing is compiled for a commit that was there.
#
#   0.1.0+g0123456789         of a checkout, at that commit
#   0.1.0+g0123456789-dirty   with changes that are not committed
#   0.1.0+unknown-commit      neither a checkout nor an archive that git made

function(ask_git variable)
  execute_process(COMMAND ${GIT} -C ${SOURCE} ${ARGN} RESULT_VARIABLE status
                  OUTPUT_VARIABLE said ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(${variable} "${said}" PARENT_SCOPE)
  set(status "${status}" PARENT_SCOPE)
endfunction()

# A source tree that was unpacked inside a checkout of something else has not that one's commit.
function(commit_of_checkout variable)
  find_program(GIT git)
  if(NOT GIT)
    return()
  endif()
  ask_git(top rev-parse --show-toplevel)
  file(REAL_PATH "${SOURCE}" here)
  if(NOT status EQUAL 0 OR NOT top STREQUAL here)
    return()
  endif()
  ask_git(commit rev-parse --short=10 HEAD)
  if(NOT status EQUAL 0)
    return()
  endif()
  ask_git(nothing diff --quiet HEAD --)
  if(NOT status EQUAL 0)
    string(APPEND commit -dirty)
  endif()
  set(${variable} g${commit} PARENT_SCOPE)
endfunction()

# `git archive` writes the commit into this file.
function(commit_of_archive variable)
  if(EXISTS ${SOURCE}/cmake/commit.txt)
    file(READ ${SOURCE}/cmake/commit.txt text)
    if(text MATCHES "^([0-9a-f]+)[ \n]*$")
      string(SUBSTRING ${CMAKE_MATCH_1} 0 10 commit)
      set(${variable} g${commit} PARENT_SCOPE)
    endif()
  endif()
endfunction()

set(commit unknown-commit)
commit_of_archive(commit)
commit_of_checkout(commit)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
// Made by cmake/write_version.cmake.
#include "show/version.h"

namespace chladni::show {

std::string version() { return "@VERSION@+@commit@"; }

}  // namespace chladni::show
]])
