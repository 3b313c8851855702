/// \file
/// Timed stages of a run: PETSc log events (printed by -log_view) and wall times (written to
/// summary.json).
#pragma once

#include <mpi.h>

#include <array>
#include <string>
#include <string_view>

namespace floe {

/// The stages that are timed. Option -log_view prints them under the names in event_names.
enum class Event { mesh, lattice, partition, forces, tangent, solve, output, count };

inline constexpr std::array<std::string_view, static_cast<int>(Event::count)> event_names{
    "FloeMesh",    "FloeLattice", "FloePartition", "FloeForces",
    "FloeTangent", "FloeSolve",   "FloeOutput"};

/// Times its own lifetime as one event, in PETSc's log and in wall_seconds().
class Timed {
 public:
  explicit Timed(Event event);
  ~Timed();
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  Event event_;
  double start_;
};

/// Returns the wall time spent so far in an event on this rank [s]. Nested events count in both.
double wall_seconds(Event event);

/// Returns the largest resident memory of this process so far [MB].
double peak_memory_mb();

/// Prints a warning, which does not end the run, on standard error and in the log. Called on rank 0
/// only.
void warn(const std::string& text);

/// Returns the present resident memory of the processes of all ranks [MB]. Collective.
double resident_memory_mb(MPI_Comm comm);

/// Reports the progress of long work on rank 0's standard error: a bar with the remaining time on a
/// terminal, a plain line every few seconds elsewhere, nothing for work that ends within a second.
/// The log file gets one line a minute.
class Progress {
 public:
  /// \param what  name of the work
  /// \param total  amount of work, in the units of update(); 0: unknown, only the notes are printed
  Progress(std::string_view what, double total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Prints the progress if enough time has passed since the last line.
  /// \param done  finished part of `total`
  /// \param note  further words, for example "step 3, 5 iterations"
  void update(double done, std::string_view note = {});
  /// Announces work that reports nothing until it has ended. Prints a line immediately if the work
  /// is expected to take longer than the time between two lines.
  /// \param done, note  as in update()
  /// \param seconds  expected duration of the first such work [s]; later work is expected to take
  /// as long as the last one, which ended at the next call of announce() or update()
  void announce(double done, std::string_view note, double seconds);

 private:
  void print(double done, std::string_view note, double now);

  std::string_view what_;
  double total_, start_, last_print_, last_logged_;
  double announced_ = 0, took_ = 0;  // start of the announced work, duration of the last one [s]
  bool shown_ = false, terminal_ = false, active_ = false;
};

}  // namespace floe
