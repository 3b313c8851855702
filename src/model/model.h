/// \file
/// The model: a lattice's part on this rank, its forces, and which unknowns are prescribed.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "beams/beam_force.h"
#include "floe/forces/boundary.h"
#include "forces/force.h"
#include "fracture/fracture.h"

namespace floe {

/// A boundary with its bodies (local indices, ghosts included).
struct PlacedBoundary {
  Boundary boundary;
  std::vector<std::int32_t> bodies;
};

/// An unknown held to take a free rigid motion out of a static solve; it carries no reaction at
/// equilibrium.
struct Pin {
  std::int32_t body;  ///< global index
  int component;      ///< 0..5: x y z rx ry rz
};

/// One free rigid motion of one connected piece: u = t + r x (X - centre), spin r.
struct FreeMotion {
  std::int32_t piece;
  Point3 centre;
  double radius;  ///< of the piece about its centre [m]; r is in units of 1/radius
  std::array<double, 6> coefficients;  ///< t and r, of unit norm together
};

/// Free rigid motions of a lattice, piece by piece, and the pins that take them out.
struct FreeMotions {
  std::vector<FreeMotion> motions;
  std::vector<Pin> pins;
  std::vector<std::int32_t> piece;  ///< per body: its connected piece
};

/// \param held      per body, a bit for each of x y z rx ry rz that a boundary prescribes
/// \param floating  per body: cut by the water surface, which holds z, rx, ry of its piece;
///                  may be empty
/// \param avoid     bodies that should not be pinned if others can be (tests: the answer must
///                  not depend on it)
FreeMotions free_motions(const Lattice& lattice, std::span<const std::uint8_t> held,
                         std::span<const std::uint8_t> floating,
                         std::span<const std::uint8_t> avoid = {});

template <class Space>
class Model {
 public:
  static constexpr int n = Space::unknowns;

  /// \param lattice  whole, the same on every rank; needed during construction only
  /// \throws InputError for an unknown set or for two boundaries that prescribe one unknown
  /// differently
  Model(const Lattice& lattice, MPI_Comm comm, const std::vector<Boundary>& boundaries);
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  const Part& part() const { return part_; }
  /// Forgets the beams' sections and stiffnesses (forces have their own), not whom they join.
  void release_sections();
  /// Forgets what the bodies look like.
  void release_shapes() { part_.shapes = {}; }
  double length_scale() const { return length_scale_; }
  const std::vector<PlacedBoundary>& boundaries() const { return boundaries_; }

  void add_force(std::unique_ptr<Force<Space>> force) { forces_.push_back(std::move(force)); }
  void set_beams(std::unique_ptr<BeamForce<Space>> beams, Kinematics kinematics);
  const std::vector<std::unique_ptr<Force<Space>>>& forces() const { return forces_; }
  const BeamForce<Space>* beams() const { return beams_; }
  /// Beams that may break: the same object as the force that set_beams() gets.
  void set_fracture(Fracture* fracture) { fracture_ = fracture; }
  /// Null if nothing can break.
  Fracture* fracture() const { return fracture_; }
  Kinematics kinematics() const { return kinematics_; }

  /// What resists acceleration, per local body: its mass and that of the water it takes along [kg].
  const std::vector<double>& inertial_mass() const { return inertial_mass_; }
  /// Water that owned bodies take along [kg]; what a body weighs stays as it is.
  void add_mass(std::span<const double> added);

  /// All wrenches at a state whose ghosts are up to date.
  void evaluate(const State<Space>& state, Wrenches<Space>& wrenches) const;

  /// Squares of the wrenches of all forces but beams on this rank's bodies, moments divided by the
  /// length scale: summed over the forces, and of the forces' sum, in which weight and buoyancy
  /// cancel [N^2].
  struct Squares {
    double apart = 0, together = 0;
  };
  /// The same as evaluate(), by way of `share`.
  Squares evaluate_apart(const State<Space>& state, Wrenches<Space>& wrenches,
                         Wrenches<Space>& share) const;

  /// When ramps of boundaries and loads end, ascending, each once, without 0 [s].
  std::vector<double> ramp_ends() const;

  /// Prescribed unknowns, n bits per local body; held() includes the pins.
  std::span<const std::uint8_t> prescribed() const { return prescribed_; }
  std::span<const std::uint8_t> held() const { return held_; }
  /// Takes the pins of free motions over; those of components that the space does not have say
  /// nothing.
  void pin(const std::vector<Pin>& pins);
  /// Prescribed values at a time [m, rad] into n entries per local body; those that are free or
  /// pinned are left as they are. \param rows  per local body: where its n entries are, -1: nowhere
  void prescribe(double time, std::span<double> values,
                 std::span<const std::int32_t> rows = {}) const;
  /// Their rates [m/s, rad/s] and accelerations in the same form.
  void prescribe_rates(double time, std::span<double> rates) const;
  void prescribe_accelerations(double time, std::span<double> accelerations) const;

  /// Sums over all ranks of what the forces report.
  std::vector<std::pair<std::string, double>> report(const State<Space>& state) const;

 private:
  using Prescription = std::array<double, 6> (Boundary::*)(double) const;
  void spread(Prescription motion, double time, std::span<double> values,
              std::span<const std::int32_t> rows = {}) const;

  Part part_;
  double length_scale_ = 1;
  std::vector<double> inertial_mass_;
  std::vector<PlacedBoundary> boundaries_;
  std::vector<std::unique_ptr<Force<Space>>> forces_;
  BeamForce<Space>* beams_ = nullptr;
  Fracture* fracture_ = nullptr;
  Kinematics kinematics_ = Kinematics::corotational;
  std::vector<std::uint8_t> prescribed_, held_;
};

/// Bits of the prescribed components of every body of a lattice.
/// \throws InputError for an unknown set or for two boundaries that prescribe one component
/// differently
std::vector<std::uint8_t> prescribed_components(const Lattice& lattice,
                                                const std::vector<Boundary>& boundaries);

/// Checks that no load pushes a free motion, which would have no static equilibrium. Collective.
/// \param time  at which the loads are taken
/// \throws InputError naming the motion and the force on it
template <class Space>
void require_balance(const Model<Space>& model, const Lattice& lattice, const FreeMotions& free,
                     double time);

}  // namespace floe
