/// \file
/// When checkpoints are written, and what asks a run to stop.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "floe/lattice/memory.h"

namespace floe {

/// What a run is told of checkpoints.
struct CheckpointOptions {
  std::string file;       ///< where they go; empty: none are written, nothing asks for a stop
  double every = 600;     ///< wall time between two [s]
  bool at_end = false;    ///< one at the end of a finished run too, so that it can be extended
  std::string stop_file;  ///< its presence asks for a checkpoint and a stop
  std::string restart;    ///< the one to go on from; empty: from t = 0
  std::string scene;      ///< what identifies the lattice
  std::string options;    ///< every option as used, kept for the reader
  std::function<void()> prepare = [] {};  ///< makes the folder; called before each is written
  /// What others than the integrator keep; called for each checkpoint, and once when loading.
  std::function<void(Memory&)> others = [](Memory&) {};
};

/// A number that two lattices share only if they are the same, to the last bit.
std::string fingerprint(const Lattice& lattice);

/// Writes checkpoints and says when. Collective throughout.
class Checkpoints {
 public:
  enum class Wish { none, write, stop };

  /// \param options, part  must outlive this
  Checkpoints(const CheckpointOptions& options, const Part& part);

  /// What is due after a step: ranks agree a few times a second, other calls cost a comparison.
  Wish wish(std::int64_t step) { return step < next_look_ ? Wish::none : look(step); }

  /// Writes the file whole, then renames it. \param remember  what the run keeps
  void save(const std::function<void(Memory&)>& remember);
  /// Reads the file that options.restart names. \throws InputError if it is not a checkpoint of
  /// this lattice
  void load(const std::function<void(Memory&)>& remember);

 private:
  Wish look(std::int64_t step);
  void head(Memory& memory);

  const CheckpointOptions& options_;
  const Part& part_;
  std::int64_t next_look_ = 1, last_look_ = 0;
  double last_look_time_, last_save_;
};

}  // namespace floe
