# The install tree, and find_package(chladni COMPONENTS fem) on it.
include(CMakePackageConfigHelpers)

set(CHLADNI_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/chladni)
set(CHLADNI_COMPONENTS base host dense mesh modal fem priors placement recordings identification io)

foreach(room ${CHLADNI_COMPONENTS})
  install(TARGETS chladni_${room} EXPORT chladni_${room} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          COMPONENT development)
  install(EXPORT chladni_${room} NAMESPACE chladni:: DESTINATION ${CHLADNI_PACKAGE_DIR}
          FILE chladni_${room}.cmake COMPONENT development)
  # Headers behind a door name a heavy library and are nobody else's.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/chladni
          COMPONENT development FILES_MATCHING PATTERN "*.h" PATTERN "cgal_*" EXCLUDE PATTERN "mesher" EXCLUDE
          PATTERN "picture" EXCLUDE)
endforeach()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/chladniConfig.cmake.in chladniConfig.cmake
                              INSTALL_DESTINATION ${CHLADNI_PACKAGE_DIR})
write_basic_package_version_file(chladniConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/chladniConfig.cmake
              ${PROJECT_BINARY_DIR}/chladniConfigVersion.cmake
        DESTINATION ${CHLADNI_PACKAGE_DIR} COMPONENT development)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE TYPE DOC COMPONENT programs)
install(FILES ${PROJECT_SOURCE_DIR}/mesh/mesher/LICENSE TYPE DOC COMPONENT programs
        RENAME LICENSE.chladni-tetgen)
