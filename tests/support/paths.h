/// \file
/// Static paths with the load factor as an unknown, in process.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "paths/path.h"
#include "support/frames.h"
#include "support/static_solution.h"

namespace floe::test {

/// Every accepted state of a path.
template <class Space>
struct PathSolution {
  std::unique_ptr<Model<Space>> model;
  std::vector<PlacedLoad> loads;
  std::vector<State<Space>> states;
  std::vector<std::map<std::string, double>> columns;  ///< of the forces and of the path
  RunResult result;

  std::vector<double> column(const std::string& name) const {
    std::vector<double> all;
    for (const auto& row : columns) all.push_back(row.at(name));
    return all;
  }
  double last(const std::string& name) const { return columns.back().at(name); }
};

/// Makes the scene's loads and motions linear in the load factor, as the scene's reader does.
inline Scene along_path(Scene scene) {
  for (Load& load : scene.loads) load.ramp.endless = true;
  for (Boundary& b : scene.boundaries) b.ramp.endless = true;
  return scene;
}

template <class Space>
PathSolution<Space> follow(const Scene& scene, const Lattice& lattice, PathOptions<Space> options,
                           MPI_Comm comm = PETSC_COMM_SELF) {
  PathSolution<Space> s;
  const Scene linear = along_path(scene);
  s.loads = place_loads(linear, lattice);
  s.model = std::make_unique<Model<Space>>(lattice, comm, linear.boundaries);
  add_forces(linear, s.loads, *s.model, &lattice);
  hold_free_motions(linear, lattice, *s.model);
  options.full_time = scene.time.end;
  const auto run =
      make_path_run<Space>(*s.model, std::move(options), [&](const Accepted<Space>& a) {
        s.states.push_back(a.state);
        auto& row = s.columns.emplace_back(a.forces.begin(), a.forces.end());
        row.insert(a.columns.begin(), a.columns.end());
      });
  s.result = run_to_end(*run);
  return s;
}

/// The end of a path where a component of a body's displacement has a value; on one rank.
template <class Space>
PathEnd<Space> at_displacement(std::size_t body, std::size_t component, double value) {
  return {[=](const State<Space>& s) { return displacement(s, body)[component]; }, value};
}

/// A boundary that holds a set's place in the plane; the body may turn about z.
inline Boundary hinge(const std::string& set) {
  Boundary b;
  b.name = b.set = set;
  b.fixed = {true, true, true, true, true, false};
  return b;
}
inline Boundary clamp(const std::string& set) {
  Boundary b = hinge(set);
  b.fixed.fill(true);
  return b;
}
inline Load dead_load(const std::string& set, const Point3& force) {
  Load load;
  load.name = load.set = set;
  load.force = force;
  load.ramp.seconds = 1;
  return load;
}

/// The frame of Lee, Manuel & Rossow (1968) of 1.2 m, EI = 1440 N m^2; `elements` of each member.
inline Lattice lee_frame(int elements) {
  const FrameSection section{6e-4, 4.5e-8, 2e-8, 5e-8, 7.2e10, 3.6e10, 5.0 / 6};
  std::vector<Point3> points, axis_y;
  for (int k = 0; k <= 2 * elements; ++k) {
    const double s = 1.2 * k / elements;
    points.push_back(k <= elements ? Point3{0, s, 0} : Point3{s - 1.2, 1.2, 0});
    if (k > 0) axis_y.push_back(k <= elements ? Point3{-1, 0, 0} : Point3{0, 1, 0});
  }
  Lattice lattice = frame(points, section, axis_y);
  lattice.sets["load"] = {elements + elements / 5};
  return lattice;
}
inline Scene lee_scene() {
  Scene scene;
  scene.forces.beam = true;
  scene.beam.shear = Shear::none;
  scene.boundaries = {hinge("root"), hinge("tip")};
  scene.loads = {dead_load("load", {0, -1000, 0})};  // the load factor is P L^2/EI
  return scene;
}

}  // namespace floe::test
