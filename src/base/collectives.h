/// \file
/// Numbers and texts that ranks share: sums, largest values, verdicts, rows of all ranks. All are
/// collective, and every rank gets the same result.
#pragma once

#include <mpi.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace floe {

/// MPI's name of a number's type.
template <class T>
MPI_Datatype mpi_type() {
  if constexpr (std::is_same_v<T, double>) {
    return MPI_DOUBLE;
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    return MPI_INT64_T;
  } else if constexpr (std::is_same_v<T, char>) {
    return MPI_CHAR;
  } else {
    static_assert(std::is_same_v<T, std::int32_t>);
    return MPI_INT32_T;
  }
}

/// Replaces each number by its sum over the ranks.
template <class T>
void sum_over_ranks(std::span<T> values, MPI_Comm comm) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), mpi_type<T>(),
                MPI_SUM, comm);
}
template <class T>
requires std::is_arithmetic_v<T> T sum_over_ranks(T mine, MPI_Comm comm) {
  sum_over_ranks(std::span<T>(&mine, 1), comm);
  return mine;
}
template <class T, std::size_t n>
std::array<T, n> sum_over_ranks(std::array<T, n> mine, MPI_Comm comm) {
  sum_over_ranks(std::span<T>(mine), comm);
  return mine;
}

/// Replaces each number by the largest over the ranks. What is not a number counts as infinity: MPI
/// may lose it or give each rank another answer, and ranks that decide differently wait for each
/// other.
inline void largest_over_ranks(std::span<double> values, MPI_Comm comm) {
  for (double& value : values) {
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX,
                comm);
}
inline double largest_over_ranks(double mine, MPI_Comm comm) {
  largest_over_ranks(std::span(&mine, 1), comm);
  return mine;
}

/// Whether it is true on some rank; on every rank.
inline bool on_any_rank(bool mine, MPI_Comm comm) {
  int any = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm);
  return any != 0;
}
inline bool on_all_ranks(bool mine, MPI_Comm comm) { return !on_any_rank(!mine, comm); }

/// A rank's number, and a whole number that belongs to it: the rank, or the index of a body.
struct RankedValue {
  double value = 0;
  int index = 0;
};
/// The one with the largest (least) value of all ranks; of equal ones that of the least index.
inline RankedValue largest_of_ranks(const RankedValue& mine, MPI_Comm comm) {
  RankedValue all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  return all;
}
inline RankedValue least_of_ranks(const RankedValue& mine, MPI_Comm comm) {
  RankedValue all;
  MPI_Allreduce(&mine, &all, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm);
  return all;
}

/// Gives all ranks the value, the numbers or the text of rank `root`.
template <class T>
requires std::is_arithmetic_v<T>
void broadcast(T& value, MPI_Comm comm, int root = 0) {
  MPI_Bcast(&value, 1, mpi_type<T>(), root, comm);
}
template <class T, std::size_t n>
void broadcast(std::array<T, n>& values, MPI_Comm comm, int root = 0) {
  MPI_Bcast(values.data(), static_cast<int>(n), mpi_type<T>(), root, comm);
}
inline void broadcast(bool& value, MPI_Comm comm, int root = 0) {
  int number = value ? 1 : 0;
  MPI_Bcast(&number, 1, MPI_INT, root, comm);
  value = number != 0;
}
void broadcast(std::string& text, MPI_Comm comm, int root = 0);
void broadcast(std::vector<double>& values, MPI_Comm comm, int root = 0);

/// All ranks' numbers one after the other. \param[out] counts  each rank's number of them, if
/// wanted
template <class T>
std::vector<T> all_gathered(const std::vector<T>& mine, MPI_Comm comm,
                            std::vector<int>* counts = nullptr) {
  int ranks = 1, sum = 0;
  MPI_Comm_size(comm, &ranks);
  std::vector<int> each(static_cast<std::size_t>(ranks)), offsets;
  const int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, each.data(), 1, MPI_INT, comm);
  for (const int n : each) {
    offsets.push_back(sum);
    sum += n;
  }
  std::vector<T> all(static_cast<std::size_t>(sum));
  MPI_Allgatherv(mine.data(), count, mpi_type<T>(), all.data(), each.data(), offsets.data(),
                 mpi_type<T>(), comm);
  if (counts != nullptr) *counts = each;
  return all;
}

}  // namespace floe
