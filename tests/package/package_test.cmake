# cmake -D BUILD= -D HERE= -D WORK= -D COMPILER= -D FLAGS= -P package_test.cmake
file(REMOVE_RECURSE ${WORK})
set(project ${CMAKE_COMMAND} -S ${HERE}/stranger -D CMAKE_PREFIX_PATH=${WORK}/prefix
            -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}"
            -D CMAKE_BUILD_TYPE=Release)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${status}:\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${project} -B ${WORK}/build)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/stranger)
if(NOT said MATCHES "[ \n]17[89]\\.[0-9]+")  # 178.90 Hz in exact elasticity
  message(FATAL_ERROR "the first flexible mode of the plate is not near 178.9 Hz:\n${said}")
endif()
message(STATUS "${said}")

execute_process(COMMAND ${project} -B ${WORK}/unknown -D COMPONENT=teapots
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE said)
if(status EQUAL 0 OR NOT said MATCHES "no component \"teapots\"")
  message(FATAL_ERROR "an unknown component was not refused by its name:\n${said}")
endif()
