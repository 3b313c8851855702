/// \file
/// One breakable beam between two bodies that are moved by hand.
#pragma once

#include <memory>
#include <string>

#include "floe/base/petsc.h"
#include "fracture/fracture.h"
#include "support/frames.h"
#include "support/roles.h"
#include "support/states.h"

namespace floe::test {

/// A beam along x of section w x h, young 4 GPa, nu = 0.3.
inline Lattice one_beam(double length, double w, double h) {
  FrameSection section;
  section.area = w * h;
  section.inertia_y = w * h * h * h / 12;
  section.inertia_z = h * w * w * w / 12;
  section.torsion = saint_venant_torsion(w, h);
  section.young = 4e9;
  section.shear_modulus = 4e9 / 2.6;
  Lattice lattice = straight_frame(length, 1, section);
  lattice.beams.width = {w};
  lattice.beams.height = {h};
  return lattice;
}

/// Strains of the beam: body 0 rests, or turns by half; small enough to be linear.
struct Strain {
  double delta = 0, gamma_y = 0, gamma_z = 0;  ///< [m]
  Vec3<double> psi{0, 0, 0};                   ///< [rad]
};
inline Strain operator*(double a, const Strain& s) {
  return {a * s.delta, a * s.gamma_y, a * s.gamma_z, a * s.psi};
}

class OneBeam {
 public:
  OneBeam(const Lattice& lattice, const FractureOptions& options, double damping = 0,
          Kinematics kinematics = Kinematics::linear)
      : lattice_(lattice), part_(partition(lattice, PETSC_COMM_SELF)), state_(2), wrenches_(2) {
    BeamOptions beams;
    beams.kinematics = kinematics;
    beams.damping_ratio = damping;
    auto made = make_breakable_beams(part_, beams, options);
    force = std::move(made.force);
    fracture = made.fracture;
    linear_ = kinematics == Kinematics::linear;
  }

  /// To the given strains within `dt`: evaluated, and, in dynamics, committed. Adds the work of the
  /// mean of the forces at both ends (what leapfrog's ledger counts).
  void go(const Strain& to, double dt = 1) {
    const Wrenches<Spatial> before = wrenches_;
    const State<Spatial> from = state_;
    put(to, dt, from);
    evaluate();
    for (std::size_t b = 0; b < 2; ++b) {
      for (std::size_t k = 0; k < 6; ++k)
        work -= 0.5 * (before.of(b)[k] + wrenches_.of(b)[k]) * dt * rate(b, k);
    }
    commit(*force, state_, dt);
    state_.time += dt;
  }
  /// Statics: to the given strains, damage following.
  void settle(const Strain& to) {
    put(to, 1, state_);
    while (fracture->advance(state_) != Advance::none) {
    }
    evaluate();
    commit(*force, state_, 1);
  }
  void evaluate() {
    std::fill(wrenches_.values.begin(), wrenches_.values.end(), 0.0);
    force->add(state_, wrenches_);
  }
  double reported(const std::string& name) const {
    double sum = 0;
    const Columns columns = report(*force, state_);
    for (const auto& [column, value] : columns.values()) sum += column == name ? value : 0;
    return sum;
  }
  /// Force and moment on body 1.
  const double* on_end() const { return wrenches_.of(1); }
  const State<Spatial>& state() const { return state_; }
  const Part& part() const { return part_; }

  std::unique_ptr<BeamForce<Spatial>> force;
  Fracture* fracture = nullptr;
  double work = 0;  ///< done on the beam [J]

 private:
  double rate(std::size_t b, std::size_t k) const {
    return state_.record(
        b)[(k < 3 ? Spatial::velocity : Spatial::angular_velocity - 3) + static_cast<int>(k)];
  }
  void put(const Strain& s, double dt, const State<Spatial>& from) {
    // Both bodies turn by half of psi, in opposite senses; shears by displacement alone.
    const std::array<double, 3> u{s.delta, s.gamma_y, s.gamma_z};
    const std::array<double, 3> half{0.5 * s.psi.x, 0.5 * s.psi.y, 0.5 * s.psi.z};
    for (std::size_t b = 0; b < 2; ++b) {
      double* r = state_.record(b);
      const double* old = from.record(b);
      const double sign = b == 0 ? -1 : 1;
      const Vec3<double> turn{sign * half[0], sign * half[1], sign * half[2]};
      const Quat<double> q =
          linear_ ? Quat<double>{1, 0.5 * turn.x, 0.5 * turn.y, 0.5 * turn.z} : exp_rotation(turn);
      const std::array<double, 4> now{q.w, q.x, q.y, q.z};
      std::array<double, 6> v{};
      for (std::size_t k = 0; k < 3; ++k) {
        v[k] = b == 0 ? 0 : (u[k] - old[k]) / dt;
        v[3 + k] = 2 * (now[1 + k] - old[static_cast<std::size_t>(Spatial::rotation) + 1 + k]) / dt;
      }
      for (std::size_t k = 0; k < 3; ++k) r[k] = b == 0 ? 0 : u[k];
      for (std::size_t k = 0; k < 4; ++k)
        r[static_cast<std::size_t>(Spatial::rotation) + k] = now[k];
      for (std::size_t k = 0; k < 6; ++k) r[static_cast<std::size_t>(Spatial::velocity) + k] = v[k];
    }
  }

  Lattice lattice_;
  Part part_;
  State<Spatial> state_;
  Wrenches<Spatial> wrenches_;
  bool linear_ = true;
};

}  // namespace floe::test
