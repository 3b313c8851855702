/// \file
/// The force of contacts between bodies, and between bodies and obstacles (model.md, "Contact").
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "floe/base/driven_motion.h"
#include "floe/contact/obstacle.h"
#include "floe/contact_laws/contact_options.h"
#include "floe/geometry/contact_of_pair.h"
#include "forces/force.h"

namespace floe {

/// Contacts as a force.
class Contact : public Force<Spatial> {
 public:
  /// A line for the user on overlaps in the state at rest; empty if none exceeds 1e-3 of the
  /// smaller size. The same on all ranks.
  virtual const std::string& overlap_at_start() const = 0;

  /// Returns where the motion of obstacle k, which no body carries, has it at a time [s].
  virtual DrivenMotion::Place place_of_obstacle(std::size_t k, double time) const = 0;
  /// Returns force [N] and moment [N m] of the last evaluation on each obstacle: about the origin
  /// of its frame, or about the centre of the body that carries it. Collective.
  virtual std::vector<std::array<Vec3<double>, 2>> obstacle_wrenches() const = 0;
  /// Returns the integral of the force on obstacle k since time 0 [N s], the same on all ranks.
  virtual const Vec3<double>& impulse(std::size_t k) const = 0;
  /// Gives obstacle k, which no body carries, another motion. To be called on all ranks.
  virtual void drive(std::size_t k, const DrivenMotion& motion) = 0;
  /// Keeps the forces of contacts from the next evaluation on, for contacts_here().
  virtual void keep_contacts() = 0;
  /// Returns the contacts of the last evaluation that this rank counts.
  virtual std::vector<ContactOfPair> contacts_here() const = 0;
};

/// The components of bodies that boundaries prescribe, and which no force changes.
struct PrescribedMotion {
  std::vector<std::uint8_t> bits;  ///< per local body: its prescribed components; empty: none
  /// Writes the accelerations of these components at a time [m/s^2, rad/s^2], six per local body.
  std::function<void(double time, std::span<double> accelerations)> accelerations;
};

/// Makes the force of contacts. Collective.
///
/// Reports energy_contact (stored), energy_contact_viscous, energy_friction, energy_crushing
/// (lost), energy_external (done by moving obstacles), contacts, contacts_enclosed (a body inside
/// another, without a force), and per obstacle NAME_force_x.., NAME_moment_x.. (about its point),
/// NAME_peak_force_x.. (largest so far), NAME_mean_force_x.. (over the run so far).
/// \param part     must outlive the force
/// \param lattice  whole; not used after construction
/// \param prescribed  what it names must outlive the force
/// Bodies of the lattice may have several convex parts that share no vertices.
/// \throws InputError if the lattice has no shapes, a part is not convex, parts overlap, a body
/// lies wholly inside another or inside an obstacle, or overlaps it by more than a tenth of the
/// smaller size (unless initial_overlap is stress_free)
std::unique_ptr<Contact> make_contact(const Part& part, const Lattice& lattice,
                                      const ContactOptions& options,
                                      std::vector<Obstacle> obstacles,
                                      PrescribedMotion prescribed = {});

}  // namespace floe
