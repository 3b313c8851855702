/// \file
/// Checkpoints of dynamic runs: when they are written, and the requests that stop a run.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "floe/contact/obstacle.h"
#include "lattice/archive.h"

namespace floe {

/// Checkpoint settings of a run.
struct CheckpointOptions {
  std::string file;    ///< where checkpoints go; empty: none are written, nothing asks for a stop
  double every = 600;  ///< wall time between two [s]
  /// Whether a finished run writes one too, so that it can be extended.
  bool at_end = false;
  std::string stop_file;  ///< its presence asks for a checkpoint and a stop
  std::string restart;    ///< checkpoint to go on from; empty: start at t = 0
  std::string lattice;    ///< fingerprint of the lattice
  /// Fingerprint of the obstacles' shapes; then, after "; ", what a program does to the run.
  std::string obstacles;
  /// Fingerprints of the tables that files give, a line each: KEY: fingerprint; empty: none.
  std::string tables;
  std::string options;  ///< every option as used
  std::string scene;    ///< path of the scene file
  /// Wall time of the process by rank 0's clock [s]; the run writes a checkpoint and stops before
  /// this time is over.
  double wall_time = std::numeric_limits<double>::infinity();
  /// Whether this rank wants the run to pause; asked a few times a second. Empty: never.
  std::function<bool()> wants_pause = nullptr;
  /// Creates the output folder and syncs what has been written there; called before each checkpoint
  /// is written, with the names of the columns that the forces and the integrator report.
  std::function<void(const std::vector<std::string>& columns)> prepare =
      [](const std::vector<std::string>&) {};
  /// Saves or loads the history of all parts of the run except the integrator; called for each
  /// checkpoint, and once when loading.
  std::function<void(Archive&)> others = [](Archive&) {};
};

/// Error for an intact checkpoint of another run than this one.
class OtherRun : public InputError {
 public:
  using InputError::InputError;
};

/// Entries of a checkpoint by which the program decides on a restart.
struct CheckpointHead {
  std::string version, built_for;       ///< of floe
  std::string lattice, options, scene;  ///< as in CheckpointOptions
  /// Identifier of the run (output/run in the file); empty: none.
  std::string run;
  std::int64_t ranks = 1;
  double time = 0;  ///< of the saved state [s]
};

/// Reads the head of a checkpoint. Not collective.
/// \throws InputError if the file's length or checksum is wrong, its layout is another one, or a
///   number is impossible
CheckpointHead read_head(const std::string& file);

/// Returns the name under which the checkpoint before `file` is kept, in the same folder.
std::string previous_checkpoint(const std::string& file);
/// Returns "; -checkpoint_restart FILE goes on from t = ..." if the generation before a damaged
/// `file` is good, else an empty string. Not collective.
std::string older_generation(const std::string& file);

/// Copies the checkpoint `restart` of a run to `file`, its newest, so that no checkpoint of a later
/// time keeps that name. Collective.
void make_newest(const std::string& restart, const std::string& file, MPI_Comm comm);

/// Returns a text that two lattices share only if they are the same to the last bit.
std::string fingerprint(const Lattice& lattice);
/// The same for the shapes of obstacles, which may come from files.
std::string fingerprint(std::span<const Obstacle> obstacles);
/// The same for the rows of a table.
std::string fingerprint(const std::vector<std::vector<double>>& rows);

/// Writes checkpoints and decides when. All calls are collective.
class Checkpoints {
 public:
  enum class Wish { none, write, stop, stop_for_time, pause };

  /// \param options, part  must outlive this
  Checkpoints(const CheckpointOptions& options, const Part& part);

  /// Says whether a checkpoint or a stop is due after a step. Ranks agree a few times a second;
  /// other calls cost one comparison.
  Wish wish(std::int64_t step) { return step < next_look_ ? Wish::none : look(step); }

  /// Writes the checkpoint to a temporary file, seals it, syncs it to the disk and renames it; the
  /// checkpoint before stays as previous_checkpoint(). At any instant at least one of the two is
  /// whole.
  /// \param persist  saves the run's own data
  /// \param columns  names for options.prepare
  void save(const std::function<void(Archive&)>& persist,
            const std::vector<std::string>& columns = {});
  /// Reads the file that options.restart names.
  /// \throws InputError if the file is damaged, naming the generation before it if that is good;
  ///   OtherRun if it is a checkpoint of another lattice
  void load(const std::function<void(Archive&)>& persist);

 private:
  Wish look(std::int64_t step);
  void head(Archive& archive);

  const CheckpointOptions& options_;
  const Part& part_;
  std::int64_t next_look_ = 1, last_look_ = 0;
  double last_look_time_, last_save_, save_seconds_ = 0;
};

}  // namespace floe
