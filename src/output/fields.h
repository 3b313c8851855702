/// \file
/// The frames of a run, for ParaView and for plots: fields.h5, fields.xmf and the folder fields/.
///
/// The files fields/NNNNNN.h5 are segments: frames from the number in the name on, each a group
/// /tNNNNNN (see output/frame.h). The last segment grows by being replaced as a whole, in one
/// rename, until it has segment_frames or segment_bytes. Every file is therefore whole at any time
/// for any reader, and a run that is killed or stopped by a full disk loses only the frame that it
/// was writing. fields/mesh.h5 has the data that all frames share. fields.xmf names every frame; it
/// includes fields/NNNNNN.xmf for the frames of full segments. fields.h5 has links to the mesh and
/// to the frames; links to the last frames (a sixteenth of all) may come later, at the end of a run
/// at the latest.
///
/// Where bodies join or leave, a new segment and a new mesh begin: fields/mesh_NNNNNN.h5 is that of
/// the frames from NNNNNN on, which have this number as the attribute `mesh`, and has the names of
/// its bodies as /mesh/name; fields.h5 links to it as /mesh_NNNNNN.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "output/frame.h"

namespace floe {

/// Writes the frames; lives on rank 0. A write that raises FileError leaves the file as it was
/// before the call.
class Fields {
 public:
  static constexpr std::size_t segment_frames = 100;
  static constexpr std::size_t segment_bytes = 1 << 19;  ///< of values, without HDF5's own

  /// Creates the files, or cuts those of an earlier run back.
  /// \param lattice  must outlive this object
  /// \param keep  number of frames of the earlier run to keep; -1: a new run
  /// \param mesh  of an earlier run: first frame of the mesh of this lattice
  /// \param names  of the bodies, if mesh > 0
  /// \throws InputError as require() does
  Fields(std::string dir, const Lattice& lattice, std::int64_t keep = -1, std::int64_t mesh = 0,
         std::span<const std::int32_t> names = {});
  /// Checks a folder without changing it. \throws InputError if it has fewer frames, or if they
  /// cannot be read
  static void require(const std::string& dir, std::int64_t frames);

  /// Goes on with other bodies. \param lattice  must outlive this object
  /// \param names  of its bodies
  void follow(const Lattice& lattice, std::span<const std::int32_t> names);
  /// First frame of the present mesh.
  std::int64_t mesh() const { return static_cast<std::int64_t>(meshes_.back()); }

  /// Appends a frame. \throws FileError
  void write(const Frame& frame);
  /// Syncs all frames to the disk, so that they survive a crash of the machine.
  void sync();
  /// Completes the links in fields.h5.
  void finish();

 private:
  struct Kept {  ///< a frame of the last segment
    double time;
    std::size_t cracks;
    bool breakable;
  };

  /// The frames to keep of an earlier run.
  struct Earlier {
    std::vector<std::size_t> segments;
    std::vector<Kept> last;
  };
  static Earlier look_at(const std::string& dir, std::size_t keep);

  void begin();
  void write_mesh(std::span<const std::int32_t> names);
  std::string mesh_file() const;
  /// Whether the last segment takes further frames.
  bool is_open() const { return !last_.empty(); }
  std::string path(const std::string& name) const { return dir_ + "/" + name; }
  std::size_t bytes(const Kept& frame) const;
  bool last_is_full() const;
  void remove_earlier() const;
  void cut_back();
  std::string grids_of_last() const;
  void write_xmf() const;
  void write_index();

  std::string dir_;
  std::optional<FrameWriter> writer_;
  std::vector<std::size_t> meshes_{0};    ///< first frame of each mesh
  std::size_t count_ = 0;                 ///< number of frames
  std::size_t linked_ = 0;                ///< number of frames that fields.h5 links to
  std::vector<std::size_t> segments_;     ///< first frame of each segment
  std::vector<Kept> last_;                ///< frames of the last segment
  std::vector<std::string> not_on_disk_;  ///< files written since sync()
};

}  // namespace floe
