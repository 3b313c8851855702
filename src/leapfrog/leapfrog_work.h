/// \file
/// The quadrature of leapfrog: works of the forces from their powers.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "forces/force.h"

namespace floe {

/// Integrates the powers of the forces over steps of leapfrog.
///
/// Velocities are known half a step apart. From t_n to t_n+1 the forces F_n and F_n+1 at the two
/// ends of the step do the work dt/2 (F_n + F_n+1).v_n+1/2, by which the kinetic energy
/// 1/2 v_n-1/2.M v_n+1/2 of LeapfrogStepper::energies() grows, to rounding. So F_n does the work
/// dt/2 F_n.v_n-1/2 over the step before t_n, with the power of the evaluation, and
/// dt/2 F_n.v_n+1/2 over the step after it. By LaterPowers:
/// - at_once: both halves are added at the end of the step that begins at t_n.
/// - in_next_evaluation: the second half and the first half of the next force are added at the end
///   of the next step, since the evaluation at t_n+1 tells both.
/// - never, for dashpots: F_n = -C v_n-1/2, so a step loses
///   dt/2 v_n+1/2.C (v_n-1/2 + v_n+1/2). With v_n+1/2.C v_n-1/2 taken as the mean of the powers
///   p_n, p_n+1 of the evaluations at its ends this is dt (p_n/4 + 3 p_n+1/4), of second order.
///   Summed over the steps to t_n it is dt (p_0/4 + p_1 + ... + p_n-1 + 3 p_n/4).
template <class Space>
class LeapfrogWork {
 public:
  /// \param forces  in order; they and the works must outlive this object
  /// \param works   of the forces that do work [J], as WorkLedger::all()
  LeapfrogWork(std::span<const std::unique_ptr<Force<Space>>> forces, std::span<double> works);

  /// Takes the powers of the last evaluation. To be called before the forces commit its step.
  void take_powers();
  /// Adds the works of a step. To be called after take_powers(), and after the forces have
  /// committed the step.
  /// \param state  after the step
  /// \param dt     length of the step [s]
  void take_step(const State<Space>& state, double dt);
  /// Returns the works up to the time of the last evaluation, whose step was not committed [J].
  std::vector<double> works() const;
  /// Length of the last step [s]; 0 before the first one.
  double last_dt() const { return last_dt_; }
  /// Sets it, where steps were made elsewhere.
  void set_last_dt(double dt) { last_dt_ = dt; }
  /// Saves or loads the length of the last step. The works are the owner's to keep.
  void persist(Archive& archive) { archive.common("last_dt", last_dt_, not_negative); }

 private:
  /// A force that does work, and where its numbers lie.
  struct Worker {
    const DoesWork<Space>* force;
    std::size_t first, count;
    std::span<double> in(std::span<double> all) const { return all.subspan(first, count); }
    /// Asks for the powers of the last evaluation, and for the kept ones where they are needed.
    void ask(std::span<double> powers, std::span<double> kept) const;
  };

  std::vector<Worker> workers_;
  std::span<double> works_;
  // Per work, of the last evaluation, asked before its step is committed [W]:
  std::vector<double> powers_, kept_;
  std::vector<double> later_;  ///< work space of take_step()
  double last_dt_ = 0;
};

}  // namespace floe
