/// \file
/// Beams at the tips of cracks: their strengths there, their overloads by the opening of the crack,
/// and the breaks by which a crack grows (model.md, "Fracture").
#pragma once

#include <cstdint>
#include <vector>

#include "floe/fracture/fracture_options.h"
#include "floe/lattice/state.h"
#include "fracture_laws/crack_tips.h"
#include "fracture_laws/law.h"
#include "lattice/archive.h"
#include "lattice/partition.h"

namespace floe {

/// A beam at a tip whose stress is looked at.
struct ArmedBeam {
  double s;           ///< s_t, by the strengths of tips
  std::int32_t beam;  ///< local index
};

/// The overload of a beam at a tip.
struct TipOverload {
  std::int32_t beam;  ///< global index
  double s;
  bool operator==(const TipOverload&) const = default;
  auto operator<=>(const TipOverload&) const = default;
};
/// Overload of a beam in a sorted list, 0 if it is not there.
double overload_of(std::int32_t beam, const std::vector<TipOverload>& sorted);

/// The beams of a part that are at tips, and those that broke there. The beams' cracks are not
/// here: who holds them says which beams are gone, and asks for the strengths of those that change.
class TipBeams {
 public:
  /// A tip beam is looked at from this s_t on, however wide the crack is open.
  static constexpr double armed_from = 0.5;
  /// Local beams that a change concerns, with repetitions.
  struct Change {
    std::vector<std::int32_t> strengths;  ///< their strengths are to be set anew
    std::vector<std::int32_t> doomed;     ///< now, or no longer: is_doomed() changed
  };
  /// Strengths of one beam.
  struct Strengths {
    Strength<double> first;
    FurtherStrength<double> further;
  };

  /// \param part    must outlive the object
  /// \param linear  rotations are linearised
  TipBeams(const Part& part, const FractureOptions& options, bool linear, Junctions junctions);

  /// Whether a local beam is at a tip and its strength there can be below that of its initiation.
  /// \param whole  strength at initiation
  bool weakens(std::int32_t m, const Strength<double>& whole) const;
  /// Strengths of a local beam that its tip weakens: s is 1 where s_t is armed_from, or at
  /// initiation.
  /// \param whole  strengths at initiation
  Strengths armed(std::int32_t m, const Strengths& whole) const;
  /// Overloads of beams at tips, those of all ranks: s^2 = s_o min(s_o, s_t) with s_t by the beam's
  /// stress and s_o^2 = G/G_f by the opening of the crack behind it, at either end of its facet.
  /// Collective. \return sorted by beam
  std::vector<TipOverload> overloads(const std::vector<ArmedBeam>& mine,
                                     const State<Spatial>& state) const;

  /// Whether a local beam breaks in the next evaluation, whatever its s.
  bool is_doomed(std::int32_t m) const { return doomed_[static_cast<std::size_t>(m)] != 0; }
  /// Dynamics: the breaks of a step become known to all ranks. Of the overloaded beams at tips
  /// those break that are at a tip when their turn comes, by falling s: they go in the next
  /// evaluation. Collective.
  /// \param broken      local beams that broke in the step
  /// \param overloaded  armed beams of the step's evaluation
  Change propagate(const std::vector<std::int32_t>& broken,
                   const std::vector<ArmedBeam>& overloaded, const State<Spatial>& state);

  /// Statics: notes that a global beam is gone; to be called alike on all ranks.
  Change lose(std::int32_t global);
  /// Statics: the beams that are gone stay so.
  void keep();
  /// Statics: makes whole again what was lost since the last keep(). All strengths change.
  void retreat();

  /// Saves or loads the doomed beams; loading also loses those and the broken ones. All strengths
  /// change. Collective.
  /// \param cracks  those of all ranks when loading, with global beams
  Change persist(Archive& archive, const std::vector<Crack>& cracks);

 private:
  static constexpr std::int32_t none = -1;

  std::int32_t local_beam(std::int32_t global) const;
  void lose(std::int32_t global, Change& change);
  void doom(std::int32_t global, Change& change);
  double bent_opening(std::int32_t m) const;
  std::vector<BodyPose> poses_of(const std::vector<std::int32_t>& bodies,
                                 const State<Spatial>& state) const;

  const Part& part_;
  const FractureOptions options_;
  const bool linear_;
  CrackTips tips_;
  std::vector<std::uint8_t> doomed_;      ///< per local beam
  std::vector<std::int32_t> all_doomed_;  ///< of all ranks, global
  /// Statics: global beams that went since the last keep(), and before.
  std::vector<std::int32_t> lost_, lost_before_;
};

}  // namespace floe
