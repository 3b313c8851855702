/// \file
/// Beams that crack (model.md section 11): strengths, one damage variable per beam with given
/// fracture energies, and what a run may ask of the cracks.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "beams/beam_force.h"
#include "floe/fracture/fracture_options.h"

namespace floe {

/// A beam that has broken.
struct Break {
  double time;        ///< of the state that it broke in [s]
  std::int32_t beam;  ///< global index
  Point3 place;       ///< middle of its two bodies then [m]
  double mode_mix;    ///< beta: part of shear and torsion in the energy at initiation
  double energy;      ///< that it has dissipated [J]
  double nominal;     ///< G A, what it should have [J]; less than `energy` if it was brittle
  bool brittle;       ///< it stored more than G A when it reached its strength
};

/// What a state in balance has done to the beams.
enum class Advance {
  none,      ///< nothing: the state stands
  softened,  ///< some have lost stiffness
  broke,     ///< one has broken
};

/// The cracks of a lattice: what breakable beams are beside a force. One state at a time;
/// collective where it says so.
class Fracture {
 public:
  Fracture() = default;
  Fracture(const Fracture&) = delete;
  Fracture& operator=(const Fracture&) = delete;
  virtual ~Fracture() = default;

  /// D of a local beam, as of the last commit.
  virtual double damage(std::int32_t beam) const = 0;
  /// The broken beams that this rank counts, in no particular order.
  virtual std::vector<Break> breaks() const = 0;
  /// Global bodies of the local beams (counted here or not) that the last commit broke: from then
  /// on they may touch.
  virtual std::span<const std::array<std::int32_t, 2>> released() const = 0;

  /// Statics. Largest s of the undamaged beams over all ranks: above 1 one has reached its
  /// strength. Collective.
  virtual double overload(const State<Spatial>& state) const = 0;
  /// Statics. Damage follows a state in balance: that of beams that soften, or one break (of the
  /// most overloaded beam). Collective.
  virtual Advance advance(const State<Spatial>& state) = 0;
  /// Statics. What advance() did since the last commit is taken back.
  virtual void retreat() = 0;
};

/// Breakable beams.
class BreakableForce {
 public:
  std::unique_ptr<BeamForce<Spatial>> force;
  Fracture* fracture;  ///< the same object
};

/// \param part  must outlive the force \throws InputError if the lattice does not give the
/// sections' sides. Collective.
BreakableForce make_breakable_beams(const Part& part, const BeamOptions& beams,
                                    const FractureOptions& fracture);

/// Largest s of a part's whole beams under section forces, without scatter. Collective.
/// \param sections  one per local beam
double overload(const Part& part, const std::vector<BeamSection>& sections,
                FractureOptions fracture);

/// Factor of beam `beam`'s strengths: (A_ref/A)^(1/m) (-ln U)^(1/m)/Gamma(1 + 1/m), U uniform in
/// (0, 1) from the seed and the beam's global index.
double weibull_factor(std::uint64_t seed, std::int32_t beam, double modulus, double area_ratio);

}  // namespace floe
