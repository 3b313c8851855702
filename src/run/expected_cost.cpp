#include "run/expected_cost.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "base/collectives.h"

namespace floe {
namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// Returns the number at the beginning of a file, infinity if there is none ("max").
double number_in(const std::filesystem::path& path) {
  std::ifstream file(path);
  double value = 0;
  return file >> value ? value : unlimited;
}

/// Returns MemAvailable plus free swap [B].
double free_in_system() {
  std::ifstream file("/proc/meminfo");
  double sum = 0;
  bool known = false;
  for (std::string word; file >> word;) {
    double kilobytes = 0;
    if (word != "MemAvailable:" && word != "SwapFree:") continue;
    file >> kilobytes;
    sum += 1024 * kilobytes;
    known = known || word == "MemAvailable:";
  }
  return known ? sum : unlimited;
}

/// Returns the memory left by the cgroups (version 1 or 2) of this process [B].
double free_in_group() {
  double least = unlimited;
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string kind = line.substr(first + 1, second - first - 1);
    const bool is_new = kind.empty();
    if (!is_new && kind != "memory") continue;
    const std::filesystem::path root = is_new ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    const char* const limit = is_new ? "memory.max" : "memory.limit_in_bytes";
    const char* const used = is_new ? "memory.current" : "memory.usage_in_bytes";
    // A group's limit holds for the groups inside it too. A container may show only its own root.
    for (std::filesystem::path at = std::filesystem::path(line.substr(second + 1)).relative_path();;
         at = at.parent_path()) {
      const double most = number_in(root / at / limit), now = number_in(root / at / used);
      if (std::isfinite(most) && std::isfinite(now)) least = std::min(least, most - now);
      if (at.empty()) break;
    }
  }
  return std::max(0.0, least);
}

}  // namespace

FactorisationCost factorisation_cost(double unknowns, int ranks) {
  // Nested dissection of a plane graph takes n^1.5 operations and n log n numbers.
  constexpr double size = 177'000, seconds = 2, solve_seconds = 0.15, bytes_a_level = 150;
  constexpr double least = 1e-3, least_solve = 2e-4;  // of the calls themselves, whatever the size
  const double relative = unknowns / size, shared = std::pow(ranks, 0.7);
  return {least + seconds * std::pow(relative, 1.35) / shared,
          least_solve + solve_seconds * relative / shared,
          bytes_a_level * unknowns * std::log2(std::max(2.0, unknowns))};
}

double lattice_bytes(double bodies, int ranks) {
  constexpr double program = 45e6, of_a_body = 1e3;
  return ranks * (program + of_a_body * bodies) + of_a_body * bodies;
}

double free_memory(MPI_Comm comm) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const double mine = rank(machine) == 0 ? std::min(free_in_system(), free_in_group()) : 0;
  MPI_Comm_free(&machine);
  return sum_over_ranks(mine, comm);
}

}  // namespace floe
