# What `cmake --install` puts where, so that it works wherever the prefix is and is moved to. Three
# components: `program`, `python` for the compiled module, and `development` for find_package(floe)
# (three packages in Debian).
include(CMakePackageConfigHelpers)

# -- the program and its library ------------------------------------------------------------------
file(RELATIVE_PATH lib_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(floe PROPERTIES INSTALL_RPATH "$ORIGIN/${lib_from_bin}")
install(TARGETS floe RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(TARGETS libfloe floe_usage EXPORT floe
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT program
                NAMELINK_COMPONENT development)
foreach(level IN LISTS levels)
  install(TARGETS libfloe_${level}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/glibc-hwcaps/${level} COMPONENT program
                  NAMELINK_SKIP)
endforeach()

# -- its tools, scenes, manual and documentation --------------------------------------------------
# Of tools/ what floe runs by name, and modules of these; the rest is for the source tree.
set(subcommands ${PROJECT_SOURCE_DIR}/src/program/subcommands.cpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${subcommands})
file(STRINGS ${subcommands} tools REGEX "^ *Subcommand{\"")
list(TRANSFORM tools REPLACE "^ *Subcommand{\"([a-z_]+)\".*$" "${PROJECT_SOURCE_DIR}/tools/\\1")
file(GLOB modules CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tools/*.py)
list(FILTER modules EXCLUDE REGEX "/tools/(floe_|draw_)")
set(share ${CMAKE_INSTALL_DATADIR}/floe)
install(PROGRAMS ${tools} DESTINATION ${share}/tools COMPONENT program)
install(FILES ${modules} DESTINATION ${share}/tools COMPONENT program)
# The package that the tools are made of; tools/find_floe.py finds it there. It needs nothing that
# is compiled; with the compiled module beside it (component `python`) it also runs scenes.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/floe DESTINATION ${FLOE_PYTHON_PACKAGES}
        COMPONENT program PATTERN __pycache__ EXCLUDE PATTERN .mypy_cache EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/input DESTINATION ${share} COMPONENT program)

# The page is what the program says, like docs/options.md.
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/floe.1.gz
                   COMMAND floe -help_man > floe.1 COMMAND gzip -9nf floe.1
                   WORKING_DIRECTORY ${PROJECT_BINARY_DIR} DEPENDS floe VERBATIM)
add_custom_target(manual ALL DEPENDS ${PROJECT_BINARY_DIR}/floe.1.gz)
install(FILES ${PROJECT_BINARY_DIR}/floe.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
        COMPONENT program)

set(doc ${CMAKE_INSTALL_DATADIR}/doc/floe)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
              ${PROJECT_SOURCE_DIR}/CITATION.cff
              ${PROJECT_SOURCE_DIR}/LICENSE
        DESTINATION ${doc} COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${doc} COMPONENT program)

# -- for programs that use the library ------------------------------------------------------------
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/floe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples DESTINATION ${doc} COMPONENT development)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/floe)
install(EXPORT floe NAMESPACE floe:: FILE floe-targets.cmake DESTINATION ${config}
        COMPONENT development)
# The headers show PETSc's own types, so a program needs the PETSc that the library was built with.
string(REGEX MATCH "^[0-9]+\\.[0-9]+" FLOE_PETSC_VERSION ${PETSC_VERSION})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/floe-config.cmake.in floe-config.cmake
                              INSTALL_DESTINATION ${config})
write_basic_package_version_file(floe-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/floe-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/floe-config-version.cmake
        DESTINATION ${config} COMPONENT development)
