// What a checkpoint keeps comes back to the last bit; what is not there, or of another lattice, is
// refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "leapfrog/leapfrog_work.h"
#include "run/checkpoint.h"
#include "run/work_ledger.h"
#include "scene_model/scene_model.h"
#include "support/lattices.h"
#include "support/roles.h"

namespace floe::test {
namespace {

/// A checkpoint file in a folder that is removed when the test ends.
class Kept {
 public:
  explicit Kept(const std::string& lattice = "of a lattice") {
    folder_ = std::filesystem::temp_directory_path() /
              ("floe_checkpoint_" + std::to_string(size()) + "_" + std::to_string(first_rank()));
    std::filesystem::create_directories(folder_);
    options.file = options.restart = (folder_ / "checkpoint.h5").string();
    options.stop_file = options.file + ".stop";
    options.lattice = lattice;
    options.options = "forces: [beam]\n";
  }
  ~Kept() {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank() == 0) std::filesystem::remove_all(folder_);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  CheckpointOptions options;

 private:
  static int first_rank() {
    int id = getpid();
    MPI_Bcast(&id, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    return id;
  }
  std::filesystem::path folder_;
};

/// Numbers of every kind that something remembers.
struct Remembered {
  double number = 0;
  std::int64_t count = 0;
  bool yes = false;
  std::string words;
  std::vector<double> list;
  double share = 0;
  std::vector<double> rows;

  void persist(Archive& archive, const std::vector<std::int32_t>& bodies) {
    archive.enter("a");
    archive.common("number", number);
    archive.common("count", count);
    archive.common("yes", yes);
    archive.common("words", words);
    archive.enter("b");
    archive.common("list", list);
    archive.share("share", share);
    archive.rows("rows", bodies, rows, 3);
  }
};

class Checkpoint : public testing::Test {
 protected:
  Part part = partition(sheet(6, 5, 1), PETSC_COMM_WORLD);
  std::vector<std::int32_t> owned = std::vector<std::int32_t>(static_cast<std::size_t>(part.owned));
  Checkpoint() { std::iota(owned.begin(), owned.end(), 0); }

  Remembered some() const {
    Remembered r{std::nextafter(0.1, 1),  (std::int64_t{1} << 53) - 1, true, "two words",
                 {1e-308, -0.0, 1.0 / 3}, 0.1 * (rank() + 1),          {}};
    for (const std::int32_t body : owned) {
      const double g = part.global[static_cast<std::size_t>(body)];
      r.rows.insert(r.rows.end(), {g, std::sin(g), 1 / (g + 1)});
    }
    return r;
  }
};

TEST_F(Checkpoint, GivesBackWhatItWasGiven) {
  const Kept kept;
  Remembered before = some();
  Checkpoints(kept.options, part).save([&](Archive& archive) { before.persist(archive, owned); });
  Remembered after;
  after.rows.resize(3 * owned.size());
  Checkpoints(kept.options, part).load([&](Archive& archive) {
    EXPECT_TRUE(archive.loading());
    after.persist(archive, owned);
  });
  const Remembered as_it_was = some();
  EXPECT_EQ(after.number, as_it_was.number);
  EXPECT_EQ(after.count, as_it_was.count);
  EXPECT_EQ(after.yes, as_it_was.yes);
  EXPECT_EQ(after.words, as_it_was.words);
  EXPECT_EQ(after.list, as_it_was.list);
  EXPECT_TRUE(std::signbit(after.list[1]));
  EXPECT_EQ(after.share, as_it_was.share);
  EXPECT_EQ(after.rows, as_it_was.rows);
}

TEST_F(Checkpoint, RowsAndSharesComeToOneRankFromMany) {
  const Kept kept;
  Remembered before = some();
  Checkpoints(kept.options, part).save([&](Archive& archive) { before.persist(archive, owned); });
  // Every rank alone reads the file, as a run on one rank would.
  const Part whole = partition(sheet(6, 5, 1), PETSC_COMM_SELF);
  std::vector<std::int32_t> all(static_cast<std::size_t>(whole.owned));
  std::iota(all.begin(), all.end(), 0);
  Remembered after;
  after.rows.resize(3 * all.size());
  MPI_Barrier(PETSC_COMM_WORLD);
  Checkpoints(kept.options, whole).load([&](Archive& archive) { after.persist(archive, all); });
  EXPECT_NEAR(after.share, 0.1 * size() * (size() + 1) / 2, 1e-15);
  for (std::size_t b = 0; b < all.size(); ++b) {
    const double g = whole.global[b];
    EXPECT_EQ(after.rows[3 * b], g);
    EXPECT_EQ(after.rows[3 * b + 1], std::sin(g));
  }
}

TEST_F(Checkpoint, RefusesWhatIsNotThereAndWhatIsOfAnotherLattice) {
  const Kept kept;
  Remembered r = some();
  Checkpoints(kept.options, part).save([&](Archive& archive) { r.persist(archive, owned); });
  EXPECT_THROW(Checkpoints(kept.options, part).load([](Archive& archive) {
    double missing = 0;
    archive.enter("a");
    archive.common("missing", missing);
  }),
               InputError);
  EXPECT_THROW(Checkpoints(kept.options, part).load([](Archive& archive) {
    double one = 0;
    archive.enter("b");
    archive.common("list", one);
  }),
               InputError);
  CheckpointOptions other = kept.options;
  other.obstacles = "others";
  EXPECT_THROW(Checkpoints(other, part).load([](Archive&) {}), OtherRun);
  other.obstacles = kept.options.obstacles;
  other.lattice = "of another";
  EXPECT_THROW(Checkpoints(other, part).load([](Archive&) {}), InputError);
  other = kept.options;
  other.restart += ".nowhere";
  EXPECT_THROW(Checkpoints(other, part).load([](Archive&) {}), InputError);
}

TEST_F(Checkpoint, KeepsTheGenerationBefore) {
  const Kept kept;
  Checkpoints checkpoints(kept.options, part);
  const std::string older = previous_checkpoint(kept.options.file);
  for (const double number : {1.0, 2.0, 3.0}) {
    Remembered r = some();
    r.number = number;
    checkpoints.save([&](Archive& archive) { r.persist(archive, owned); });
  }
  const auto number_in = [&](const std::string& file) {
    CheckpointOptions options = kept.options;
    options.restart = file;
    Remembered r;
    r.rows.resize(3 * owned.size());
    Checkpoints(options, part).load([&](Archive& archive) { r.persist(archive, owned); });
    return r.number;
  };
  EXPECT_EQ(number_in(kept.options.file), 3);
  EXPECT_EQ(number_in(older), 2);
  make_newest(older, kept.options.file, PETSC_COMM_WORLD);
  EXPECT_EQ(number_in(kept.options.file), 2);
  make_newest(kept.options.file, kept.options.file, PETSC_COMM_WORLD);
  EXPECT_EQ(number_in(kept.options.file), 2);
  MPI_Barrier(PETSC_COMM_WORLD);  // nobody reads any more
}

TEST_F(Checkpoint, RefusesNumbersThatCannotBe) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](auto save, auto load) {
    const Kept kept;
    Checkpoints(kept.options, part).save(save);
    EXPECT_THROW(Checkpoints(kept.options, part).load(load), InputError);
  };
  for (const auto& [value, must] : {std::pair{nan, finite},
                                    {infinity, finite},
                                    {-1.0, not_negative},
                                    {0.0, positive},
                                    {nan, not_negative_or_infinite}}) {
    const auto visit = [&, bounds = must](double number) {
      return [&, bounds, number](Archive& archive) mutable { archive.common("a", number, bounds); };
    };
    refused(visit(value), visit(1));
  }
  for (const std::int64_t count : {-1, -2}) {
    const auto visit = [&](std::int64_t least) {
      return [&, least](Archive& archive) {
        std::int64_t number = count;
        archive.common("a", number, least);
      };
    };
    refused(visit(-2), visit(0));
  }
  const auto halves = [](Archive& archive) {
    double number = 0.5;
    archive.common("a", number);
  };
  refused(halves, [](Archive& archive) {
    std::int64_t number = 0;
    archive.common("a", number);
  });
  refused(halves, [](Archive& archive) {
    bool yes = false;
    archive.common("a", yes);
  });
  std::vector<double> rows(3 * owned.size(), nan);
  const auto visit = [&](Archive& archive) { archive.rows("a", owned, rows, 3); };
  refused(visit, visit);
}

TEST_F(Checkpoint, KeepsTheHistoryOfForces) {
  const Kept kept;
  const Lattice lattice = sheet(6, 5, 1, true);
  Scene scene;
  scene.forces.beam = scene.forces.gravity = scene.forces.buoyancy = scene.forces.drag = true;
  scene.beam.damping_ratio = 0.3;
  scene.drag.linear = 200;
  Load load;
  load.name = "p", load.point = Point2{0.4, 0.7}, load.force = {1e3, 0, -1e4};
  load.moment = {0, 2e3, 0}, load.ramp.seconds = 1;
  scene.loads = {load};
  struct Stepped {
    Model<Spatial> model;
    WorkLedger works;
    LeapfrogWork<Spatial> steps;
    Stepped(const Lattice& whole, const Scene& what)
        : model(whole, PETSC_COMM_WORLD, {}),
          works(with_forces(model, whole, what)),
          steps(model.forces(), works.all()) {}
    static Model<Spatial>& with_forces(Model<Spatial>& to, const Lattice& whole,
                                       const Scene& what) {
      add_forces(what, place_loads(what, whole), to);
      return to;
    }
    void persist(Archive& archive) {
      for (std::size_t k = 0; k < model.forces().size(); ++k) {
        archive.enter("force_" + std::to_string(k));
        if (auto* role = model.forces()[k]->roles().persists) role->persist(archive);
      }
      works.persist(archive);
      steps.persist(archive);
    }
    auto report(const State<Spatial>& state) const { return model.report(state, steps.works()); }
  };
  Stepped one(lattice, scene), other(lattice, scene);
  const auto local = static_cast<std::size_t>(one.model.part().local);
  State<Spatial> state(local);
  Wrenches<Spatial> wrenches(local);
  const auto move = [&](Stepped& which, int step) {
    for (std::size_t b = 0; b < local; ++b) {
      const double g = which.model.part().global[b], s = 1e-4 * (step + std::sin(g));
      double* r = state.record(b);
      r[0] = s, r[1] = -s, r[2] = 2 * s;
      r[Spatial::velocity] = 10 * s, r[Spatial::velocity + 2] = -s;
    }
    state.time = 0.1 * step;
    which.model.evaluate(state, wrenches);
    which.steps.take_powers();
    for (const auto& force : which.model.forces()) commit(*force, state, 0.1);
    which.steps.take_step(state, 0.1);
  };
  for (int step = 1; step <= 3; ++step) move(one, step);
  Checkpoints(kept.options, one.model.part()).save([&](Archive& archive) { one.persist(archive); });
  Checkpoints(kept.options, other.model.part()).load([&](Archive& archive) {
    other.persist(archive);
  });
  // From here on both are the same, to the last bit.
  other.model.evaluate(state, wrenches);
  EXPECT_EQ(one.report(state), other.report(state));
  move(one, 4), move(other, 4);
  const auto report = one.report(state);
  EXPECT_EQ(report, other.report(state));
  for (const auto& [name, value] : report) EXPECT_NE(value, 0) << name;
}

}  // namespace
}  // namespace floe::test
