# A room is a folder, a library and a namespace of one name.

add_library(chladni_warnings INTERFACE)
target_compile_options(chladni_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # It sees overlaps in std::string's operator+ that are not there (GCC bug 105651).
  target_compile_options(chladni_warnings INTERFACE -Wno-restrict)
endif()

# Tests compile a third faster so and run as fast: what takes time is in the rooms.
function(optimise_tests target)
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
  if(kind STREQUAL "tests")
    optimise_tests(chladni_precompiled_${kind})
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

# add_room(name SOURCES ... PUBLIC rooms... PRIVATE libraries...)
function(add_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
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
  use_precompiled(chladni_${name} room)
endfunction()

# add_room_tests(room [LABEL label] [LINK libraries...] FILES a_test.cpp ...): one program per file.
function(add_room_tests room)
  cmake_parse_arguments(T "" "LABEL;TIMEOUT" "FILES;LINK" ${ARGN})
  if(NOT T_LABEL)
    set(T_LABEL unit)
  endif()
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  foreach(source ${T_FILES})
    get_filename_component(stem ${source} NAME_WE)
    add_executable(${room}_${stem} ${source})
    target_link_libraries(${room}_${stem} PRIVATE chladni::${room} ${T_LINK} chladni_warnings
                                                  chladni_test_workers GTest::gtest_main)
    target_compile_definitions(${room}_${stem} PRIVATE
      CHLADNI_SOURCE_DIR="${PROJECT_SOURCE_DIR}" CHLADNI_BINARY_DIR="${PROJECT_BINARY_DIR}")
    optimise_tests(${room}_${stem})
    use_precompiled(${room}_${stem} tests)
    set_target_properties(${room}_${stem} PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests/${room})
    gtest_discover_tests(${room}_${stem} TEST_PREFIX ${room}. NO_PRETTY_VALUES
                         PROPERTIES LABELS ${T_LABEL} TIMEOUT ${T_TIMEOUT} DISCOVERY_TIMEOUT 60)
  endforeach()
endfunction()
