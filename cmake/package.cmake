# `cpack` in a build folder of the preset `package` makes the Debian packages floe and libfloe-dev
# (tools/package).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME floe)
set(CPACK_PACKAGE_CONTACT "The floe developers <floe@localhost>")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME floe)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "floating sea ice as rigid bodies joined by beams
A floating ice sheet is meshed by a centroidal Voronoi tessellation; every
cell is a rigid prism, every facet between two cells a co-rotational
Timoshenko beam, so that a sheet bends, stretches and sinks as ice does,
breaks into blocks, and its blocks collide, float and pile up. On one core
or many (MPI), with PETSc.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS
    "python3:any, python3-h5py, python3-matplotlib, python3-numpy, python3-pil, python3-yaml")
# Without mpiexec there are runs on one process; on the reference BLAS they are about five times
# slower.
# floe loads needs scipy and pandas, floe make_floes scipy and shapely, floe netcdf the rest.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS
    "openmpi-bin, libopenblas0-serial | libopenblas0, python3-scipy, python3-pandas, \
python3-xarray, python3-netcdf4, python3-dask, python3-shapely")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS
    "libfloe-dev, python3-paraview, xvfb, xauth, libgl1-mesa-dri, ffmpeg")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/postinst
                                               ${PROJECT_SOURCE_DIR}/cmake/debian/prerm
                                               ${PROJECT_SOURCE_DIR}/cmake/debian/triggers)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libfloe-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "floe as a library: headers and examples
For programs in C++ that make, read, cut and measure lattices of floating ice,
or solve with them: headers, what find_package(floe) looks for in CMake, and
examples.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "floe (= ${PROJECT_VERSION}), petsc-dev, libpetsc-real-dev, libopenmpi-dev, pkg-config, g++")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "cmake")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-floe)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "floe from Python: scenes, runs, coupling
With this compiled module Python's package floe, which comes with floe and
reads results, also makes scenes of floating ice, steps them, couples them
with other programs and looks at their bodies, beams and contacts.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
get_property(FLOE_PYTHON_VERSIONS GLOBAL PROPERTY FLOE_PYTHON_VERSIONS)  # empty: not built
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "floe (= ${PROJECT_VERSION}), ${FLOE_PYTHON_VERSIONS}, python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS
    "python3-mpi4py, python3-pandas, python3-xarray, python3-dask, python3-matplotlib")

# What Debian asks of each package, and of no other installation.
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(changelog ${PROJECT_BINARY_DIR}/changelog.gz)
  file(ARCHIVE_CREATE OUTPUT ${changelog} PATHS ${PROJECT_SOURCE_DIR}/CHANGELOG.md
       FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9)
  set(packages program:floe development:libfloe-dev)
  if(FLOE_PYTHON_VERSIONS)
    list(APPEND packages python:python3-floe)
  endif()
  foreach(package IN LISTS packages)
    string(REGEX MATCH "(.*):(.*)" _ ${package})
    install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian/copyright ${changelog}
            COMPONENT ${CMAKE_MATCH_1}
            DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2})
  endforeach()
endif()
include(CPack)
