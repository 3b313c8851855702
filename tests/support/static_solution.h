/// \file
/// A lattice brought to equilibrium in process, by the same functions that main calls.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene_model/scene_model.h"

namespace floe::test {

/// An option of PETSc's database for as long as the object lives.
class PetscOption {
 public:
  PetscOption(std::string name, const std::string& value) : name_(std::move(name)) {
    check(PetscOptionsSetValue(nullptr, name_.c_str(), value.c_str()));
  }
  ~PetscOption() { (void)PetscOptionsClearValue(nullptr, name_.c_str()); }
  PetscOption(const PetscOption&) = delete;
  PetscOption& operator=(const PetscOption&) = delete;

 private:
  std::string name_;
};

/// Every accepted state of a static run on one process; bodies and beams are numbered as in the
/// lattice.
template <class Space>
struct StaticSolutionIn {
  std::unique_ptr<Model<Space>> model;
  std::vector<PlacedLoad> loads;
  std::vector<State<Space>> states;       ///< the first at time 0, then one per load step
  std::map<std::string, double> columns;  ///< of the forces, at the last state
  Wrenches<Space> wrenches;               ///< of the last state; minus the reactions where held
  RunResult result;

  const State<Space>& first() const { return states.front(); }
  const State<Space>& last() const { return states.back(); }
};
using StaticSolution = StaticSolutionIn<Spatial>;

/// \param pins  hold these instead of what hold_free_motions would choose
template <class Space = Spatial>
StaticSolutionIn<Space> solve_static(const Scene& scene, const Lattice& lattice,
                                     const std::vector<Pin>* pins = nullptr) {
  StaticSolutionIn<Space> s;
  s.loads = place_loads(scene, lattice);
  s.model = std::make_unique<Model<Space>>(lattice, PETSC_COMM_SELF, scene.boundaries);
  add_forces(scene, s.loads, *s.model, &lattice);
  if (pins != nullptr) {
    s.model->pin(*pins);
  } else {
    hold_free_motions(scene, lattice, *s.model);
  }
  std::optional<OutOfPlane> rest;
  if constexpr (std::is_same_v<Space, Planar>)
    rest = out_of_plane(scene, lattice, s.loads, s.model->part());
  s.result = run_quasistatic(
      *s.model, {scene.time.end, scene.time.dt},
      [&](const Accepted<Space>& a) {
        s.states.push_back(a.state);
        s.wrenches = a.wrenches;
        s.columns = {a.forces.begin(), a.forces.end()};
      },
      rest ? &*rest : nullptr);
  EXPECT_TRUE(s.result.done) << s.result.message;
  return s;
}

/// The lattice that a scene's sheet becomes. The mesh is made by this process alone.
inline Lattice mesh_of(const Scene& scene) {
  MeshReport report;
  return make_lattice(scene, PETSC_COMM_SELF, report);
}

/// Displacement of the point where load `k` acts [m]: of the body's centroid, and the turning of
/// its arm.
inline Vec3<double> displacement_of_load(const StaticSolution& s, const State<Spatial>& state,
                                         std::size_t k = 0) {
  const PlacedLoad& load = s.loads[k];
  const auto b = static_cast<std::size_t>(load.bodies[0]);
  return displacement(state, b) + (rotate(rotation(state, b), load.arm) - load.arm);
}

inline std::string name_of(Shear shear) {
  constexpr const char* names[] = {"one_point", "exact", "none"};
  return names[static_cast<int>(shear)];
}

inline std::string name_of(Kinematics kinematics) {
  return kinematics == Kinematics::linear ? "linear" : "co-rotational";
}

inline constexpr Shear all_shears[] = {Shear::exact, Shear::one_point, Shear::none};

}  // namespace floe::test
