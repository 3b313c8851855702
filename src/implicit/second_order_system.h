/// \file
/// Newton's and Euler's equations of the bodies as one system F(t, X, V, A) = 0 of second order,
/// for implicit integrators (model.md section 9).
///
/// Vectors hold a block of n numbers per body in the tangent's rows: X displacement [m] and the
/// running sum of rotation increments times the length scale (ImplicitRotations), V and A their
/// rates. F is the inertia forces less the wrenches, moments divided by the length scale [N]; 0 for
/// prescribed unknowns, which prescribe() sets.
#pragma once

#include <span>
#include <vector>

#include "floe/base/petsc.h"
#include "implicit/implicit_rotations.h"
#include "implicit/liealpha.h"
#include "model/model.h"

namespace floe {

template <class Space>
class SecondOrderSystem {
 public:
  static constexpr int n = Space::unknowns;

  /// \param state  of the model's bodies, which these equations set; both must outlive this
  SecondOrderSystem(Model<Space>& model, State<Space>& state);

  Mat matrix() const { return tangent_.matrix(); }
  /// A vector of the unknowns.
  Handle<Vec> make_vector() const;

  /// X and V at the state's time: at rest, with the bodies' first velocities; prescribed unknowns
  /// as prescribed.
  void begin(Vec x, Vec v);
  /// A of F(t, x, v, A) = 0.
  void acceleration(double time, Vec x, Vec v, Vec a);
  /// Prescribed unknowns of a stage.
  void prescribe(double time, const LieAlphaStage& stage) const;
  /// The state of X and V, ghosts included.
  void take(double time, Vec x, Vec v);
  /// Moves the rotations' reference to the state, which is that of X.
  void rebase(Vec x);

  void residual(double time, Vec x, Vec v, Vec a, Vec f);
  /// dF/dX as V and A go with X by their factors, into the matrix.
  void assemble(double time, Vec x, Vec v, Vec a, double by_velocity, double by_acceleration);
  /// The factor of A in the matrix as it stands; 0 before the first.
  double by_acceleration() const { return assembled_.by_acceleration; }
  /// What the matrix was assembled from: after loading it stands again as it was, to the last bit.
  void persist(Archive& archive);

  /// What the residual must fall below: `relative` times the size of the forces in the last
  /// residual (external ones together, so that a sheet's weight on water has no say; reactions,
  /// inertia), never below the rounding in it. Collective. [N]
  double tolerance(double relative, double absolute) const;

  /// What a step's books need at the state, whose V and A these are, n per owned body, moments in
  /// the unknowns' frames and divided by the length scale: inertia forces, what boundaries exert,
  /// what velocities take.
  struct Forces {
    std::vector<double> inertia, reaction;
    std::vector<std::vector<double>> losses;  ///< of each force that has any, in their order
  };
  void forces(Vec v, Vec a, const Wrenches<Space>& wrenches, Forces& all) const;
  /// This rank's kinetic energy [J], and the square of its bodies' largest speed [m^2/s^2] (not
  /// finite if one is not).
  double kinetic(Vec v) const;
  double largest_speed2() const;
  /// Prescribed displacements of owned bodies (not rotations), and what resists them.
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
  std::vector<double> increments_;  ///< of rotations, per local body: what frames need (work space)
  std::vector<TurnFrame> frames_, velocity_frames_;
  mutable std::vector<double> values_, rates_, accelerations_;  ///< prescribed (work space)
  double sizes2_ = 0, rounding2_ = 0;  ///< of the last residual, this rank [N^2]
  struct {
    double time = 0, by_velocity = 0, by_acceleration = 0;
    Handle<Vec> x, v, a;
    std::vector<double> references;
  } assembled_;  ///< what the matrix was made of
};

}  // namespace floe
