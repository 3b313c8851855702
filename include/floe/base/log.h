/// \file
/// Named stages of a run: PETSc log events (seen with -log_view), wall times (seen in
/// summary.json).
#pragma once

#include <mpi.h>

#include <array>
#include <string>
#include <string_view>

namespace floe {

/// The stages that are timed. Their names are the events of -log_view.
enum class Event { mesh, lattice, partition, forces, tangent, solve, output, count };

inline constexpr std::array<std::string_view, static_cast<int>(Event::count)> event_names{
    "FloeMesh",    "FloeLattice", "FloePartition", "FloeForces",
    "FloeTangent", "FloeSolve",   "FloeOutput"};

/// Times its own life as one event, in PETSc's log and in wall_seconds().
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

/// Wall seconds spent so far in an event on this rank (nested events count in both).
double wall_seconds(Event event);

/// Largest resident memory of this process so far [MB].
double peak_memory_mb();

/// A line for the user that does not end the run, on standard error; called on rank 0 only.
void warn(const std::string& text);

/// Resident memory of all ranks' processes at present [MB]. Collective.
double resident_memory_mb(MPI_Comm comm);

/// Progress of long work on rank 0's standard error: a bar with the time left on a terminal, a
/// plain line every few seconds otherwise, nothing for work that ends within a second. In the log
/// file, a line a minute.
class Progress {
 public:
  /// \param total  0: not known, the notes are all there is
  Progress(std::string_view what, double total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// \param done  how much of `total` is done   \param note  a few words more, e.g. "step 3, 5
  /// iterations"
  void update(double done, std::string_view note = {});
  /// Before a piece of work that says nothing until it is done: a line at once if it will take
  /// longer than the time between two lines. \param seconds  expected the first time; later ones
  /// are expected to take as long as the last, which ended with the next call of this or update
  void announce(double done, std::string_view note, double seconds);

 private:
  void print(double done, std::string_view note, double now);

  std::string_view what_;
  double total_, start_, last_print_, last_logged_;
  double announced_ = 0, took_ = 0;  // when the last piece of work began, and how long one took
  bool shown_ = false, terminal_ = false, active_ = false;
};

}  // namespace floe
