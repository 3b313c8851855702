/// \file
/// When checkpoints are written, and what asks a run to stop.
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

/// What a run is told of checkpoints.
struct CheckpointOptions {
  std::string file;       ///< where they go; empty: none are written, nothing asks for a stop
  double every = 600;     ///< wall time between two [s]
  bool at_end = false;    ///< one at the end of a finished run too, so that it can be extended
  std::string stop_file;  ///< its presence asks for a checkpoint and a stop
  std::string restart;    ///< the one to go on from; empty: from t = 0
  std::string lattice;    ///< what identifies it
  std::string obstacles;  ///< what identifies their shapes
  std::string options;    ///< every option as used
  std::string scene;      ///< the path of the scene's file
  /// Of the process, by rank 0's clock: a checkpoint and a stop before it is over [s].
  double wall_time = std::numeric_limits<double>::infinity();
  /// Makes the folder, and brings to the disk what has been written; called before each is written,
  /// with the names of what the forces and the integrator report.
  std::function<void(const std::vector<std::string>& columns)> prepare =
      [](const std::vector<std::string>&) {};
  /// What others than the integrator keep; called for each checkpoint, and once when loading.
  std::function<void(Archive&)> others = [](Archive&) {};
};

/// A whole checkpoint that is of another run than this one.
class OtherRun : public InputError {
 public:
  using InputError::InputError;
};

/// What a checkpoint says of its run, for who decides on a restart.
struct CheckpointHead {
  std::string version, built_for;       ///< of floe
  std::string lattice, options, scene;  ///< as in CheckpointOptions
  std::string run;                      ///< what identifies it; empty: nothing
  std::int64_t ranks = 1;
  double time = 0;  ///< of its state [s]
};

/// Reads it on one rank. \throws InputError that says what is wrong with the file: its length or
/// its checksum, another layout, a number that cannot be
CheckpointHead read_head(const std::string& file);

/// The name under which the checkpoint before `file` is kept, in the same folder.
std::string previous_checkpoint(const std::string& file);
/// "; -checkpoint_restart FILE goes on from t = ..." where the generation before a damaged `file`
/// is good, else nothing. On one rank.
std::string older_generation(const std::string& file);

/// Makes the checkpoint that a run goes on from its newest, so that no later one of the time
/// before the restart is left under that name. Collective.
void make_newest(const std::string& restart, const std::string& file, MPI_Comm comm);

/// A number that two lattices share only if they are the same, to the last bit.
std::string fingerprint(const Lattice& lattice);
/// The same of the shapes of obstacles, which files may give.
std::string fingerprint(std::span<const Obstacle> obstacles);

/// Writes checkpoints and says when. Collective throughout.
class Checkpoints {
 public:
  enum class Wish { none, write, stop, stop_for_time };

  /// \param options, part  must outlive this
  Checkpoints(const CheckpointOptions& options, const Part& part);

  /// What is due after a step: ranks agree a few times a second, other calls cost a comparison.
  Wish wish(std::int64_t step) { return step < next_look_ ? Wish::none : look(step); }

  /// Writes the file whole, seals it, brings it to the disk and renames it; the one before stays
  /// as previous_checkpoint(). At any instant at least one of them is whole.
  /// \param persist  what the run keeps   \param columns  for options.prepare
  void save(const std::function<void(Archive&)>& persist,
            const std::vector<std::string>& columns = {});
  /// Reads the file that options.restart names. \throws InputError if it is damaged, with the
  /// generation before it if that is good, or not a checkpoint of this lattice
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
