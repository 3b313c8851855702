/// \file
/// The histories of the beams of a part that have reached their strengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/item.h"
#include "fracture_laws/law.h"
#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

/// The cracks of local beams, in the order of their initiation.
class Cracks {
 public:
  explicit Cracks(std::size_t beams) : crack_of_(beams, none) {}

  std::size_t beams() const { return crack_of_.size(); }
  const std::vector<Crack>& all() const { return all_; }

  /// Returns the crack of a beam; null: it has none.
  const Crack* of(std::int32_t beam) const {
    const std::int32_t at = item(crack_of_, beam);
    return at == none ? nullptr : &item(all_, at);
  }
  bool is_broken(std::int32_t beam) const {
    const Crack* c = of(beam);
    return c != nullptr && c->broken();
  }
  /// Largest s of a beam so far that counts: 1 without a crack.
  double kappa(std::int32_t beam) const {
    const Crack* c = of(beam);
    return c != nullptr ? c->kappa : 1.0;
  }

  /// Enters a crack, instead of the one that its beam had.
  void put(const Crack& crack) {
    std::int32_t& at = item(crack_of_, crack.beam);
    if (at == none) {
      at = static_cast<std::int32_t>(all_.size());
      all_.push_back(crack);
    } else {
      item(all_, at) = crack;
    }
  }
  /// Makes all beams undamaged, and returns the cracks that they had.
  std::vector<Crack> clear() {
    std::vector<Crack> had = std::move(all_);
    all_.clear();
    for (const Crack& c : had) item(crack_of_, c.beam) = none;
    return had;
  }

  /// Numbers of a crack, for a back end: as device::Damage has them.
  static constexpr std::size_t numbers = 12;
  /// Returns the numbers of each beam's crack after each other; kappa is 0 where there is none.
  std::vector<double> as_numbers() const;
  static Crack of_numbers(std::int32_t beam, std::span<const double, numbers> v);

 private:
  static constexpr std::int32_t none = -1;
  std::vector<std::int32_t> crack_of_;  ///< per beam: index in all_, or none
  std::vector<Crack> all_;
};

/// Saves the cracks of all ranks to the archive, or loads them all on every rank. Collective.
/// \param cracks  those that this rank counts, with global beams; loading: those of all ranks
void persist_cracks(Archive& archive, const Part& part, std::vector<Crack>& cracks);

}  // namespace floe
