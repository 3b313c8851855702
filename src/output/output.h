/// \file
/// The output folder of a run: lattice.h5, options.yaml, history.csv, fields.h5 + fields.xmf,
/// summary.json.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "floe/forces/boundary.h"
#include "forces/dead_load.h"
#include "lattice/archive.h"
#include "output/frame.h"
#include "run/integrator.h"

namespace floe {

/// Output settings of a run.
struct OutputOptions {
  std::string dir;
  double history = 0;   ///< time between rows [s]; 0: every accepted step
  double fields = 0;    ///< time between frames [s]; 0: the first and the last state
  double pressure = 0;  ///< time between samples in pressure.csv [s]; 0: none
  std::vector<NamedShape> obstacles{};  ///< all but half-spaces
};

/// Sums over a named boundary's bodies. Force and moment are the reaction, which the boundary
/// exerts on the sheet.
struct BoundarySample {
  Point3 force{};         ///< [N]
  Point3 moment{};        ///< about the set's mean position at rest [N m]
  Point3 displacement{};  ///< mean [m]
};

/// One row of history.csv, on every rank.
struct Sample {
  double time = 0;
  std::map<std::string, BoundarySample> boundaries;
  std::map<std::string, Point3> loads;  ///< mean displacement of the points where loads act [m]
  /// Energies and counts that the forces report.
  std::vector<std::pair<std::string, double>> forces;
};

/// Names and values of a sample's columns after the time, in the order of history.csv.
std::vector<std::pair<std::string, double>> columns_of(const Sample& sample);

/// Returns a sample with the columns of a run's rows and values of 0.
/// \param names  columns of forces and integrator
/// \param breakable  whether beams may break
Sample columns_of(const std::vector<Boundary>& boundaries, const std::vector<Load>& loads,
                  const std::vector<std::string>& names, bool breakable);

/// History of a run's output, which checkpoints keep.
struct OutputArchive {
  Sample first, last;
  bool row_pending = false;  ///< `last` is not in history.csv
  std::int64_t rows = 0;     ///< rows in history.csv, without its first line
  std::int64_t frames = 0;   ///< frames in fields.h5
  std::int64_t pressures =
      0;                     ///< rows in pressure.csv; there is none where pressure is not sampled
  double next_history = 0;   ///< time of the next row [s]
  double next_fields = 0;    ///< time of the next frame [s]
  double next_pressure = 0;  ///< time of the next sample in pressure.csv [s]
  std::string run;           ///< identifier of the run whose files these are
  void persist(Archive& archive);
};

/// The state of a run's output, to which it can go back.
struct OutputState {
  OutputArchive archive;
  std::optional<Frame> pending;  ///< of the last accepted state, if it is not in fields.h5
};

/// Checks whether a folder has the files with which a restart goes on; changes nothing. Collective.
/// \param columns  a sample with the columns of this run's rows, with any values
/// \throws InputError if rows or frames are missing, or columns differ
void require_files(const std::string& dir, const OutputArchive& archive, const Sample& columns,
                   MPI_Comm comm);

/// The mesh of the frames of the present bodies, on a restart.
struct PresentMesh {
  std::int64_t first = 0;                    ///< frame
  std::span<const std::int32_t> names = {};  ///< of the bodies
};

/// Writes every accepted state on rank 0. Files of planar runs have the layout of spatial ones,
/// with zeros. All calls are collective.
template <class Space>
class Output {
 public:
  /// Writes lattice.h5 and options.yaml into the folder, which must exist.
  /// \param lattice  the whole lattice, which is moved from; rank 0 keeps the parts that frames
  ///   need
  /// \param restart  history of the output from a checkpoint, or null; the files of that run are
  ///   cut back to this history and continued
  /// \param mesh  of the lattice, where bodies join and leave
  /// \throws InputError if the folder does not have the files to go on with
  Output(const OutputOptions& options, Lattice&& lattice, const Model<Space>& model,
         const std::vector<PlacedLoad>& loads, const std::string& options_yaml,
         const OutputArchive* restart = nullptr, const PresentMesh& mesh = {});
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  /// Writes a row and a frame of the state if they are due.
  void accept(const Accepted<Space>& accepted);
  /// Writes the last accepted state if it is not on file yet.
  void finish();
  /// Follows the model, which has been divided anew: its part and its forces are others. To be told
  /// before that, with prepare_to_follow().
  void follow();
  /// The same with other bodies, some of which have joined or left.
  /// \param lattice  the whole one, on every rank
  /// \param names    of its bodies
  void follow(const Lattice& lattice, std::span<const std::int32_t> names);
  /// First frame of the mesh of the present bodies; on rank 0.
  std::int64_t mesh() const;
  /// Gathers what bodies of the present part have not written yet.
  void prepare_to_follow();
  /// Syncs rows and frames to the disk, so that they survive a crash of the machine.
  void sync();

  /// State of the output, before finish(). Gathers a frame.
  OutputState save();
  /// Goes back to a state: cuts the files back if rows or frames have been written since then.
  /// \param mesh  of the bodies then, which the output follows already, where bodies join and leave
  void restore(const OutputState& state, const PresentMesh& mesh = {});

  /// History with which a checkpoint can cut the files back to this moment.
  const OutputArchive& archive() const;

  const Sample& first() const;
  const Sample& last() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floe
