#include "floe/session/version.h"

#include <hdf5.h>
#include <petsc.h>
#include <yaml.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <vector>

#include "base/collectives.h"

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

/// Returns the first part of MPI's description of itself, which has the version.
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

/// Returns the level of the x86-64 psABI by the instructions that the compiler may use.
constexpr std::string_view level() {
#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && \
    defined(__AVX512DQ__) && defined(__AVX512VL__)
  return "x86-64-v4";
#elif defined(__AVX2__) && defined(__BMI__) && defined(__BMI2__) && defined(__F16C__) && \
    defined(__FMA__) && defined(__LZCNT__) && defined(__MOVBE__)
  return "x86-64-v3";
#elif defined(__SSE4_2__) && defined(__POPCNT__)
  return "x86-64-v2";
#elif defined(__x86_64__)
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "this architecture";
#endif
}

}  // namespace

std::string version() { return FLOE_VERSION; }

std::string built_for() {
  constexpr std::string_view march = FLOE_MARCH;
  std::string text(level());
  if (!march.empty() && march != level()) text += " (-march=" + std::string(march) + ")";
  return text;
}

std::string built_for(MPI_Comm comm) {
  const std::string mine = built_for();
  std::string first = mine;
  broadcast(first, comm);
  if (on_all_ranks(first == mine, comm)) return mine;
  std::map<std::string, int> counts;
  std::vector<char> line(mine.begin(), mine.end());
  line.push_back('\n');
  const std::vector<char> all = all_gathered(line, comm);
  for (auto from = all.begin(); from != all.end();) {
    const auto end = std::find(from, all.end(), '\n');
    ++counts[std::string(from, end)];
    from = end + 1;
  }
  std::string text;
  for (const auto& [name, count] : counts)
    text += (text.empty() ? "" : ", ") + name + " on " + std::to_string(count) +
            (count == 1 ? " rank" : " ranks");
  return text;
}

std::string version_text() {
  return "floe " + version() + "\nbuilt for " + built_for() + "\n" + petsc() + "\n" + mpi() + "\n" +
         hdf5() + "\nlibyaml " + yaml_get_version_string() + "\n";
}

}  // namespace floe
