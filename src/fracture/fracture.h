/// \file
/// Beams that crack: strengths, one damage variable per beam with given fracture energies, and
/// queries about the cracks (model.md, "Fracture").
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "beams/beam_force.h"
#include "floe/fracture/fracture_options.h"
#include "fracture_laws/crack_tips.h"

namespace floe {

/// A beam that has broken.
struct Break {
  double time;        ///< of the state in which the beam broke [s]
  std::int32_t beam;  ///< global index
  Point3 place;       ///< middle between the ends of its beam at this time [m]
  double mode_mix;    ///< beta: share of shear and torsion in the energy at initiation
  double energy;      ///< dissipated [J]
  double nominal;     ///< G A, the energy it should dissipate [J]; less than `energy` if brittle
  bool brittle;       ///< the beam stored more than G A when it reached its strength
  bool at_tip;        ///< it broke at a crack's tip, by the strength of tips
  double area;        ///< of its section [m^2]
};

/// Effect of a state in balance on the beams.
enum class Advance {
  none,      ///< no change: the state is accepted
  softened,  ///< beams have lost stiffness
  broke,     ///< one beam has broken
};

/// The cracks of a lattice: the second interface of breakable beams, beside the force. Functions
/// are collective only if so stated.
class Fracture {
 public:
  Fracture() = default;
  Fracture(const Fracture&) = delete;
  Fracture& operator=(const Fracture&) = delete;
  virtual ~Fracture() = default;

  /// Damage D of a local beam, as of the last commit; in statics advance() changes it too.
  virtual double damage(std::int32_t beam) const = 0;
  /// Broken beams whose energy this rank counts, in no particular order.
  virtual std::vector<Break> breaks() const = 0;
  /// Pairs of global bodies whose beam broke in the last commit, for all local beams (counted here
  /// or not). These bodies may touch from now on.
  virtual std::span<const std::array<std::int32_t, 2>> released() const = 0;

  /// For statics: largest s of the undamaged beams of all ranks; above 1 a beam has reached its
  /// strength. Collective.
  virtual double overload(const State<Spatial>& state) const = 0;
  /// For statics along a path: s over the s at which a beam next changes, the largest of all beams:
  /// over 1 for whole beams (at tips by their strengths), over kappa for those that soften, raised
  /// by `growth` times the lesser of kappa and s_u - 1. Collective.
  virtual double nearness_to_change(const State<Spatial>& state, double growth) const = 0;
  /// For statics: updates damage after a state in balance. All beams that soften are updated, and
  /// of the beams that would break only the most overloaded one. Collective.
  virtual Advance advance(const State<Spatial>& state) = 0;
  /// For statics: adds energy that left the system when beams broke or softened, and that no beam
  /// dissipated [J]; the same on all ranks.
  virtual void add_released(double energy) = 0;
  /// For statics: takes back all changes by advance() and add_released() since the last commit.
  virtual void retreat() = 0;
};

/// Breakable beams, by their two interfaces.
class BreakableForce {
 public:
  std::unique_ptr<BeamForce<Spatial>> force;
  Fracture* fracture;  ///< the same object
};

/// Makes the force of breakable beams. Collective.
/// \param part  must outlive the force
/// \param junctions  of the lattice; needed for Propagation::energy only
/// \throws InputError if the lattice does not give the sides of the sections
BreakableForce make_breakable_beams(const Part& part, const BeamOptions& beams,
                                    const FractureOptions& fracture, Junctions junctions = {});

}  // namespace floe
