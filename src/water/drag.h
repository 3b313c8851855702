/// \file
/// Drag of the water on moving bodies.
#pragma once

#include <memory>

#include "floe/water/drag_options.h"
#include "floe/water/wave_options.h"
#include "forces/force.h"
#include "submersion/submersion.h"
#include "submersion/submersion_in_waves.h"

namespace floe {

/// Makes the force -(c + rho_w C_d |v|/2) A_p (V/V_0) v at the centroid of each owned body, with v
/// the velocity relative to the water, A_p the plan area of the body at rest and V/V_0 the
/// submerged part of its volume (model.md, "Water"). Reports as `energy_drag` the energy that the
/// bodies have lost to the water; energy gained from a current counts as negative.
/// \param part  with shapes; must outlive the force
/// \throws InputError if the lattice has no shapes
template <class Space>
std::unique_ptr<Force<Space>> make_drag(const Part& part, const DragOptions& options);

/// The same by submerged parts that buoyancy calls in each step.
std::unique_ptr<Force<Spatial>> make_drag(std::shared_ptr<Submersion> submersion,
                                          const DragOptions& options);

/// Makes drag on the wetted faces of the owned bodies (DragOptions::faces), or in waves, or both
/// (model.md, "Water"). With u the velocity of the water less that of the body at a point of a face
/// with the outward normal n, u_t the part of u along the face: rho_w C_d/2 (u.n)^2 (-n) per area
/// where u.n < 0, and rho_w C_s/2 |u_t| u_t; on faces that nothing shelters. The force at the
/// centroid of make_drag() comes on top. In waves the velocity of the water is the current's and
/// the waves', and faces are wet below the local plane of the surface.
/// \param part     with shapes; must outlive the force
/// \param gravity  of the waves [m/s^2]
/// \throws InputError if the lattice has no shapes, or a wave is shorter than 8 bodies; collective
std::unique_ptr<Force<Spatial>> make_face_drag(const Part& part, const DragOptions& options,
                                               double gravity, const WaveOptions& waves);

/// The same by submerged parts that other forces use too. With a pace, drag on faces of a body is
/// computed when its submerged part is, and in between follows the body's velocity to first order.
/// \param leads  no other force calls the submerged parts in each step: this one does
std::unique_ptr<Force<Spatial>> make_face_drag(std::shared_ptr<Submersion> submersion,
                                               const DragOptions& options, bool leads);
std::unique_ptr<Force<Spatial>> make_face_drag(std::shared_ptr<SubmersionInWaves> submersion,
                                               const DragOptions& options, bool leads);

}  // namespace floe
