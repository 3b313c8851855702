/// \file
/// What bodies have lost by crushing (model.md, "Contact").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "contact/solids.h"
#include "floe/base/item.h"
#include "geometry/overlap.h"

namespace floe {

/// A cut: what a body has beyond a plane is lost.
struct WearCut {
  std::int32_t a = 0, b = 0;  ///< the pair whose contact parted
  std::int32_t body = 0;      ///< A or B
  HalfSpace left;             ///< what is left, in the frame of the body
  double volume = 0;          ///< what was crushed [m^3]

  static constexpr std::size_t numbers = 8;  ///< in a message or a checkpoint
  std::array<double, numbers> as_numbers() const;
  static WearCut from(std::span<const double, numbers> n);
};

/// The planes that crushing has cut off bodies. A body stays convex, and keeps its mass and moments
/// of inertia; water acts on the whole body. Of more than `most` planes on a body that whose
/// contact crushed least is forgotten.
class Wear {
 public:
  static constexpr std::size_t most = 8;

  /// Whether no body has lost anything.
  bool none() const { return worn_.empty(); }
  /// Returns what is left of a body, in its frame: the common part of it and these half-spaces.
  std::span<const HalfSpace> of(std::int32_t body) const {
    if (worn_.empty() || body < 0) return {};
    const std::int32_t place = item(place_, body);
    if (place < 0) return {};
    const Worn& worn = item(worn_, place);
    return {worn.left.data(), worn.planes};
  }
  /// Returns the bodies that have lost something.
  std::vector<std::int32_t> bodies() const;
  /// Takes over a cut. Planes beyond which others leave nothing are forgotten.
  void add(const Solids& solids, const WearCut& cut);

  /// Returns all cuts, body by body, as numbers of WearCut.
  std::vector<double> rows() const;
  /// Sets the cuts that rows() returned.
  void restore(const Solids& solids, std::span<const double> rows);

 private:
  struct Worn {
    std::int32_t body = 0;
    std::size_t planes = 0;
    std::array<HalfSpace, most> left{};
    std::array<double, most> volume{};
  };
  Worn& worn_of(const Solids& solids, std::int32_t body);

  std::vector<std::int32_t> place_;  ///< per body: its place in worn_, or -1; empty without wear
  std::vector<Worn> worn_;
};

/// Finds the plane across a direction that cuts a given volume off what is left of a body.
class CapFinder {
 public:
  /// A cap: the plane that cuts it off and its height along the direction.
  struct Cap {
    HalfSpace left;     ///< what is left, in the frame of the body
    double height = 0;  ///< [m]
  };
  /// \param out     direction of the cap, a unit vector in the frame of the body
  /// \param volume  of the cap [m^3]; at most half of what is left is cut off
  Cap find(const Solids& solids, const Wear& wear, std::int32_t body, const Vec3<double>& out,
           double volume);

 private:
  double volume(const Solids& solids, std::int32_t body);

  Clipper clipper_;
  std::vector<HalfSpace> planes_;  ///< work space
};

}  // namespace floe
