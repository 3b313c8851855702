// What lives on one rank only: a boundary, a load, a motion, an obstacle, a crack, all the beams.
// Every integrator gives what it gives on one process; that it ends at all is half of the test (the
// ranks are compared at every step: base/audit.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/audit.h"
#include "explicit/explicit.h"
#include "floe/base/petsc.h"
#include "implicit/implicit.h"
#include "scene_model/scene_model.h"
#include "support/lattices.h"
#include "support/static_solution.h"

namespace floe {
namespace {

enum class By { statics, leapfrog, rk, fixed_steps, adaptive_steps };
constexpr const char* names[] = {"statics", "leapfrog", "rk", "fixed steps", "adaptive steps"};

/// A floating sheet with a set per rank, `rank0` and so on, of the bodies that it owns.
Lattice sheet_with_ranks() {
  Lattice s = test::sheet(10, 8, 1.5, true);
  reorder(s);
  const Part part = partition(s, PETSC_COMM_WORLD);
  std::vector<int> owner(s.bodies.mass.size(), 0);
  for (std::int32_t b = 0; b < part.owned; ++b)
    owner[static_cast<std::size_t>(part.global[static_cast<std::size_t>(b)])] = rank();
  MPI_Allreduce(MPI_IN_PLACE, owner.data(), static_cast<int>(owner.size()), MPI_INT, MPI_SUM,
                PETSC_COMM_WORLD);
  for (std::size_t b = 0; b < owner.size(); ++b)
    s.sets["rank" + std::to_string(owner[b])].push_back(static_cast<std::int32_t>(b));
  return s;
}

std::string set_of(int r) { return "rank" + std::to_string(r); }

struct Ending {
  RunResult result;
  std::vector<double> u;  ///< of all bodies [m]
  std::int64_t breaks = 0;
};

template <class Space>
Ending run(const Scene& scene, const Lattice& lattice, MPI_Comm comm, By by) {
  const auto loads = place_loads(scene, lattice);
  Model<Space> model(lattice, comm, scene.boundaries);
  add_forces(scene, loads, model, &lattice);
  add_contact(scene, lattice, model);
  Ending ending;
  const auto look = [&](const Accepted<Space>& a) {
    ending.u.assign(lattice.bodies.mass.size() * 3, 0);
    for (std::size_t b = 0; b < static_cast<std::size_t>(model.part().owned); ++b)
      std::copy_n(a.state.record(b), Space::translations,
                  ending.u.begin() + 3 * static_cast<std::ptrdiff_t>(model.part().global[b]));
  };
  ExplicitOptions options;
  options.end = scene.time.end;
  options.dt = scene.time.dt;
  if (by == By::statics) {
    hold_free_motions(scene, lattice, model);
    std::optional<OutOfPlane> rest;
    if constexpr (std::is_same_v<Space, Planar>)
      rest = out_of_plane(scene, lattice, loads, model.part());
    ending.result =
        run_quasistatic(model, {1, 0.25}, Observer<Space>(look), rest ? &*rest : nullptr);
  } else if (by == By::leapfrog) {
    ending.result = run_explicit(model, options, Observer<Space>(look));
  } else if constexpr (std::is_same_v<Space, Spatial>) {
    if (by == By::rk) {
      const test::PetscOption type("-ts_type", "rk");
      ending.result = run_explicit(model, options, Observer<Space>(look));
    } else {
      options.dt = by == By::adaptive_steps ? 0 : options.end / 7;
      ending.result = run_implicit(model, options, Observer<Space>(look));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, ending.u.data(), static_cast<int>(ending.u.size()), MPI_DOUBLE,
                MPI_SUM, comm);
  if (model.fracture() != nullptr) {
    ending.breaks = static_cast<std::int64_t>(model.fracture()->breaks().size());
    MPI_Allreduce(MPI_IN_PLACE, &ending.breaks, 1, MPI_INT64_T, MPI_SUM, comm);
  }
  return ending;
}

/// \param relative  of the largest displacement: what the solver's rounding may become
template <class Space>
Ending expect_same(const Scene& scene, const Lattice& lattice, By by, double relative = 1e-9) {
  SCOPED_TRACE(std::string(names[static_cast<int>(by)]) +
               (std::is_same_v<Space, Planar> ? ", planar" : ", spatial"));
  const Ending together = run<Space>(scene, lattice, PETSC_COMM_WORLD, by),
               alone = run<Space>(scene, lattice, PETSC_COMM_SELF, by);
  EXPECT_TRUE(together.result.done) << together.result.message;
  EXPECT_TRUE(alone.result.done) << alone.result.message;
  EXPECT_EQ(together.breaks, alone.breaks);
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < alone.u.size(); ++k) {
    largest = std::max(largest, std::abs(alone.u[k]));
    difference = std::max(difference, std::abs(together.u[k] - alone.u[k]));
  }
  EXPECT_GT(largest, 1e-9);
  EXPECT_LE(difference, relative * largest);
  return alone;
}

/// A scene of a sheet, for all integrators. \param planar  nothing acts out of the plane
Scene scene_of(bool planar) {
  Scene scene;
  scene.forces.beam = true;
  scene.forces.gravity = scene.forces.buoyancy = !planar;
  scene.time.end = 0.01;
  scene.time.dt = 2.5e-5;
  return scene;
}

Boundary clamp(const std::string& set, bool planar) {
  Boundary b;
  b.name = "clamp", b.set = set;
  b.fixed = {true, true, !planar, !planar, !planar, true};
  return b;
}

Load pull(const std::string& set, bool planar) {
  Load load;
  load.name = "pull", load.set = set;
  load.force = {1e5, -5e4, planar ? 0.0 : -3e4};
  load.ramp.seconds = 0.005;
  return load;
}

/// For each rank and each way of stepping. \param check  is given the rank's set
void everywhere(const std::function<void(const std::string& set, bool planar, By by)>& check) {
  for (int r = 0; r < size(); ++r) {
    SCOPED_TRACE("on rank " + std::to_string(r));
    for (const bool planar : {false, true}) {
      for (const By by : {By::statics, By::leapfrog}) check(set_of(r), planar, by);
    }
    for (const By by : {By::rk, By::fixed_steps, By::adaptive_steps}) check(set_of(r), false, by);
  }
}

void expect_same_in(const Scene& scene, const Lattice& lattice, bool planar, By by) {
  planar ? expect_same<Planar>(scene, lattice, by) : expect_same<Spatial>(scene, lattice, by);
}

TEST(OnOneRank, ABoundary) {
  if (size() == 1) GTEST_SKIP();  // it would hold all bodies
  const Lattice lattice = sheet_with_ranks();
  everywhere([&](const std::string& set, bool planar, By by) {
    Scene scene = scene_of(planar);
    scene.boundaries = {clamp(set, planar)};
    scene.loads = {pull("all", planar)};
    expect_same_in(scene, lattice, planar, by);
  });
}

TEST(OnOneRank, ABoundaryThatMoves) {
  const Lattice lattice = sheet_with_ranks();
  everywhere([&](const std::string& set, bool planar, By by) {
    Scene scene = scene_of(planar);
    scene.boundaries = {clamp(set, planar)};
    scene.boundaries[0].velocity = Point3{0.1, 0.05, 0};
    scene.boundaries[0].ramp.seconds = 0.004;
    expect_same_in(scene, lattice, planar, by);
  });
}

/// As in the report of a hang: nothing but beams and a clamp, that is, nothing moves at all.
TEST(OnOneRank, AClampAlone) {
  const Lattice lattice = sheet_with_ranks();
  for (int r = 0; r < size(); ++r) {
    for (const By by : {By::fixed_steps, By::adaptive_steps}) {
      Scene scene = scene_of(false);
      scene.forces.gravity = scene.forces.buoyancy = false;
      scene.boundaries = {clamp(set_of(r), false)};
      const Ending ending = run<Spatial>(scene, lattice, PETSC_COMM_WORLD, by);
      EXPECT_TRUE(ending.result.done) << ending.result.message;
      EXPECT_EQ(*std::max_element(ending.u.begin(), ending.u.end()), 0);
    }
  }
}

TEST(OnOneRank, ALoad) {
  const Lattice lattice = sheet_with_ranks();
  everywhere([&](const std::string& set, bool planar, By by) {
    Scene scene = scene_of(planar);
    scene.loads = {pull(set, planar)};
    if (by == By::statics) scene.boundaries = {clamp("left", planar)};
    expect_same_in(scene, lattice, planar, by);
  });
}

TEST(OnOneRank, AMotion) {
  everywhere([&](const std::string& set, bool planar, By by) {
    if (by == By::statics) return;
    Lattice lattice = sheet_with_ranks();
    Scene scene = scene_of(planar);
    scene.initials = {{"i", set, {0.3, -0.2, planar ? 0.0 : 0.1}, {0, 0, 0.1}}};
    set_initial(scene, lattice);
    expect_same_in(scene, lattice, planar, by);
  });
}

/// The others own loose bodies and no beam.
TEST(OnOneRank, AllBeams) {
  everywhere([&](const std::string& set, bool planar, By by) {
    Lattice lattice = sheet_with_ranks();
    const auto& here = lattice.sets.at(set);
    Lattice joined = lattice;
    Beams& all = joined.beams;
    std::vector<std::size_t> kept;
    for (std::size_t m = 0; m < all.bodies.size(); ++m) {
      if (std::binary_search(here.begin(), here.end(), all.bodies[m][0]) &&
          std::binary_search(here.begin(), here.end(), all.bodies[m][1]))
        kept.push_back(m);
    }
    const auto keep = [&](auto& values) {
      if (values.empty()) return;
      for (std::size_t k = 0; k < kept.size(); ++k) values[k] = values[kept[k]];
      values.resize(kept.size());
    };
    keep(all.bodies), keep(all.area), keep(all.inertia_y), keep(all.inertia_z), keep(all.torsion);
    keep(all.length), keep(all.young), keep(all.shear_modulus), keep(all.shear_factor);
    keep(all.shear_factor_y), keep(all.axis_y), keep(all.width), keep(all.height);
    keep(all.offsets);
    Scene scene = scene_of(planar);
    scene.beam.damping_ratio = by == By::statics ? 0 : 0.1;
    // On the body with most beams; in statics the rank's other bodies hold it.
    std::vector<int> beams(lattice.bodies.mass.size(), 0);
    for (const auto& pair : all.bodies) ++beams[static_cast<std::size_t>(pair[0])];
    for (const auto& pair : all.bodies) ++beams[static_cast<std::size_t>(pair[1])];
    const auto most =
        static_cast<std::int32_t>(std::max_element(beams.begin(), beams.end()) - beams.begin());
    joined.sets["pushed"] = {most};
    scene.loads = {pull("pushed", planar)};
    if (by == By::statics) {
      for (const std::int32_t b : here) {
        if (b != most) joined.sets["held"].push_back(b);
      }
      scene.boundaries = {clamp("held", planar)};
    }
    expect_same_in(scene, joined, planar, by);
  });
}

TEST(OnOneRank, AnObstacle) {
  for (int r = 0; r < size(); ++r) {
    SCOPED_TRACE("on rank " + std::to_string(r));
    const Lattice lattice = sheet_with_ranks();
    const Point3& at =
        lattice.bodies.position[static_cast<std::size_t>(lattice.sets.at(set_of(r))[2])];
    Scene scene = scene_of(false);
    scene.integrator = Integrator::explicit_;
    scene.forces.contact = true;
    scene.contact.young = 1e8;
    Obstacle hammer = box({at[0], at[1], at[2] + 0.36}, {0.2, 0.2, 0.06}, {10, 20, 30});
    hammer.name = "hammer";
    hammer.motion.velocity = {0, 0, -20};
    scene.obstacles = {hammer};
    (void)expect_same<Spatial>(scene, lattice, By::leapfrog);
  }
}

/// A body that is torn out of the sheet breaks its beams, which are one rank's (or two's).
TEST(OnOneRank, Breaks) {
  for (int r = 0; r < size(); ++r) {
    SCOPED_TRACE("on rank " + std::to_string(r));
    Lattice lattice = sheet_with_ranks();
    const auto &here = lattice.sets.at(set_of(r)), &left = lattice.sets.at("left");
    lattice.sets["torn"] = {*std::find_if(here.rbegin(), here.rend(), [&](std::int32_t b) {
      return std::find(left.begin(), left.end(), b) == left.end();
    })};
    for (const By by : {By::statics, By::leapfrog}) {
      const bool dynamic = by == By::leapfrog;
      Scene scene = scene_of(true);
      scene.integrator = dynamic ? Integrator::explicit_ : Integrator::quasistatic;
      scene.forces.fracture = true;
      scene.fracture.dynamic = dynamic;
      scene.forces.contact = dynamic;
      scene.contact.young = 1e8;
      Boundary held = clamp("left", false), torn = clamp("torn", false);
      torn.displacement = Point3{0, 0, 0.02};
      torn.ramp.seconds = dynamic ? 0.008 : 1;
      scene.boundaries = {held, torn};
      const Ending ending = expect_same<Spatial>(scene, lattice, by, 1e-6);
      EXPECT_GT(ending.breaks, 2);
    }
  }
}

TEST(Audit, FindsAVectorThatOnlySomeRanksOpened) {
  if (size() == 1) GTEST_SKIP();
  Handle<Vec> vec;
  check(VecCreateMPI(PETSC_COMM_WORLD, 3, PETSC_DETERMINE, vec.put()));
  const auto look = [&] {
    audit(PETSC_COMM_WORLD, "here", std::array{PetscObject{}, object_of(vec.get())});
  };
  EXPECT_NO_THROW(look());
  if (rank() == 1) {
    double* values = nullptr;
    check(VecGetArray(vec, &values));
    check(VecRestoreArray(vec, &values));
  }
  EXPECT_THROW(look(), std::logic_error);
  const auto number = [](double value) {
    audit(PETSC_COMM_WORLD, "here", {}, std::array{1.0, value});
  };
  EXPECT_NO_THROW(number(2));
  EXPECT_NO_THROW(number(std::nan("")));
  EXPECT_THROW(number(rank() == 0 ? 2 : 2 + 1e-15), std::logic_error);
  set_auditing(false);
  EXPECT_NO_THROW(look());
  set_auditing(true);
}

}  // namespace
}  // namespace floe
