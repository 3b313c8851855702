/// \file
/// Decides when bodies move to other ranks, by what the ranks have to do.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "floe/run/result.h"
#include "model/model.h"

namespace floe {

/// Settings of a run whose bodies may move between ranks.
struct BalanceOptions {
  /// Bodies move when the busiest rank has more than this many times the mean load; 1: at each
  /// look.
  double threshold = 1.15;
  std::int64_t every = 1000;  ///< steps between looks
  Vec3<double> strips{};      ///< of owners_by_load()
  /// Divides the model by owner, with its forces at rest. Collective. Empty: bodies never move.
  std::function<void(const std::vector<std::int32_t>& owner)> divide;
};

/// Looks at the loads of the ranks every so many steps.
///
/// The load of a body is what its forces count (beams, touching pairs, clippings) times measured
/// times (BearsLoad), so all that is decided here follows from the states: a run that is repeated
/// or goes on from a checkpoint moves the same bodies at the same steps. Bodies move when the time
/// that ranks have waited for the busiest one since the last move exceeds the time that a move
/// takes (so the waiting costs at most twice what it would if the future were known), the
/// threshold is exceeded, and the new division takes away half of the excess at least.
class RankBalance {
 public:
  explicit RankBalance(const BalanceOptions& options) : options_(options) {}

  /// Whether bodies of this run can move.
  bool is_on() const { return static_cast<bool>(options_.divide); }
  /// Whether ranks look after this step.
  bool is_due(std::int64_t step) const { return is_on() && step > 0 && step % options_.every == 0; }
  /// First step after `step` at which ranks look; 2^63 - 1 if they never do.
  std::int64_t next_look(std::int64_t step) const;
  /// Returns the owners of a better division, if bodies should move now. To be called at each look.
  /// Collective.
  template <class Space>
  std::optional<std::vector<std::int32_t>> look(const Model<Space>& model,
                                                const State<Space>& state);
  /// Owners of the division of a checkpoint on as many ranks; empty: as at the start.
  const std::vector<std::int32_t>& owner() const { return owner_; }
  /// Forgets the division, since the bodies are others.
  void forget() { owner_.clear(); }
  const Moves& moves() const { return moves_; }
  /// Saves or loads the division and what has been waited. On another number of ranks the division
  /// is forgotten. Collective.
  void persist(Archive& archive, MPI_Comm comm);

 private:
  bool is_worth(const std::vector<double>& loads, std::int64_t bodies);

  BalanceOptions options_;
  std::vector<std::int32_t> owner_;
  double waited_ = 0;  ///< for the busiest rank since the last move [s]
  Moves moves_;
};

/// Returns the load of each owned body at a state, of which the forces are known [ns].
template <class Space>
std::vector<double> loads_of(const Model<Space>& model, const State<Space>& state);

}  // namespace floe
