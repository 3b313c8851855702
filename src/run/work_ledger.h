/// \file
/// The works of the forces over a run.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"

namespace floe {

/// The works that the forces have done on this rank's bodies since the start [J]: DoesWork::works()
/// numbers of each force that does work, in the order of the forces. Integrators add to them.
class WorkLedger {
 public:
  /// \param model  with all of its forces
  template <class Space>
  explicit WorkLedger(const Model<Space>& model) {
    for (const auto& force : model.forces()) {
      const auto* role = force->roles().work;
      open(force->name(), role != nullptr ? role->works() : 0);
    }
  }

  /// Returns the works of all forces, as Model::report() takes them. The place of the numbers does
  /// not change.
  std::span<double> all() { return works_; }
  std::span<const double> all() const { return works_; }
  /// Returns the works of force k of the model; none if it does no work.
  std::span<double> of(std::size_t k) {
    return all().subspan(first_[k], first_[k + 1] - first_[k]);
  }
  /// Saves the works to the archive, in a group of their own, or loads them from it. Collective.
  void persist(Archive& archive);

 private:
  void open(std::string_view force, std::size_t works);

  std::vector<double> works_;
  std::vector<std::string> names_;     ///< of the works, in a checkpoint
  std::vector<std::size_t> first_{0};  ///< per force: index of its first work; and their number
};

}  // namespace floe
