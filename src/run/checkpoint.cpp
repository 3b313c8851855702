#include "run/checkpoint.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>

#include "base/clock.h"
#include "base/collectives.h"
#include "base/on_root.h"
#include "files/files.h"
#include "files/seal.h"
#include "floe/files/log.h"
#include "floe/session/version.h"
#include "session/signals.h"

namespace floe {
namespace {

constexpr std::int64_t layout = 8;  // of the file; other layouts are refused

/// FNV-1a over 64-bit words.
class Hash {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      value_ = (value_ ^ (word >> (8 * byte) & 0xffU)) * 0x100000001b3U;
    }
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::int32_t value) { add(static_cast<std::uint64_t>(value)); }
  void add(const Vec3<double>& v) { add(std::array{v.x, v.y, v.z}); }
  template <class T, std::size_t n>
  void add(const std::array<T, n>& values) {
    for (const T& value : values) add(value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) add(value);
  }
  std::string text() const {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value_));
    return text.data();
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

/// Name of the first table whose line differs.
std::string first_difference(const std::string& here, const std::string& there) {
  std::istringstream a(here), b(there);
  for (std::string line, other; std::getline(a, line); other.clear())
    if (!std::getline(b, other) || line != other) return line.substr(0, line.rfind(": "));
  return "table";
}

/// Returns what a program does to the run, which stands behind the fingerprint of its obstacles.
std::string of_program(const std::string& obstacles) {
  const auto at = obstacles.find("; ");
  return at == std::string::npos ? "no program moves obstacles or gives forces"
                                 : obstacles.substr(at + 2);
}

/// Beginning of messages about a checkpoint.
std::string named(const std::string& file) { return "checkpoint: restart: '" + file + "' "; }

/// Opens a checkpoint whose length and checksum are right. \throws InputError
Hdf5File open_whole(const std::string& path) {
  if (const std::string problem = seal_problem(path); !problem.empty())
    throw InputError(named(path) + problem);
  return Hdf5File::open(path, "checkpoint: restart");
}

/// Renames a complete file to its final name and syncs file and folder to the disk.
void put_on_disk(const std::string& temporary, const std::string& path) {
  sync_to_disk(temporary);
  put_in_place(temporary, path);
  const std::string folder = std::filesystem::path(path).parent_path().string();
  sync_to_disk(folder.empty() ? "." : folder);
}

}  // namespace

std::string fingerprint(const Lattice& lattice) {
  Hash hash;
  const Bodies& b = lattice.bodies;
  hash.add(b.position), hash.add(b.orientation), hash.add(b.mass), hash.add(b.inertia);
  const Beams& m = lattice.beams;
  hash.add(m.bodies), hash.add(m.axis_y);
  for (const auto* values : {&m.area, &m.inertia_y, &m.inertia_z, &m.torsion, &m.length, &m.young,
                             &m.shear_modulus, &m.shear_factor})
    hash.add(*values);
  if (!m.shear_factor_y.empty()) hash.add(m.shear_factor_y);
  if (!m.offsets.empty()) hash.add(m.offsets);
  if (!m.image.empty()) hash.add(m.image);
  for (const auto* factors : {&m.strength, &m.energy})
    if (!factors->empty()) hash.add(*factors);
  if (!b.dry.empty()) hash.add(b.dry);
  hash.add(lattice.shapes.vertices);
  return std::to_string(lattice.bodies.size()) + " bodies, " +
         std::to_string(lattice.beams.size()) + " beams, " + hash.text();
}

std::string fingerprint(std::span<const Obstacle> obstacles) {
  Hash hash;
  for (const Obstacle& obstacle : obstacles) {
    hash.add(obstacle.point);
    for (const ConvexPart& part : obstacle.parts) {
      hash.add(part.vertices);
      for (const HalfSpace& plane : part.planes) hash.add(plane.normal), hash.add(plane.offset);
    }
  }
  return std::to_string(obstacles.size()) + ", " + hash.text();
}

std::string fingerprint(const std::vector<std::vector<double>>& rows) {
  Hash hash;
  hash.add(rows);
  return std::to_string(rows.size()) + " rows, " + hash.text();
}

Checkpoints::Checkpoints(const CheckpointOptions& options, const Part& part)
    : options_(options), part_(part), last_look_time_(MPI_Wtime()), last_save_(last_look_time_) {
  if (options.file.empty()) {
    next_look_ = std::numeric_limits<std::int64_t>::max();
  } else if (rank(part.comm) == 0) {
    // A request that stopped an earlier run must not stop this one.
    std::error_code ignored;
    std::filesystem::remove(options.stop_file, ignored);
  }
}

/// The next look comes after about a quarter of a second by the slowest rank's clock; the maximum
/// over ranks makes it the same step on all. The check of the wall time includes the time until the
/// next look.
Checkpoints::Wish Checkpoints::look(std::int64_t step) {
  constexpr double look_seconds = 0.25;
  constexpr double most_steps = 1000;
  const double now = MPI_Wtime();
  const double steps = static_cast<double>(std::max<std::int64_t>(step - last_look_, 1));
  const double a_step = (now - last_look_time_) / steps;
  std::array<double, 6> mine{a_step, StopSignals::came() ? 1.0 : 0.0, 0, 0, 0, 0};
  mine[5] = options_.wants_pause && options_.wants_pause() ? 1 : 0;
  if (rank(part_.comm) == 0) {
    std::error_code ignored;
    mine[2] = std::filesystem::exists(options_.stop_file, ignored) ? 1 : 0;
    mine[3] = now - last_save_ >= options_.every ? 1 : 0;
    const double to_come = std::max(look_seconds, a_step) + save_seconds_;
    mine[4] = seconds_of_process() + to_come >= options_.wall_time ? 1 : 0;
  }
  auto all = mine;
  largest_over_ranks(all, part_.comm);
  last_look_ = step;
  last_look_time_ = now;
  next_look_ = step + static_cast<std::int64_t>(
                          std::clamp(look_seconds / std::max(all[0], 1e-9), 1.0, most_steps));
  if (all[2] > 0 && rank(part_.comm) == 0) {
    std::error_code ignored;  // one file asks for one stop
    std::filesystem::remove(options_.stop_file, ignored);
  }
  if (all[1] > 0 || all[2] > 0) return Wish::stop;
  if (all[4] > 0) return Wish::stop_for_time;
  if (all[3] > 0) return Wish::write;
  return all[5] > 0 ? Wish::pause : Wish::none;
}

std::string previous_checkpoint(const std::string& file) {
  return (std::filesystem::path(file).parent_path() / "checkpoint_previous.h5").string();
}

CheckpointHead read_head(const std::string& path) {
  Hdf5File file = open_whole(path);
  const auto refuse = [&](const std::string& why) { throw InputError(named(path) + why); };
  const auto number = [&](const char* name) {
    const std::vector<double> values = file.read(name);
    if (values.size() != 1 || !std::isfinite(values[0]) || values[0] < 0)
      refuse(std::string("has no number that can be its ") + name);
    return values[0];
  };
  if (const double is = number("layout"); is != static_cast<double>(layout))
    refuse("is of another version of floe (layout " + std::to_string(std::llround(is)) +
           ", must be " + std::to_string(layout) + ")");
  CheckpointHead head;
  head.version = file.read_text("version");
  head.built_for = file.read_text("built_for");
  head.lattice = file.read_text("lattice");
  head.options = file.read_text("options");
  head.scene = file.read_text("scene");
  head.run = file.has("output/run") ? file.read_text("output/run") : "";
  head.ranks = std::llround(number("ranks"));
  head.time = number("run/time");
  return head;
}

std::string older_generation(const std::string& file) {
  const std::string older = previous_checkpoint(file);
  std::error_code ignored;
  if (std::filesystem::equivalent(older, file, ignored)) return {};
  try {
    std::array<char, 32> time{};
    std::snprintf(time.data(), time.size(), "%.9g", read_head(older).time);
    return "; -checkpoint_restart " + older + " goes on from t = " + time.data() + " s";
  } catch (const InputError&) {
    return {};
  }
}

void make_newest(const std::string& restart, const std::string& file, MPI_Comm comm) {
  on_root(comm, [&] {
    std::error_code error;
    if (std::filesystem::equivalent(restart, file, error)) return;
    const std::string temporary = temporary_name(file);
    std::filesystem::copy_file(restart, temporary,
                               std::filesystem::copy_options::overwrite_existing, error);
    if (error) {
      std::remove(temporary.c_str());
      throw_file_error("write", file, error.value());
    }
    put_on_disk(temporary, file);
  });
}

/// Writes or compares the entries with which every checkpoint begins. \throws OtherRun
void Checkpoints::head(Archive& archive) {
  std::string version = FLOE_VERSION, built = built_for(part_.comm), lattice = options_.lattice,
              obstacles = options_.obstacles, options = options_.options, scene = options_.scene,
              tables = options_.tables;
  std::int64_t number = layout, ranks = size(part_.comm);
  archive.enter("");
  archive.common("layout", number);
  archive.common("version", version);
  archive.common("built_for", built);
  archive.common("ranks", ranks, 1);
  archive.common("lattice", lattice);
  archive.common("obstacles", obstacles);
  if (!tables.empty()) archive.common("tables", tables);
  archive.common("options", options);
  archive.common("scene", scene);
  if (number != layout) throw OtherRun(named(options_.restart) + "is of another version of floe");
  if (lattice != options_.lattice)
    throw OtherRun(named(options_.restart) + "is of another lattice (" + lattice +
                   "; this scene's is " + options_.lattice + ")");
  const std::string program = of_program(obstacles), here = of_program(options_.obstacles);
  if (program != here)
    throw OtherRun(named(options_.restart) + "is of a run in which " + program + "; in this one " +
                   here);
  if (obstacles != options_.obstacles)
    throw OtherRun(named(options_.restart) +
                   "is of obstacles of other shapes: a file of theirs "
                   "has changed");
  if (tables != options_.tables)
    throw OtherRun(named(options_.restart) + "has other rows than the file of " +
                   first_difference(options_.tables, tables));
}

void Checkpoints::save(const std::function<void(Archive&)>& persist,
                       const std::vector<std::string>& columns) {
  const Timed timed(Event::output);
  const double began = MPI_Wtime();
  options_.prepare(columns);
  std::optional<Hdf5File> file;
  on_root(part_.comm, [&] { file.emplace(Hdf5File::create(options_.file, seal_size)); });
  Archive memory(part_, file ? &*file : nullptr, Transfer::save);
  head(memory);
  persist(memory);
  options_.others(memory);
  share_outcome(memory.outcome(), part_.comm);
  on_root(part_.comm, [&] {
    file->close([](const std::string& temporary, const std::string& path) {
      seal(temporary);
      sync_to_disk(temporary);  // before the checkpoint in place gives up its name
      give_second_name(path, previous_checkpoint(path));
      put_on_disk(temporary, path);
    });
  });
  last_save_ = MPI_Wtime();
  save_seconds_ = last_save_ - began;
}

void Checkpoints::load(const std::function<void(Archive&)>& persist) {
  std::optional<Hdf5File> file;
  try {
    on_root(part_.comm, [&] { file.emplace(open_whole(options_.restart)); });
    Archive memory(part_, file ? &*file : nullptr, Transfer::load, options_.restart);
    head(memory);
    persist(memory);
    options_.others(memory);
  } catch (const OtherRun&) {
    throw;
  } catch (const InputError& error) {
    const std::string what = error.what();
    on_root(part_.comm, [&] { throw InputError(what + older_generation(options_.restart)); });
  }
}

}  // namespace floe
