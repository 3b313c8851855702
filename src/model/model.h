/// \file
/// The model: the part of the lattice on this rank, its forces, and the prescribed unknowns.
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

/// A boundary and its bodies (local indices, ghosts included).
struct PlacedBoundary {
  Boundary boundary;
  std::vector<std::int32_t> bodies;
};

/// An unknown held to take a free rigid motion out of a static solution. At equilibrium the pin
/// carries no reaction.
struct Pin {
  std::int32_t body;  ///< global index
  int component;      ///< 0..5: x y z rx ry rz
};

/// A free rigid motion of a connected piece: displacement u = t + r x (X - centre), spin r.
struct FreeMotion {
  std::int32_t piece;
  Point3 centre;
  /// Radius of the piece about its centre [m]; r is in units of 1/radius.
  double radius;
  /// t and r, of unit norm together.
  std::array<double, 6> coefficients;
};

/// Free rigid motions of a lattice, piece by piece, and the pins that remove them.
struct FreeMotions {
  std::vector<FreeMotion> motions;
  std::vector<Pin> pins;
  std::vector<std::int32_t> piece;  ///< per body: its connected piece
};

/// Finds the rigid motions of each connected piece that neither boundaries nor water hold, and
/// chooses one pin for each (model.md, "Static solution").
/// \param held  per body: a bit for each of x y z rx ry rz that a boundary prescribes
/// \param floating  per body: whether the water surface cuts it, which holds z, rx, ry of its
///   piece; may be empty
/// \param avoid  per body: whether pins should go to other bodies if possible (for tests: the
///   answer must not depend on the choice); may be empty
FreeMotions free_motions(const Lattice& lattice, std::span<const std::uint8_t> held,
                         std::span<const std::uint8_t> floating,
                         std::span<const std::uint8_t> avoid = {});

/// The part of the lattice on this rank with its forces and prescribed unknowns.
template <class Space>
class Model {
 public:
  static constexpr int n = Space::unknowns;

  /// Partitions the lattice and places the boundaries. Collective.
  /// \param lattice  whole, the same on every rank; needed during construction only
  /// \param strips   of partition()
  /// \throws InputError for an unknown set or for two boundaries that prescribe one unknown
  ///   differently
  Model(const Lattice& lattice, MPI_Comm comm, const std::vector<Boundary>& boundaries,
        const Vec3<double>& strips = {});
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Divides the same lattice anew: part and boundaries, which keep their places in memory. Its
  /// forces are gone, as is what was added to the bodies and released. Collective.
  /// \param owner  of partition()
  void divide(const Lattice& lattice, const std::vector<std::int32_t>& owner);

  const Part& part() const { return part_; }
  /// Frees the sections and stiffnesses of the part's beams, of which forces keep their own copies.
  /// The pairs of bodies that the beams join stay.
  void release_sections();
  /// Frees the shapes of the bodies.
  void release_shapes() { part_.shapes = {}; }
  /// Length by which rotations are multiplied to be unknowns [m]: the mean beam length, or a body's
  /// radius of gyration in a lattice without beams.
  double length_scale() const { return length_scale_; }
  const std::vector<PlacedBoundary>& boundaries() const { return boundaries_; }

  void add_force(std::unique_ptr<Force<Space>> force) { forces_.push_back(std::move(force)); }
  void set_beams(std::unique_ptr<BeamForce<Space>> beams, Kinematics kinematics);
  const std::vector<std::unique_ptr<Force<Space>>>& forces() const { return forces_; }
  const BeamForce<Space>* beams() const { return beams_; }
  /// Registers the fracture of the beams, which is part of the force given to set_beams().
  void set_fracture(Fracture* fracture) { fracture_ = fracture; }
  /// Null if no beam can break.
  Fracture* fracture() const { return fracture_; }
  Kinematics kinematics() const { return kinematics_; }

  /// Mass that resists acceleration, per local body: the body's own and its added mass [kg].
  const std::vector<double>& inertial_mass() const { return inertial_mass_; }
  /// Adds the added mass of owned bodies [kg]; their weight does not change.
  void add_mass(std::span<const double> added);

  /// Added mass of an owned body along its principal axes [kg], and added moments of inertia about
  /// them [kg m^2].
  struct AddedInertia {
    Vec3<double> mass, moment;
  };
  /// Sets the added inertia of all owned bodies, which leapfrog in space takes along. The stable
  /// step leaves it out, and so is on the safe side.
  void set_added_inertia(std::vector<AddedInertia> added) { added_inertia_ = std::move(added); }
  /// Per owned body; empty: none.
  const std::vector<AddedInertia>& added_inertia() const { return added_inertia_; }

  /// Computes the wrenches of all forces at a state whose ghosts are up to date [N, N m].
  void evaluate(const State<Space>& state, Wrenches<Space>& wrenches) const;

  /// Squared norms of the wrenches of all forces except beams on this rank's bodies, moments
  /// divided by the length scale [N^2]. `apart` sums the squares of each force; `together` is the
  /// square of the sum of the forces, in which weight and buoyancy cancel.
  struct Squares {
    double apart = 0, together = 0;
  };
  /// Does the same as evaluate() and also returns the squares. \param share  room for the wrenches
  /// of a single force
  Squares evaluate_apart(const State<Space>& state, Wrenches<Space>& wrenches,
                         Wrenches<Space>& share) const;

  /// Times at which ramps of boundaries and loads end, and the rows of their tables up to `end`:
  /// ascending, without repetitions and without 0 [s].
  std::vector<double> changes(double end) const;

  /// Prescribed unknowns, n bits per local body; held() includes the pins too.
  std::span<const std::uint8_t> prescribed() const { return prescribed_; }
  std::span<const std::uint8_t> held() const { return held_; }
  /// Holds the unknowns of these pins in addition to the prescribed ones. Pins of components that
  /// the space does not have are ignored.
  void pin(const std::vector<Pin>& pins);
  /// Writes prescribed values at a time [m, rad] into n entries per local body. Entries of free and
  /// of pinned unknowns do not change.
  /// \param rows  per local body: the row of its n entries, -1 for none; empty: the local index
  void prescribe(double time, std::span<double> values,
                 std::span<const std::int32_t> rows = {}) const;
  /// The same for the rates [m/s, rad/s] and the accelerations [m/s^2, rad/s^2] of prescribed
  /// unknowns.
  void prescribe_rates(double time, std::span<double> rates) const;
  void prescribe_accelerations(double time, std::span<double> accelerations) const;

  /// Sums the columns that the forces report over all ranks. Collective.
  /// \param state  of the last evaluation
  /// \param works  of all forces until then, on this rank [J]: DoesWork::works() numbers of each
  ///               force that does work, in the order of forces()
  std::vector<std::pair<std::string, double>> report(const State<Space>& state,
                                                     std::span<const double> works) const;

 private:
  void place(const Lattice& lattice, const std::vector<Boundary>& boundaries);
  using Prescription = std::array<double, 6> (Boundary::*)(double) const;
  void spread(Prescription motion, double time, std::span<double> values,
              std::span<const std::int32_t> rows = {}) const;

  Part part_;
  double length_scale_ = 1;
  std::vector<double> inertial_mass_;
  std::vector<AddedInertia> added_inertia_;
  std::vector<PlacedBoundary> boundaries_;
  std::vector<std::unique_ptr<Force<Space>>> forces_;
  BeamForce<Space>* beams_ = nullptr;
  Fracture* fracture_ = nullptr;
  Kinematics kinematics_ = Kinematics::corotational;
  std::vector<std::uint8_t> prescribed_, held_;
};

/// Returns the bits of the prescribed components (x y z rx ry rz) of every body of a lattice.
/// \throws InputError for an unknown set or for two boundaries that prescribe one component
///   differently
std::vector<std::uint8_t> prescribed_components(const Lattice& lattice,
                                                const std::vector<Boundary>& boundaries);

/// Checks that no load pushes a free motion: no static equilibrium would exist. Collective.
/// \param time  the time at which the loads are taken [s]
/// \throws InputError naming the motion and its piece
template <class Space>
void require_balance(const Model<Space>& model, const Lattice& lattice, const FreeMotions& free,
                     double time);

}  // namespace floe
