# Debian packages by CPack, whose synopsis is that of the project: chladni (programs, manual, completions, models, documents), chladni-cluster
# (the ranks of MPI, where they were built), python3-chladni, libchladni-dev. ./package makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME chladni)
set(CPACK_PACKAGE_CONTACT "The Chladni maintainers <chladni@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL programs python development)
if(TARGET chladni-slepc)
  list(APPEND CPACK_COMPONENTS_ALL cluster)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME chladni)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "xvfb")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "chladni-cluster, python3-chladni")
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION
"Tetrahedral finite elements of plates, wafer tables and beams, with a
 count that proves that no mode is missing; the heat map of where a
 collocated sensor-actuator pair belongs; modal models from measured
 responses; and what a simulation gets wrong.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-chladni)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, chladni (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-scipy, python3-pandas")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"This package has the Python package chladni: every verb of the program, on
 NumPy's arrays.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libchladni-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    # What the headers include and what the exported targets name.
    "chladni (= ${PROJECT_VERSION}), libeigen3-dev, libfftw3-dev, libfmt-dev, libgmp-dev, libmatio-dev, libmetis-dev, libmpfr-dev, libnlopt-dev, libopenblas-dev, libslicot-dev, libsuitesparse-dev, libudunits2-dev, nlohmann-json3-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libvtk9-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"This package has static libraries, headers and a CMake package.")
set(CPACK_DEBIAN_CLUSTER_PACKAGE_NAME chladni-cluster)
set(CPACK_DEBIAN_CLUSTER_PACKAGE_DEPENDS "chladni (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_CLUSTER_PACKAGE_RECOMMENDS "openmpi-bin")
set(CPACK_DEBIAN_CLUSTER_DESCRIPTION
"This package has the program that finds the modes of one large body by
 the ranks of MPI, with SLEPc and MUMPS: the option --engine.")

# What stands beside the programs. Debian wants manuals and change logs compressed.
set(share ${CMAKE_INSTALL_DATADIR})
set(made ${PROJECT_BINARY_DIR}/CMakeFiles/deb)
file(MAKE_DIRECTORY ${made})
function(compressed from to)
  execute_process(COMMAND gzip -9 -n -c INPUT_FILE ${from} OUTPUT_FILE ${made}/${to}
                  COMMAND_ERROR_IS_FATAL ANY)
endfunction()
set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
             ${CMAKE_CURRENT_LIST_DIR}/chladni.1)
file(WRITE ${made}/changelog "chladni (${PROJECT_VERSION}) unstable; urgency=medium

  * See CHANGELOG.md of the sources.

 -- ${CPACK_PACKAGE_CONTACT}  Wed, 25 Nov 2026 00:00:00 +0000
")
compressed(${CMAKE_CURRENT_LIST_DIR}/chladni.1 chladni.1.gz)
compressed(${made}/changelog changelog.gz)
install(FILES ${made}/chladni.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/chladni.bash RENAME chladni
        DESTINATION ${share}/bash-completion/completions COMPONENT programs)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/_chladni
        DESTINATION ${share}/zsh/vendor-completions COMPONENT programs)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/chladni.fish
        DESTINATION ${share}/fish/vendor_completions.d COMPONENT programs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models DESTINATION ${share}/chladni COMPONENT programs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${share}/doc/chladni COMPONENT programs
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN "*.json" PATTERN "*.ipynb")
foreach(component programs python development cluster)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${share}/doc/${package}
          COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${made}/changelog.gz DESTINATION ${share}/doc/${package} COMPONENT ${component}
          EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
