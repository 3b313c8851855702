/// \file
/// What a run takes along over a restart, to and from a checkpoint file.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/hdf5.h"
#include "base/on_root.h"
#include "lattice/partition.h"

namespace floe {

/// What a loaded number must lie in; what is not a number never does.
struct Within {
  double least = std::numeric_limits<double>::lowest(), most = std::numeric_limits<double>::max();
};
inline constexpr Within finite{}, not_negative{0},
    positive{std::numeric_limits<double>::denorm_min()},
    not_negative_or_infinite{0, std::numeric_limits<double>::infinity()};

/// One visit serves both ways: what is named is written when saving and set when loading, so that
/// the two cannot disagree. The file is in global order and says nothing of the ranks but each
/// one's share of a sum. Collective throughout; rank 0 alone touches the file. What is asked for
/// while loading and is not in the file, or is no number that it can be, raises InputError on all
/// ranks.
class Archive {
 public:
  /// Saves into `file` (rank 0; null elsewhere), or loads from it. \param part  must outlive this
  /// \param name  of the file, for messages
  Archive(const Part& part, Hdf5File* file, bool loading, std::string name = {})
      : part_(part), file_(file), loading_(loading), name_(std::move(name)) {}

  bool loading() const { return loading_; }
  /// How writing to the file went, on rank 0: what cannot be written ends nothing before all ranks
  /// know of it.
  const Outcome& outcome() const { return outcome_; }
  /// Names that follow are below this group.
  void enter(const std::string& group) { group_ = group.empty() ? "" : group + "/"; }

  /// A number or numbers that all ranks hold alike.
  void common(const std::string& name, double& value, Within must = finite);
  /// Below 2^53. \param least  that it can be
  void common(const std::string& name, std::int64_t& value, std::int64_t least = 0);
  void common(const std::string& name, bool& value);
  void common(const std::string& name, std::vector<double>& values);
  void common(const std::string& name, std::string& text);

  /// This rank's share of a sum: given back as it was on the same number of ranks, else rank 0 gets
  /// the sum.
  void share(const std::string& name, double& value);

  /// Rows of `width` numbers, one for each of some owned bodies (each on one rank only).
  /// \param bodies  local indices   \param rows  row-major
  void rows(const std::string& name, std::span<const std::int32_t> bodies, std::span<double> rows,
            int width) {
    this->rows(name, part_.global, bodies, rows, width);
  }
  /// The same for beams: saving, those that each rank counts.
  void beam_rows(const std::string& name, std::span<const std::int32_t> beams,
                 std::span<double> rows, int width) {
    this->rows(name, part_.global_beam, beams, rows, width);
  }

 private:
  /// \param names  global index of each local one
  void rows(const std::string& name, std::span<const std::int32_t> names,
            std::span<const std::int32_t> local, std::span<double> rows, int width);
  void save_rows(const std::string& name, const std::vector<std::int32_t>& global,
                 std::span<const double> rows, int width);
  std::vector<double> gathered(std::span<const double> mine) const;
  /// Numbers of a dataset on all ranks.
  std::vector<double> read(const std::string& name, Within must, int columns = 1);
  std::vector<double> one(const std::string& name, Within must);
  [[noreturn]] void refuse(const std::string& why) const;

  const Part& part_;
  /// Lets rank 0 write, unless that has failed before.
  template <class Work>
  void write(Work&& work) {
    if (file_ != nullptr && outcome_.kind == Outcome::good) outcome_ = outcome_of(work);
  }

  Hdf5File* file_;
  Outcome outcome_;
  bool loading_;
  std::string name_, group_;
};

}  // namespace floe
