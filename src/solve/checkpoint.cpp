#include "floe/solve/checkpoint.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <optional>

#include "floe/base/log.h"
#include "floe/base/options.h"
#include "floe/base/signals.h"

namespace floe {
namespace {

constexpr std::int64_t layout = 2;  // of the file; another one is refused

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
  template <class T, std::size_t n>
  void add(const std::array<T, n>& values) {
    for (const T& value : values) add(value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    for (const T& value : values) add(value);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

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
  hash.add(lattice.shapes.vertices);
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash.value()));
  return std::to_string(lattice.bodies.size()) + " bodies, " +
         std::to_string(lattice.beams.size()) + " beams, " + text.data();
}

Checkpoints::Checkpoints(const CheckpointOptions& options, const Part& part)
    : options_(options), part_(part), last_look_time_(MPI_Wtime()), last_save_(last_look_time_) {
  if (options.file.empty()) {
    next_look_ = std::numeric_limits<std::int64_t>::max();
  } else if (rank(part.comm) == 0) {
    std::error_code ignored;  // what asked an earlier run to stop does not ask this one
    std::filesystem::remove(options.stop_file, ignored);
  }
}

/// The next look is about a quarter of a second away by the slowest rank's clock; the maximum over
/// ranks makes it the same step on all.
Checkpoints::Wish Checkpoints::look(std::int64_t step) {
  constexpr double look_seconds = 0.25;
  constexpr double most_steps = 1000;
  const double now = MPI_Wtime();
  const double steps = static_cast<double>(std::max<std::int64_t>(step - last_look_, 1));
  std::array<double, 4> mine{(now - last_look_time_) / steps, StopSignals::came() ? 1.0 : 0.0, 0,
                             0};
  if (rank(part_.comm) == 0) {
    std::error_code ignored;
    mine[2] = std::filesystem::exists(options_.stop_file, ignored) ? 1 : 0;
    mine[3] = now - last_save_ >= options_.every ? 1 : 0;
  }
  std::array<double, 4> all{};
  MPI_Allreduce(mine.data(), all.data(), 4, MPI_DOUBLE, MPI_MAX, part_.comm);
  last_look_ = step;
  last_look_time_ = now;
  next_look_ = step + static_cast<std::int64_t>(
                          std::clamp(look_seconds / std::max(all[0], 1e-9), 1.0, most_steps));
  if (all[2] > 0 && rank(part_.comm) == 0) {
    std::error_code ignored;  // asked for once
    std::filesystem::remove(options_.stop_file, ignored);
  }
  if (all[1] > 0 || all[2] > 0) return Wish::stop;
  return all[3] > 0 ? Wish::write : Wish::none;
}

void Checkpoints::head(Memory& memory) {
  std::string version = FLOE_VERSION, scene = options_.scene, options = options_.options;
  std::int64_t number = layout;
  const auto refuse = [&](const std::string& why) {
    throw InputError("checkpoint: restart: '" + options_.restart + "' " + why);
  };
  memory.enter("");
  memory.common("layout", number);
  if (number != layout)
    refuse("is of another version of floe (layout " + std::to_string(number) + ", must be " +
           std::to_string(layout) + ")");
  memory.common("version", version);
  memory.common("lattice", scene);
  memory.common("options", options);
  if (scene != options_.scene)
    refuse("is of another lattice (" + scene + "; this scene's is " + options_.scene + ")");
}

void Checkpoints::save(const std::function<void(Memory&)>& remember) {
  const Timed timed(Event::output);
  options_.prepare();
  std::optional<Hdf5File> file;
  on_root(part_.comm, [&] { file.emplace(Hdf5File::create(options_.file)); });
  Memory memory(part_, file ? &*file : nullptr, false);
  head(memory);
  remember(memory);
  options_.others(memory);
  share_outcome(memory.outcome(), part_.comm);
  on_root(part_.comm, [&] { file->close(); });
  last_save_ = MPI_Wtime();
}

void Checkpoints::load(const std::function<void(Memory&)>& remember) {
  std::optional<Hdf5File> file;
  on_root(part_.comm,
          [&] { file.emplace(Hdf5File::open(options_.restart, "checkpoint: restart")); });
  Memory memory(part_, file ? &*file : nullptr, true);
  head(memory);
  remember(memory);
  options_.others(memory);
}

}  // namespace floe
