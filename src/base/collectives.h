/// \file
/// Reductions, broadcasts and gathers of numbers and texts. All functions are collective, and every
/// rank gets the same result.
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

#include "floe/base/rotation.h"

namespace floe {

/// Returns MPI's data type of a number.
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

/// Replace each number by its sum over the ranks.
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
inline Vec3<double> sum_over_ranks(const Vec3<double>& mine, MPI_Comm comm) {
  const auto [x, y, z] = sum_over_ranks(std::array{mine.x, mine.y, mine.z}, comm);
  return {x, y, z};
}

/// Replace each number by the maximum over the ranks. NaN counts as infinity: MPI may lose a NaN or
/// give each rank another result, and ranks that then decide differently wait for each other.
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

/// Whether `mine` is true on any rank (on_any_rank) or on all ranks (on_all_ranks); same result on
/// every rank.
inline bool on_any_rank(bool mine, MPI_Comm comm) {
  int any = mine ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm);
  return any != 0;
}
inline bool on_all_ranks(bool mine, MPI_Comm comm) { return !on_any_rank(!mine, comm); }

/// A number of a rank with an integer label: the rank, or the index of a body.
struct RankedValue {
  double value = 0;
  int index = 0;
};
/// Return the RankedValue with the largest (least) value of all ranks; of equal values, the one
/// with the least index.
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

/// Give all ranks the value, the numbers or the text of rank `root`.
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

/// Concatenates the numbers of all ranks, in order of the ranks.
/// \param[out] counts  how many numbers each rank gave, unless null
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
