/// \file
/// The archive: the visitor that writes and reads the state of a run in a checkpoint.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/on_root.h"
#include "files/hdf5.h"
#include "lattice/partition.h"
#include "lattice/renumbering.h"

namespace floe {

/// The permitted interval of a loaded number. NaN lies in none.
struct Within {
  double least = std::numeric_limits<double>::lowest(), most = std::numeric_limits<double>::max();
};
inline constexpr Within finite{}, not_negative{0},
    positive{std::numeric_limits<double>::denorm_min()},
    not_negative_or_infinite{0, std::numeric_limits<double>::infinity()};

enum class Transfer { save, load };

/// Writes a state when saving and sets it when loading. One visit serves both directions, so that
/// the two cannot disagree. The file is in global order and independent of the ranks, except for
/// each rank's share of a sum. All functions are collective; rank 0 alone accesses the file. When
/// loading, a dataset that is missing, or a value outside its permitted interval, raises InputError
/// on all ranks.
class Archive {
 public:
  /// Saves into `file`, or loads from it.
  /// \param part  must outlive the archive
  /// \param file  on rank 0; null on other ranks
  /// \param name  of the file, for messages
  Archive(const Part& part, Hdf5File* file, Transfer direction, std::string name = {})
      : part_(part), file_(file), loading_(direction == Transfer::load), name_(std::move(name)) {}

  bool loading() const { return loading_; }
  /// Whether the state stays in its run, and what a restart would begin anew goes with it.
  bool within_run() const { return within_run_; }
  void stay_in_run() { within_run_ = true; }
  /// Loads what was saved of another lattice: some bodies and beams have left, others have joined
  /// and keep the values that they have. \param how  must outlive the archive
  void renumber(const Renumbering& how);
  /// Whether indices are those of another lattice.
  bool renumbers() const { return renumbering_ != nullptr; }
  /// Gives bodies in some columns of rows their new indices, and drops rows of bodies that have
  /// left. Negative indices stay. Does nothing without renumber().
  void renumber_bodies(std::vector<double>& rows, std::size_t width,
                       std::initializer_list<std::size_t> columns) const;
  /// The same for beams in the first column.
  void renumber_beams(std::vector<double>& rows, std::size_t width) const;
  /// Returns the outcome of writing, on rank 0. A failed write raises nothing until all ranks know
  /// of the failure.
  const Outcome& outcome() const { return outcome_; }
  /// Sets the group in which the following names lie.
  void enter(const std::string& group) { group_ = group.empty() ? "" : group + "/"; }

  /// Visit a value, or values, that are alike on all ranks.
  void common(const std::string& name, double& value, Within must = finite);
  /// Below 2^53. \param least  smallest permitted value
  void common(const std::string& name, std::int64_t& value, std::int64_t least = 0);
  void common(const std::string& name, bool& value);
  void common(const std::string& name, std::vector<double>& values);
  void common(const std::string& name, std::string& text);

  /// Visits this rank's share of a sum. On the number of ranks of the saved run each rank gets its
  /// own share back; otherwise rank 0 gets the sum, and other ranks get 0.
  void share(const std::string& name, double& value);

  /// Visits rows of `width` numbers, one row for each of some owned bodies.
  /// \param bodies  local indices; each body on one rank only
  /// \param rows  row-major
  void rows(const std::string& name, std::span<const std::int32_t> bodies, std::span<double> rows,
            int width) {
    this->rows(name, part_.global, bodies_before_, bodies, rows, width);
  }
  /// As rows(), for beams. When saving, each rank passes the beams that it counts.
  void beam_rows(const std::string& name, std::span<const std::int32_t> beams,
                 std::span<double> rows, int width) {
    this->rows(name, part_.global_beam, beams_before_, beams, rows, width);
  }

 private:
  /// \param names   global index of each local one
  /// \param before  of renumber(); empty without it
  void rows(const std::string& name, std::span<const std::int32_t> names,
            const std::vector<std::int32_t>& before, std::span<const std::int32_t> local,
            std::span<double> rows, int width);
  void save_rows(const std::string& name, const std::vector<std::int32_t>& global,
                 std::span<const double> rows, int width);
  std::vector<double> gathered(std::span<const double> mine) const;
  /// Reads a dataset on rank 0 for all ranks.
  std::vector<double> read(const std::string& name, Within must, int columns = 1);
  std::vector<double> one(const std::string& name, Within must);
  [[noreturn]] void refuse(const std::string& why) const;

  const Part& part_;
  /// Lets rank 0 write, unless an earlier write has failed.
  template <class Work>
  void write(Work&& work) {
    if (file_ != nullptr && outcome_.kind == Outcome::good) outcome_ = outcome_of(work);
  }

  Hdf5File* file_;
  Outcome outcome_;
  bool loading_, within_run_ = false;
  const Renumbering* renumbering_ = nullptr;
  /// Per body and beam now: its index in the lattice of the file; -1: it has joined.
  std::vector<std::int32_t> bodies_before_, beams_before_;
  std::string name_, group_;
};

}  // namespace floe
