#include "runtime.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "floe/base/petsc.h"
#include "floe/session/session.h"

namespace floe::python {
namespace {

/// PETSc goes before MPI.
struct Runtime {
  Mpi mpi{Mpi::Guest{}};
  Session session{"floe", {}, false};
};

enum class Stand { new_, running, ended };

struct Process {
  Stand stand = Stand::new_;
  std::optional<Runtime> runtime;
  std::map<std::int64_t, Held> simulations;  ///< by number, which is the same on all ranks
  std::set<std::int64_t> dropped;            ///< on this rank
  std::int64_t next = 0;
};

/// Never destroyed: Python may drop objects after all else.
Process& process() {
  static auto* const one = new Process;
  return *one;
}

void destroy(std::int64_t number) {
  Process& all = process();
  const auto found = all.simulations.find(number);
  if (found == all.simulations.end()) return;
  {
    const SolverOptions::Use use(*found->second.options);
    found->second.simulation.reset();
  }
  all.simulations.erase(found);
  all.dropped.erase(number);
}

}  // namespace

void start() {
  Process& all = process();
  if (all.stand == Stand::running) return;
  if (all.stand == Stand::ended) throw std::runtime_error("floe has ended with its process");
  all.runtime.emplace();
  all.stand = Stand::running;
}

void finish() {
  Process& all = process();
  if (all.stand != Stand::running) return;
  int ended = 0;
  MPI_Finalized(&ended);
  all.stand = Stand::ended;
  if (ended != 0) return;  // somebody was faster: nothing can be freed
  while (!all.simulations.empty()) destroy(all.simulations.begin()->first);
  all.runtime.reset();
}

Owner::Owner(Held held) : number_(process().next++) {
  process().simulations.emplace(number_, std::move(held));
}
Owner::~Owner() {
  if (get() != nullptr) process().dropped.insert(number_);
}

Held* Owner::get() {
  const auto found = process().simulations.find(number_);
  return found == process().simulations.end() ? nullptr : &found->second;
}
void Owner::free() { destroy(number_); }

void free_dropped() {
  Process& all = process();
  if (all.stand != Stand::running) return;
  const std::vector<std::int64_t> mine(all.dropped.begin(), all.dropped.end());
  const int ranks = size();
  if (ranks == 1) {
    for (const std::int64_t number : mine) destroy(number);
    return;
  }
  const int count = static_cast<int>(mine.size());
  int most = 0, sum = 0;
  check(MPI_Allreduce(&count, &most, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
  if (most == 0) return;
  std::vector<int> counts(static_cast<std::size_t>(ranks)), offsets;
  check(MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, PETSC_COMM_WORLD));
  for (const int n : counts) {
    offsets.push_back(sum);
    sum += n;
  }
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(sum));
  check(MPI_Allgatherv(mine.data(), count, MPI_INT64_T, numbers.data(), counts.data(),
                       offsets.data(), MPI_INT64_T, PETSC_COMM_WORLD));
  std::map<std::int64_t, int> by_ranks;
  for (const std::int64_t number : numbers) ++by_ranks[number];
  for (const auto& [number, n] : by_ranks)
    if (n == ranks) destroy(number);
}

std::size_t alive() { return process().simulations.size(); }

}  // namespace floe::python
