#include "output/output.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/collectives.h"
#include "base/on_root.h"
#include "files/files.h"
#include "floe/base/item.h"
#include "floe/files/log.h"
#include "floe/options/options.h"
#include "output/cracks.h"
#include "output/fields.h"
#include "output/gather.h"
#include "output/history.h"

namespace floe {
namespace {

/// Point of application of a load: bodies and the arm at rest.
struct LoadPoint {
  std::string name;
  std::vector<std::int32_t> everywhere;  ///< global
  std::vector<std::int32_t> bodies;      ///< local
  Vec3<double> arm;
};

}  // namespace

template <class Space>
struct Output<Space>::Impl {
  const OutputOptions options;
  const Model<Space>& model;
  const Part& part;
  Lattice lattice;  ///< rank 0
  std::vector<LoadPoint> loads;
  /// Per boundary: number of bodies, mean position at rest.
  std::vector<std::pair<std::size_t, Point3>> sets;
  Gather bodies, beams;
  std::vector<std::int32_t> counted;  ///< local beams that this rank reports
  std::optional<Fields> fields;       ///< rank 0
  std::optional<History> history;     ///< rank 0
  std::optional<History> pressure;    ///< rank 0, if it is sampled
  std::optional<CrackLog> cracks;     ///< if beams may break
  OutputArchive memory;
  std::optional<State<Space>> pending;  ///< accepted, but not in fields.h5
  std::optional<Frame> pending_frame;   ///< of `pending`, once the bodies have moved to other ranks
  bool has_followed = false;            ///< whether bodies have joined or left since restore()

  Impl(const OutputOptions& o, const Model<Space>& m) : options(o), model(m), part(m.part()) {
    find_parts();
  }

  /// Finds this rank's bodies and beams, and its share of the loads' points.
  void find_parts() {
    bodies = Gather(part.comm, std::span(part.global).first(static_cast<std::size_t>(part.owned)),
                    part.global_bodies);
    beams = Gather(part.comm, counted_global(), part.global_beams);
    counted.clear();
    for (std::size_t k = 0; k < part.counts_here.size(); ++k) {
      if (part.counts_here[k]) counted.push_back(static_cast<std::int32_t>(k));
    }
    for (LoadPoint& load : loads) load.bodies = part.localise(load.everywhere);
  }

  std::vector<std::int32_t> counted_global() const {
    std::vector<std::int32_t> global;
    for (std::size_t k = 0; k < part.counts_here.size(); ++k) {
      if (part.counts_here[k]) global.push_back(part.global_beam[k]);
    }
    return global;
  }

  void open_files(const std::string& options_yaml, bool restarted, const PresentMesh& mesh);
  void find_sets(const Lattice& of);
  void keep_what_frames_need();
  Sample sample(const Accepted<Space>& accepted);
  void write_row(const Sample& sample);
  void put_row(const Sample& sample);
  void write_pressure(double time);
  Frame make_frame(const State<Space>& state);
  void write_frame(const Frame& frame);
};

template <class Space>
Output<Space>::Output(const OutputOptions& options, Lattice&& lattice, const Model<Space>& model,
                      const std::vector<PlacedLoad>& loads, const std::string& options_yaml,
                      const OutputArchive* restart, const PresentMesh& mesh) {
  const Timed timed(Event::output);
  impl_ = std::make_unique<Impl>(options, model);
  for (const PlacedLoad& placed : loads)
    impl_->loads.push_back(
        {placed.load.name, placed.bodies, impl_->part.localise(placed.bodies), placed.arm});
  impl_->find_sets(lattice);
  impl_->lattice = std::move(lattice);
  if (rank(model.part().comm) != 0) impl_->lattice = {};
  if (model.fracture() != nullptr)
    impl_->cracks.emplace(options.dir, impl_->lattice, *model.fracture(), model.part());
  if (restart != nullptr) impl_->memory = *restart;
  on_root(model.part().comm, [&] { impl_->open_files(options_yaml, restart != nullptr, mesh); });
}

/// Finds numbers and mean places of the boundaries' bodies.
template <class Space>
void Output<Space>::Impl::find_sets(const Lattice& of) {
  sets.clear();
  for (const PlacedBoundary& placed : model.boundaries()) {
    const auto& set = of.set(placed.boundary.set, "boundary");
    Point3 mean{};
    for (const std::int32_t b : set) {
      for (std::size_t k = 0; k < 3; ++k)
        mean[k] += item(of.bodies.position, b)[k] / static_cast<double>(set.size());
    }
    sets.emplace_back(set.size(), mean);
  }
}

constexpr auto pressure_header = "time,obstacle,patch,force_x,force_y,force_z\n";

template <class Space>
void Output<Space>::Impl::open_files(const std::string& options_yaml, bool restarted,
                                     const PresentMesh& mesh) {
  const std::string& dir = options.dir;
  if (!restarted) write_lattice(lattice, dir + "/lattice.h5", options.obstacles);
  history.emplace(dir + "/history.csv", restarted ? memory.rows : -1);
  if (options.pressure > 0) {
    pressure.emplace(dir + "/pressure.csv", restarted ? memory.pressures : -1);
    if (pressure->header().empty()) pressure->write_header(pressure_header);
  }
  keep_what_frames_need();
  fields.emplace(dir, lattice, restarted ? memory.frames : -1, mesh.first, mesh.names);
  if (restarted)
    // The summary in the folder is that of an earlier part of the run.
    std::filesystem::remove(dir + "/summary.json");
  write_whole(dir + "/options.yaml", options_yaml);
}

/// Frees the parts of the lattice that frames do not need: a large lattice is most of rank 0's
/// memory.
template <class Space>
void Output<Space>::Impl::keep_what_frames_need() {
  Beams& b = lattice.beams;
  b.torsion = b.length = b.young = b.shear_modulus = b.shear_factor = b.shear_factor_y = {};
  b.strength = b.energy = {};
  if (cracks) return;  // cracks need places and pieces
  b.axis_y = {};
  b.offsets = {};
  lattice.bodies.mass = {};
  lattice.bodies.inertia = lattice.bodies.velocity = lattice.bodies.angular_velocity = {};
}

template <class Space>
Output<Space>::~Output() = default;

template <class Space>
const OutputArchive& Output<Space>::archive() const {
  return impl_->memory;
}
template <class Space>
const Sample& Output<Space>::first() const {
  return impl_->memory.first;
}
template <class Space>
const Sample& Output<Space>::last() const {
  return impl_->memory.last;
}

template <class Space>
Sample Output<Space>::Impl::sample(const Accepted<Space>& accepted) {
  Sample s;
  s.time = accepted.state.time;
  for (std::size_t k = 0; k < model.boundaries().size(); ++k) {
    const PlacedBoundary& placed = model.boundaries()[k];
    const auto& [count, mean] = sets[k];
    BoundarySample mine;
    for (const std::int32_t body : placed.bodies) {
      if (body >= part.owned) continue;
      const auto b = static_cast<std::size_t>(body);
      const std::array<double, 6> w = components_of(accepted.wrenches, b);
      Vec3<double> force{0, 0, 0}, moment{0, 0, 0};
      if (placed.boundary.fixed[0]) force.x = -w[0];
      if (placed.boundary.fixed[1]) force.y = -w[1];
      if (placed.boundary.fixed[2]) force.z = -w[2];
      if (placed.boundary.fixed[3]) moment.x = -w[3];
      if (placed.boundary.fixed[4]) moment.y = -w[4];
      if (placed.boundary.fixed[5]) moment.z = -w[5];
      const Vec3<double> u = displacement(accepted.state, b);
      moment = moment + cross(part.bodies.position[b] + u - mean, force);
      mine.force = mine.force + force;
      mine.moment = mine.moment + moment;
      const double share = 1.0 / static_cast<double>(count);
      mine.displacement = mine.displacement + share * u;
    }
    s.boundaries[placed.boundary.name] = {sum_over_ranks(mine.force, part.comm),
                                          sum_over_ranks(mine.moment, part.comm),
                                          sum_over_ranks(mine.displacement, part.comm)};
  }
  for (const LoadPoint& load : loads) {
    Point3 mine{};
    const double share = 1.0 / static_cast<double>(load.everywhere.size());
    for (const std::int32_t body : load.bodies) {
      if (body >= part.owned) continue;
      const auto b = static_cast<std::size_t>(body);
      const bool linear = model.kinematics() == Kinematics::linear;
      const Vec3<double> turn = linear ? cross(linear_rotation(accepted.state, b), load.arm)
                                       : rotate(rotation(accepted.state, b), load.arm) - load.arm;
      const Vec3<double> u = displacement(accepted.state, b) + turn;
      mine = mine + share * u;
    }
    s.loads[load.name] = sum_over_ranks(mine, part.comm);
  }
  s.forces = accepted.forces;
  s.forces.insert(s.forces.end(), accepted.columns.begin(), accepted.columns.end());
  if (cracks) s.forces.emplace_back("fragments", cracks->update());
  return s;
}

std::vector<std::pair<std::string, double>> columns_of(const Sample& sample) {
  std::vector<std::pair<std::string, double>> columns;
  const auto add = [&](const std::string& name, const Point3& p) {
    for (std::size_t k = 0; k < 3; ++k)
      columns.emplace_back(name + "_" + std::string(component_names[k]), p[k]);
  };
  for (const auto& [name, b] : sample.boundaries) {
    add(name + "_force", b.force);
    add(name + "_moment", b.moment);
    add(name + "_displacement", b.displacement);
  }
  for (const auto& [name, u] : sample.loads) add(name + "_load_displacement", u);
  columns.insert(columns.end(), sample.forces.begin(), sample.forces.end());
  return columns;
}

/// The first line of history.csv: names of a sample's columns.
std::string header_of(const Sample& s) {
  std::string line = "time";
  for (const auto& [name, value] : columns_of(s)) line += "," + name;
  return line + "\n";
}

Sample columns_of(const std::vector<Boundary>& boundaries, const std::vector<Load>& loads,
                  const std::vector<std::string>& names, bool breakable) {
  Sample sample;
  for (const Boundary& boundary : boundaries) sample.boundaries[boundary.name] = {};
  for (const Load& load : loads) sample.loads[load.name] = {};
  for (const std::string& name : names) sample.forces.emplace_back(name, 0.0);
  if (breakable) sample.forces.emplace_back("fragments", 0.0);
  return sample;
}

void require_files(const std::string& dir, const OutputArchive& archive, const Sample& columns,
                   MPI_Comm comm) {
  on_root(comm, [&] {
    const std::string path = dir + "/history.csv";
    const HistoryStart history = history_start(path, archive.rows);
    if (!history.header.empty() && history.header != header_of(columns))
      throw InputError("checkpoint: restart: '" + path +
                       "' has other columns than this run writes: it is of another run, or of "
                       "another version of floe");
    Fields::require(dir, archive.frames);
    if (archive.pressures > 0) (void)history_start(dir + "/pressure.csv", archive.pressures);
  });
}

template <class Space>
void Output<Space>::Impl::write_row(const Sample& s) {
  ++memory.rows;
  on_root(part.comm, [&] { put_row(s); });
}

/// Writes a row; on rank 0.
template <class Space>
void Output<Space>::Impl::put_row(const Sample& s) {
  if (history->header().empty()) history->write_header(header_of(s));
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", s.time);
  std::string line = text.data();
  for (const auto& [name, value] : columns_of(s)) {
    std::snprintf(text.data(), text.size(), ",%.12g", value);
    line += text.data();
  }
  history->write(line + "\n");
}

/// Writes the forces on patches of obstacles at the accepted state: of each obstacle its whole
/// force, then that on each loaded patch.
template <class Space>
void Output<Space>::Impl::write_pressure(double time) {
  std::array<char, 32> start{};
  std::snprintf(start.data(), start.size(), "%.12g,", time);
  for (const auto& force : model.forces()) {
    ActsOnPatches* role = force->roles().patches;
    if (role == nullptr) continue;
    const PatchSample sample = role->sample_patches(time);
    std::string rows;
    const auto add = [&](const std::string& name, const std::string& patch, const Vec3<double>& f) {
      std::array<char, 96> text{};
      std::snprintf(text.data(), text.size(), ",%.15g,%.15g,%.15g\n", f.x, f.y, f.z);
      rows += start.data() + name + "," + patch + text.data();
      ++memory.pressures;
    };
    for (const PatchSample::OfObstacle& of : sample.obstacles) {
      add(of.name, "all", of.force);
      for (const auto& [patch, on_it] : of.loaded) add(of.name, std::to_string(patch), on_it);
    }
    on_root(part.comm, [&] { pressure->write(rows); });
  }
}

template <class Space>
Frame Output<Space>::Impl::make_frame(const State<Space>& state) {
  const auto owned = static_cast<std::size_t>(part.owned);
  std::vector<Point3> u, vector;
  std::vector<std::array<double, 4>> q;
  u.reserve(owned), vector.reserve(owned), q.reserve(owned);
  for (std::size_t b = 0; b < owned; ++b) {
    const Quat<double> now = rotation(state, b);
    u.push_back(displacement(state, b));
    q.push_back({now.w, now.x, now.y, now.z});
    vector.push_back(model.kinematics() == Kinematics::linear ? linear_rotation(state, b)
                                                              : log_rotation(now));
  }
  Frame frame{state.time, bodies(std::move(u)), bodies(std::move(q)), bodies(std::move(vector)), {},
              {}};
  if (model.beams() != nullptr) {
    std::vector<BeamSection> sections = model.beams()->sections(state);
    for (std::size_t k = 0; k < counted.size();
         ++k)  // counted[k] >= k, so that entries can be moved in place
      sections[k] = item(sections, counted[k]);
    sections.resize(counted.size());
    frame.sections = beams(std::move(sections));
  }
  if (model.fracture() != nullptr) {
    std::vector<double> mine;
    mine.reserve(counted.size());
    for (const std::int32_t k : counted) mine.push_back(model.fracture()->damage(k));
    frame.damage = beams(std::move(mine));
  }
  return frame;
}

template <class Space>
void Output<Space>::Impl::write_frame(const Frame& frame) {
  ++memory.frames;
  on_root(part.comm, [&] { fields->write(frame); });
}

template <class Space>
void Output<Space>::accept(const Accepted<Space>& accepted) {
  const Timed timed(Event::output);
  Impl& me = *impl_;
  const double time = accepted.state.time;
  // Part of an interval, so that rounding does not miss a sample that is due at a step's end.
  constexpr double early = 1e-9;
  OutputArchive& archive = me.memory;
  archive.last = me.sample(accepted);
  if (accepted.step == 0) archive.first = archive.last;
  archive.row_pending = !accepted.last && me.options.history > 0 &&
                        time < archive.next_history - early * me.options.history;
  if (!archive.row_pending) {
    me.write_row(archive.last);
    if (me.options.history > 0)
      archive.next_history =
          me.options.history * (std::floor(time / me.options.history + early) + 1);
  }
  const bool due =
      accepted.step == 0 || accepted.last ||
      (me.options.fields > 0 && time >= archive.next_fields - early * me.options.fields);
  if (me.options.pressure > 0 && time >= archive.next_pressure - early * me.options.pressure) {
    me.write_pressure(time);
    archive.next_pressure =
        me.options.pressure * (std::floor(time / me.options.pressure + early) + 1);
  }
  me.pending_frame.reset();
  if (due) {
    me.pending.reset();
    me.write_frame(me.make_frame(accepted.state));
    if (me.options.fields > 0)
      archive.next_fields = me.options.fields * (std::floor(time / me.options.fields + early) + 1);
  } else {
    me.pending = accepted.state;
  }
}

template <class Space>
void Output<Space>::finish() {
  const Timed timed(Event::output);
  if (impl_->memory.row_pending) impl_->write_row(impl_->memory.last);
  impl_->memory.row_pending = false;
  prepare_to_follow();
  if (impl_->pending_frame) impl_->write_frame(*impl_->pending_frame);
  impl_->pending_frame.reset();
  on_root(impl_->part.comm, [&] {
    impl_->fields->finish();
    impl_->history->close();
    if (impl_->pressure) impl_->pressure->close();
  });
}

template <class Space>
void Output<Space>::prepare_to_follow() {
  if (impl_->pending) impl_->pending_frame = impl_->make_frame(*impl_->pending);
  impl_->pending.reset();
}

template <class Space>
void Output<Space>::follow() {
  impl_->find_parts();
  if (impl_->cracks) impl_->cracks->follow(*impl_->model.fracture());
}

template <class Space>
void Output<Space>::follow(const Lattice& lattice, std::span<const std::int32_t> names) {
  Impl& me = *impl_;
  me.has_followed = true;
  me.pending_frame.reset();  // of other bodies
  me.find_sets(lattice);
  on_root(me.part.comm, [&] {
    me.lattice = lattice;
    me.fields->follow(me.lattice, names);
    me.keep_what_frames_need();
  });
  follow();
  if (me.cracks) me.cracks->follow_lattice();
}

template <class Space>
OutputState Output<Space>::save() {
  Impl& me = *impl_;
  return {me.memory, me.pending ? me.make_frame(*me.pending) : me.pending_frame};
}

template <class Space>
void Output<Space>::restore(const OutputState& state, const PresentMesh& mesh) {
  const Timed timed(Event::output);
  Impl& me = *impl_;
  const OutputArchive& to = state.archive;
  const bool rows = me.memory.rows != to.rows, frames = me.memory.frames != to.frames,
             pressures = me.memory.pressures != to.pressures;
  me.memory = to;
  me.pending.reset();
  me.pending_frame = state.pending;
  if (me.cracks) me.cracks->follow_lattice();
  const std::string& dir = me.options.dir;
  // Its new mesh is none of the frames'.
  const bool follows = std::exchange(me.has_followed, false);
  on_root(me.part.comm, [&] {
    if (rows) me.history.emplace(dir + "/history.csv", to.rows);
    if (pressures) me.pressure.emplace(dir + "/pressure.csv", to.pressures);
    if (frames || follows) me.fields.emplace(dir, me.lattice, to.frames, mesh.first, mesh.names);
  });
}

template <class Space>
std::int64_t Output<Space>::mesh() const {
  return impl_->fields ? impl_->fields->mesh() : 0;
}

template <class Space>
void Output<Space>::sync() {
  const Timed timed(Event::output);
  on_root(impl_->part.comm, [&] {
    impl_->history->sync();
    if (impl_->pressure) impl_->pressure->sync();
    impl_->fields->sync();
    sync_to_disk(impl_->options.dir);
  });
}

template class Output<Spatial>;
template class Output<Planar>;

}  // namespace floe
