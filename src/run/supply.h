/// \file
/// Ice that joins and leaves a run.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "floe/forces/boundary.h"
#include "lattice/archive.h"
#include "lattice/renumbering.h"

namespace floe {

/// The places of all bodies and the broken beams, on every rank.
struct IceNow {
  double time = 0;                   ///< [s]
  std::vector<Point3> places;        ///< of centroids [m]
  std::vector<std::int32_t> broken;  ///< beams, sorted
  std::array<double, 2> edge{};      ///< displacement of the far edge [m]
};

/// The far edge of a sheet whose motion is not prescribed.
struct FreeEdge {
  std::function<std::vector<std::int32_t>()> bodies;  ///< at the edge
  /// Strain of the ice by the mean pressure on the edge, > 0 if compressed.
  std::function<double()> strain;
  /// Whether the edge goes as it is pushed; else ice is due by the motion of the ice behind.
  bool is_pushed = false;
};

/// Settings of a run in which ice joins and leaves. Functions are collective, and what they decide
/// is the same on all ranks.
struct SupplyOptions {
  std::int64_t every = 50;  ///< steps between looks
  std::int32_t others = 0;  ///< bodies behind the ice, which neither join nor leave
  /// The motion of the far edge, with which ice joins.
  Boundary edge;
  std::optional<FreeEdge> free_edge;  ///< given: ice joins with what the edge does indeed
  /// Whether ice is to join when the far edge has come so far [m].
  std::function<bool(double way)> is_due;
  /// Called before a change, with the names of the run's columns.
  std::function<void(const std::vector<std::string>& columns)> before_change = [](const auto&) {};
  /// Bodies that are to leave, sorted.
  std::function<std::vector<std::int32_t>(const IceNow&)> leaving;
  /// Divides the model anew without these bodies.
  std::function<Renumbering(const IceNow&, const std::vector<std::int32_t>& gone)> leave;
  /// Whether there is more ice.
  std::function<bool()> can_join;
  /// Divides the model anew with the next strip, whose bodies come last and are compressed so.
  std::function<Renumbering(const IceNow&, double strain)> join;
  /// Counts the look at which ice was due.
  std::function<void()> end_look;
  /// Saves the names of the bodies, or loads them and divides the model so.
  std::function<void(Archive&)> persist;
};

/// What has joined or left since the start of a run.
struct IceAmount {
  double bodies = 0, mass = 0;       ///< [kg]
  std::array<double, 3> momentum{};  ///< [kg m/s]
  double energy = 0;                 ///< that the ledger counts [J]
  void persist(Archive& archive, const std::string& name);
};

/// The account of the ice of a run, summed over ranks.
struct IceAccount {
  double bodies = 0;  ///< at present
  IceAmount joined, left;
  void persist(Archive& archive);
  /// Columns of history.csv.
  std::vector<std::pair<std::string, double>> columns() const;
};

}  // namespace floe
