/// \file
/// Contacts of bodies with each other and with obstacles, as a force of a model.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "contact/contacts.h"
#include "forces/force.h"

namespace floe {

class Contact : public Force<Spatial> {
 public:
  /// What overlaps in the state at rest: a line for the user, empty if nothing does by more than
  /// 1e-3 of a size. The same on all ranks.
  virtual const std::string& overlap_at_start() const = 0;
};

/// Reports energy_contact (stored), energy_contact_viscous, energy_friction, energy_crushing
/// (lost), energy_external of moving obstacles, contacts, contacts_enclosed (of a body inside
/// another, which has no force), and per obstacle NAME_force_x..,
/// NAME_moment_x.. (about its point), NAME_peak_force_x.. (largest so far), NAME_mean_force_x..
/// (over the run so far). \param part  must outlive the force   \param lattice  whole; needed
/// during construction only \throws InputError if the lattice has no shapes, one is not convex, or
/// a body lies wholly inside another or an obstacle, or overlaps it by more than a tenth of the
/// smaller size (unless initial_overlap is stress_free). Collective.
std::unique_ptr<Contact> make_contact(const Part& part, const Lattice& lattice,
                                      const ContactOptions& options,
                                      std::vector<Obstacle> obstacles);

}  // namespace floe
