/// \file
/// The output folder of a run: lattice.h5, options.yaml, history.csv, fields.h5 + fields.xmf,
/// summary.json.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "floe/forces/boundary.h"
#include "forces/dead_load.h"
#include "lattice/archive.h"
#include "run/integrator.h"

namespace floe {

struct OutputOptions {
  std::string dir;
  double history = 0;  ///< time between rows [s]; 0: every accepted step
  double fields = 0;   ///< time between frames [s]; 0: the first and the last state
};

/// Sums over a named boundary's bodies. Reactions are what the boundary exerts on the sheet.
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
  std::vector<std::pair<std::string, double>>
      forces;  ///< energies and counts, as the forces report them
};

/// A sample with the columns of a run's rows and values of 0.
/// \param names  of what forces and integrator report   \param breakable  beams may break
Sample columns_of(const std::vector<Boundary>& boundaries, const std::vector<Load>& loads,
                  const std::vector<std::string>& names, bool breakable);

/// What the output of a run takes along over a restart.
struct OutputArchive {
  Sample first, last;
  bool row_pending = false;  ///< `last` is not in history.csv
  std::int64_t rows = 0;     ///< in history.csv, without its first line
  std::int64_t frames = 0;   ///< in fields.h5
  double next_history = 0;   ///< when the next row is due [s]
  double next_fields = 0;    ///< when the next frame is due [s]
  std::string run;           ///< what identifies the run whose files they are
  void persist(Archive& archive);
};

/// Looks whether a folder holds the files that a restart goes on with; changes nothing. Collective.
/// \param columns  a sample with the columns of this run's rows, whatever their values
/// \throws InputError
void require_files(const std::string& dir, const OutputArchive& archive, const Sample& columns,
                   MPI_Comm comm);

/// Takes every accepted state; writes on rank 0. Files of planar runs are those of spatial ones,
/// with zeros. Collective throughout.
template <class Space>
class Output {
 public:
  /// Writes lattice.h5 and options.yaml into the folder, which is there.
  /// \param lattice  the whole lattice; rank 0 keeps a reference for the fields' geometry
  /// \param restart  what a checkpoint says, or null: the files of that run are cut back to it and
  /// go on
  /// \param lattice  taken over; rank 0 keeps what frames are made of
  /// \throws InputError if the folder does not hold the files to go on with
  Output(const OutputOptions& options, Lattice&& lattice, const Model<Space>& model,
         const std::vector<PlacedLoad>& loads, const std::string& options_yaml,
         const OutputArchive* restart = nullptr);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void accept(const Accepted<Space>& accepted);
  /// Writes the last accepted state if it is not on file yet.
  void finish();
  /// Rows and frames so far outlive a crash of the machine.
  void sync();

  /// What a checkpoint must know to cut the files back to this moment.
  const OutputArchive& archive() const;

  const Sample& first() const;
  const Sample& last() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace floe
