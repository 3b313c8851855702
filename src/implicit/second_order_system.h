/// \file
/// Newton's and Euler's equations of the bodies as one system F(t, X, V, A) = 0 of second order,
/// for implicit integrators (model.md, "Implicit dynamics").
///
/// Vectors hold a block of n numbers per body in the tangent's rows: X is the displacement [m] and
/// the running sum of rotation increments times the length scale (ImplicitRotations), V and A are
/// the rates of X. F is the inertia forces less the wrenches, moments divided by the length scale
/// [N]; it is 0 for prescribed unknowns, which prescribe() sets.
#pragma once

#include <span>
#include <vector>

#include "floe/base/petsc.h"
#include "implicit/implicit_rotations.h"
#include "implicit/liealpha.h"
#include "model/model.h"

namespace floe {

/// The system of second order on this rank's owned bodies.
template <class Space>
class SecondOrderSystem {
 public:
  static constexpr int n = Space::unknowns;

  /// \param state  state of the model's bodies, which these equations set
  /// \param model, state  must outlive this object
  SecondOrderSystem(Model<Space>& model, State<Space>& state);

  Mat matrix() const { return tangent_.matrix(); }
  /// Creates a vector of the unknowns.
  Handle<Vec> make_vector() const;

  /// Sets X and V at the state's time: at rest, with the bodies' initial velocities, prescribed
  /// unknowns at their prescribed values.
  void begin(Vec x, Vec v);
  /// Solves F(t, x, v, A) = 0 for A.
  void acceleration(double time, Vec x, Vec v, Vec a);
  /// Sets the prescribed unknowns of a stage.
  void prescribe(double time, const LieAlphaStage& stage) const;
  /// Sets the state from X and V and updates the ghosts. Collective.
  void take(double time, Vec x, Vec v);
  /// Moves the rotations' reference to the state, which must be that of X.
  void rebase(Vec x);

  /// Computes F into f. Collective.
  void residual(double time, Vec x, Vec v, Vec a, Vec f);
  /// Assembles dF/dX into the matrix, where V and A change with X by their factors. Collective.
  void assemble(double time, Vec x, Vec v, Vec a, double by_velocity, double by_acceleration);
  /// Factor of A in the assembled matrix; 0 before the first assembly.
  double by_acceleration() const { return assembled_.by_acceleration; }
  /// Saves or loads the data of the last assembly. After loading the matrix is the same to the last
  /// bit.
  void persist(Archive& archive);

  /// Returns the tolerance of the residual [N]: `relative` times the size of the forces in the last
  /// residual, at least the rounding in it and `absolute`. External forces count by their sum, so
  /// that weight and buoyancy of a sheet cancel; reactions and inertia forces are added.
  /// Collective.
  double tolerance(double relative, double absolute) const;

  /// Forces that the energies of a step need: inertia forces, reactions of boundaries, and losses
  /// by velocities; n per owned body, moments in the unknowns' frames and divided by the length
  /// scale [N].
  struct Forces {
    std::vector<double> inertia, reaction;
    std::vector<std::vector<double>>
        losses;  ///< of each force that has losses, in the order of forces
  };
  /// Computes these forces at the state, whose V and A are given.
  void forces(Vec v, Vec a, const Wrenches<Space>& wrenches, Forces& all) const;
  /// Kinetic energy of this rank's bodies [J], and the square of their largest speed [m^2/s^2],
  /// which is not finite if a body's speed is not.
  double kinetic(Vec v) const;
  double largest_speed2() const;
  /// Prescribed unknowns of owned bodies; whether an unknown is a displacement, and the mass of its
  /// body [kg].
  const std::vector<std::size_t>& held() const { return held_; }
  bool is_displacement(std::size_t k) const { return k % unknowns < moves; }
  double mass_of(std::size_t k) const { return model_.inertial_mass()[k / unknowns]; }

 private:
  using Turn = ImplicitRotations<Space>;
  using TurnVector = typename Turn::Vector;
  static constexpr auto moves = static_cast<std::size_t>(Space::translations);
  static constexpr auto unknowns = static_cast<std::size_t>(n);

  TurnVector turn_of(std::span<const double> vector, std::size_t body) const;
  TurnVector moment_of(const Wrenches<Space>& wrenches, std::size_t body) const;
  void put_in_frame(const Wrenches<Space>& wrenches, std::vector<double>& values) const;
  void set_frames(std::span<const double> x, double by_velocity);
  void add_inertia(std::span<const double> x, std::span<const double> v, std::span<const double> a,
                   double by_velocity, double by_acceleration);
  bool is_held(std::size_t k) const {
    return (model_.prescribed()[k / unknowns] >> (k % unknowns) & 1U) != 0;
  }

  Model<Space>& model_;
  const Part& part_;
  State<Space>& state_;
  Turn turning_;
  Tangent<Space> tangent_;
  Wrenches<Space> wrenches_;
  mutable Wrenches<Space> share_;  ///< work space
  std::size_t owned_;
  double length_;
  std::vector<std::size_t> held_;   ///< prescribed unknowns of owned bodies
  std::vector<double> stiffness_;   ///< bound per owned body [N/m]
  std::vector<double> increments_;  ///< of rotations, per local body, for the frames (work space)
  std::vector<TurnFrame> frames_, velocity_frames_;
  mutable std::vector<double> values_, rates_, accelerations_;  ///< prescribed (work space)
  double sizes2_ = 0, rounding2_ = 0;  ///< of the last residual, on this rank [N^2]
  struct {
    double time = 0, by_velocity = 0, by_acceleration = 0;
    Handle<Vec> x, v, a;
    std::vector<double> references;
  } assembled_;  ///< state and factors of the last assembly
};

}  // namespace floe
