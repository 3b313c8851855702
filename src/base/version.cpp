#include "floe/base/version.h"

#include <hdf5.h>
#include <petsc.h>
#include <yaml.h>

#include <array>
#include <string_view>

namespace floe {
namespace {

std::string numbers(long major, long minor, long patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string petsc() {
  PetscInt major = 0, minor = 0, patch = 0, release = 0;
  if (PetscGetVersionNumber(&major, &minor, &patch, &release) != 0) return "PETSc";
  return "PETSc " + numbers(major, minor, patch) + " (integers of " +
         std::to_string(8 * sizeof(PetscInt)) + " bits)";
}

/// Libraries of MPI describe themselves in a sentence or more: its first part has the version.
std::string mpi() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string_view all(text.data(), static_cast<std::size_t>(length));
  return std::string(all.substr(0, all.find_first_of(",\n")));
}

std::string hdf5() {
  unsigned major = 0, minor = 0, patch = 0;
  H5get_libversion(&major, &minor, &patch);
  return "HDF5 " + numbers(major, minor, patch);
}

}  // namespace

std::string version() { return FLOE_VERSION; }

std::string version_text() {
  return "floe " + version() + "\n" + petsc() + "\n" + mpi() + "\n" + hdf5() + "\nlibyaml " +
         yaml_get_version_string() + "\n";
}

}  // namespace floe
