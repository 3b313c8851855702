/// \file
/// Facets between bodies in plan, the junctions where they meet, and tips of cracks: junctions of
/// which exactly one facet is gone (model.md, "Fracture").
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "floe/beams/moduli.h"
#include "floe/lattice/lattice.h"

namespace floe {

/// The facet between two bodies; a beam joins them unless a cut took it.
struct CrackFacet {
  std::array<std::int32_t, 2> bodies;  ///< global
  std::int32_t beam;                   ///< global, or none
  /// At its two ends, or none where it ends at the outline.
  std::array<std::int32_t, 2> junctions;
  Point3 middle;              ///< at rest, at mid-height [m]
  std::array<Point3, 2> arm;  ///< to the middle from the bodies' centroids at rest [m]
  double width;               ///< [m]
};

/// The facets that meet others inside the lattice, and where they meet.
struct Junctions {
  static constexpr std::int32_t none = -1;
  std::vector<CrackFacet> facets;
  std::vector<Point2> places;  ///< per junction: in plan at rest [m]
  /// Junction k has the facets facets_at[first[k]] to facets_at[first[k + 1] - 1], three or more.
  std::vector<std::int32_t> first, facets_at;
  std::vector<std::int32_t> facet_of;          ///< per global beam: its facet, or none
  LatticeModuli moduli{1, 0, 0.5, 0.5, 1, 0};  ///< of the sheet, D over E_b h^3/12

  std::int32_t size() const { return static_cast<std::int32_t>(places.size()); }
  std::span<const std::int32_t> at(std::int32_t junction) const {
    const auto k = static_cast<std::size_t>(junction);
    return std::span(facets_at).subspan(static_cast<std::size_t>(first[k]),
                                        static_cast<std::size_t>(first[k + 1] - first[k]));
  }
};

/// Finds the junctions of a lattice of prisms from the vertices of its shapes. Places on the
/// outline are none. Not collective.
/// \param shear  stiffness of the beams in shear, of which the sheet's moduli follow
/// \throws InputError if the lattice has beams and no shapes
Junctions find_junctions(const Lattice& lattice, Shear shear);

/// The gone facets behind a tip, the nearest first.
struct CrackBehind {
  static constexpr std::size_t most = 8, least = 3;
  static constexpr std::size_t farthest = 64;  ///< facets within which the other tip is looked for
  std::array<std::int32_t, most> facets;
  std::size_t size = 0;
  Point2 tip;  ///< [m], at rest
  /// Distance of the crack's other tip [m]; infinite where the crack comes from the outline or
  /// another crack, or is longer than `farthest` facets.
  double length = std::numeric_limits<double>::infinity();
};

/// BodyPose of a body: displacement [m] and rotation from rest.
struct BodyPose {
  Vec3<double> u;
  Quat<double> q;
};

/// The junctions of the whole lattice with the facets that are gone; every rank holds the same.
class CrackTips {
 public:
  explicit CrackTips(Junctions junctions);

  const Junctions& junctions() const { return junctions_; }

  /// Whether exactly one facet at an end of this beam's facet is gone, and the beam is not.
  /// \param beam  global index
  bool is_tip(std::int32_t beam) const;
  /// Notes that a beam is gone. \return whether it was not before
  bool lose(std::int32_t beam);
  /// Makes all beams whole again; cuts stay.
  void reset();
  /// The cracks that have their tip at an end of this beam's facet. A crack is followed from its
  /// tip as long as no other crack meets it; those shorter than CrackBehind::least are left out.
  std::vector<CrackBehind> behind(std::int32_t beam) const;
  /// Appends the bodies beside these cracks, with repetitions.
  void append_bodies(std::span<const CrackBehind> cracks, std::vector<std::int32_t>& bodies) const;
  /// (pi/32) c^2, times the sheet's E* the energy release rate that a crack's opening shows [m]: c
  /// is that of the mode I whose hoop stress is the largest ahead of the tip, by the fit of
  /// (c + b r) sqrt(r (1 - r/L)) to the jumps over its facets, and of c sqrt(r (1 - r/L)) to their
  /// turns; r is their distance from the tip, L that of its other tip. Faces that press on each
  /// other are not open (model.md, "Fracture").
  /// \param bent     weight of the faces' turn against each other, D/(h E*) (1 - nu)(3 + nu) [m^2]
  /// \param linear   rotations are linearised
  /// \param pose_of  of a global body
  double opening(const CrackBehind& crack, double bent, bool linear,
                 const std::function<BodyPose(std::int32_t)>& pose_of) const;
  /// Calls `visit` for each beam that shares a junction with a beam, itself included.
  void for_neighbours(std::int32_t beam, auto&& visit) const {
    visit(beam);
    const std::int32_t facet = junctions_.facet_of[static_cast<std::size_t>(beam)];
    if (facet == Junctions::none) return;
    for (const std::int32_t junction : junctions_.facets[static_cast<std::size_t>(facet)].junctions)
      if (junction != Junctions::none) {
        for (const std::int32_t f : junctions_.at(junction)) {
          const std::int32_t other = junctions_.facets[static_cast<std::size_t>(f)].beam;
          if (other != Junctions::none && other != beam) visit(other);
        }
      }
  }

 private:
  /// The facet at a junction that is gone and is not `facet`, if it is the only one; else none.
  std::int32_t goes_on(std::int32_t junction, std::int32_t facet) const;
  CrackBehind behind_junction(std::int32_t junction) const;

  Junctions junctions_;
  std::vector<std::uint8_t> gone_;  ///< per facet
  std::vector<std::uint8_t> lost_;  ///< per junction: number of its facets that are gone
};

}  // namespace floe
