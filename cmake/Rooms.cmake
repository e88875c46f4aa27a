# A room is a folder, a library and a namespace of one name.

add_library(chladni_warnings INTERFACE)
target_compile_options(chladni_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # It sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
  target_compile_options(chladni_warnings INTERFACE -Wno-restrict)
endif()

# Tests, and rooms that read, write and tell, compile a third to a half faster so and run as fast: what
# takes time is in the other rooms.
function(optimise_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# add_precompiled(kind header libraries...): what use_precompiled(target kind) gives to a target.
function(add_precompiled kind header)
  if(NOT CHLADNI_PRECOMPILE)
    return()
  endif()
  # Of the kind that takes them, a library or programs: its flags must be theirs.
  set(source ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "int main() {}  // holds ${header}\n")
  if(kind STREQUAL "tests")
    add_executable(chladni_precompiled_${kind} ${source})
  else()
    add_library(chladni_precompiled_${kind} OBJECT ${source})
  endif()
  target_link_libraries(chladni_precompiled_${kind} PRIVATE Eigen3::Eigen fmt::fmt chladni_warnings
                                                            ${ARGN})
  target_include_directories(chladni_precompiled_${kind} PRIVATE ${PROJECT_SOURCE_DIR})
  target_precompile_headers(chladni_precompiled_${kind} PRIVATE ${header})
  if(kind MATCHES "^(tests|cold_room)$")
    optimise_lightly(chladni_precompiled_${kind})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)  # ccache asks for it
    target_compile_options(chladni_precompiled_${kind} PRIVATE -fpch-preprocess)
  endif()
endfunction()

function(use_precompiled target kind)
  if(NOT TARGET chladni_precompiled_${kind})
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM chladni_precompiled_${kind})
  # Its macros must be those of the headers', fmt's among them.
  target_compile_definitions(${target} PRIVATE
                             $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  endif()
endfunction()

# unite(target most sources...): compiles up to `most` files of one folder as one, in a quarter to a
# third less time.
# The names in their unnamed namespaces must differ then. A changed file brings its neighbours with
# it, so the presets for work on the code go without (CHLADNI_UNITY).
function(unite target most)
  if(NOT CHLADNI_UNITY)
    return()
  endif()
  foreach(source ${ARGN})
    if(IS_ABSOLUTE ${source})
      continue()  # generated
    endif()
    get_filename_component(folder "${source}" DIRECTORY)
    string(MAKE_C_IDENTIFIER "of_${folder}" group)
    if(NOT DEFINED count_${group})
      set(count_${group} 0)
    endif()
    math(EXPR batch "${count_${group}} / ${most}")
    math(EXPR count_${group} "${count_${group}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${batch})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# add_room(name [COLD] SOURCES ... PUBLIC rooms... PRIVATE libraries...): COLD is a room that reads,
# writes or tells, where no loop takes time.
function(add_room name)
  cmake_parse_arguments(ROOM "COLD" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(NOT ROOM_SOURCES)  # a room of headers only
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}_room.cpp "// headers only\n")
    set(ROOM_SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${name}_room.cpp)
  endif()
  add_library(chladni_${name} STATIC ${ROOM_SOURCES})
  add_library(chladni::${name} ALIAS chladni_${name})
  target_include_directories(chladni_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                    $<INSTALL_INTERFACE:include/chladni>)
  target_compile_features(chladni_${name} PUBLIC cxx_std_20)
  target_link_libraries(chladni_${name} PUBLIC Eigen3::Eigen ${ROOM_PUBLIC}
                        PRIVATE $<BUILD_INTERFACE:chladni_warnings> ${ROOM_PRIVATE})
  set_target_properties(chladni_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY CHLADNI_ROOMS chladni_${name})
  if(ROOM_COLD)
    optimise_lightly(chladni_${name})
    use_precompiled(chladni_${name} cold_room)
  else()
    use_precompiled(chladni_${name} room)
  endif()
  unite(chladni_${name} 8 ${ROOM_SOURCES})
endfunction()

# add_room_tests(room [APART] [ONCE] [LABEL label] [TIMEOUT seconds] [LINK libraries...]
#                [DEFINE macros...] [NEEDS targets...] FILES a_test.cpp ...): one program for up to
# six files, or APART. Each test runs in a process of its own; with ONCE those of a program run in
# one, for programs with many short tests on a body that takes seconds to make.
function(add_room_tests room)
  cmake_parse_arguments(T "APART;ONCE" "LABEL;TIMEOUT" "FILES;LINK;DEFINE;NEEDS" ${ARGN})
  if(NOT T_LABEL)
    set(T_LABEL unit)
  endif()
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  set(most 1)
  if(CHLADNI_UNITY AND NOT T_APART)
    set(most 6)
  endif()
  set(files)
  foreach(file ${T_FILES})
    list(APPEND files ${file})
    list(LENGTH files count)
    if(count EQUAL most)
      add_test_program(${room} ${files})
      set(files)
    endif()
  endforeach()
  if(files)
    add_test_program(${room} ${files})
  endif()
endfunction()

# One program of add_room_tests, whose variables it sees. It is named after its first file.
function(add_test_program room first)
  get_filename_component(stem ${first} NAME_WE)
  set(program ${room}_${stem})
  add_executable(${program} ${first} ${ARGN})
  target_link_libraries(${program} PRIVATE chladni::${room} ${T_LINK} chladni_warnings
                                           chladni_test_workers chladni_rotation
                                           GTest::gtest_main)
  target_compile_definitions(${program} PRIVATE ${T_DEFINE}
    CHLADNI_SOURCE_DIR="${PROJECT_SOURCE_DIR}" CHLADNI_BINARY_DIR="${PROJECT_BINARY_DIR}")
  optimise_lightly(${program})
  use_precompiled(${program} tests)
  if(ARGN)
    set_source_files_properties(${first} ${ARGN} PROPERTIES UNITY_GROUP tests)
    set_target_properties(${program} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
  if(T_NEEDS)
    add_dependencies(${program} ${T_NEEDS})
  endif()
  set_target_properties(${program} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/${room})
  if(T_ONCE)
    add_test(NAME ${room}.${stem} COMMAND ${program} --gtest_brief=1)
    set_tests_properties(${room}.${stem} PROPERTIES LABELS ${T_LABEL} TIMEOUT ${T_TIMEOUT})
    return()
  endif()
  gtest_discover_tests(${program} TEST_PREFIX ${room}. NO_PRETTY_VALUES
                       PROPERTIES LABELS ${T_LABEL} TIMEOUT ${T_TIMEOUT} DISCOVERY_TIMEOUT 60)
endfunction()
