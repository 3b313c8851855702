/// \file
/// The frames of a run, for ParaView and for plots: fields.h5, fields.xmf and the folder fields/.
///
/// fields/NNNNNN.h5 are segments: frames from the number in the name on, each a group /tNNNNNN (see
/// output/frame.h). The last segment grows by being replaced, as a whole and at once, until it has
/// segment_frames or segment_bytes; so every file is whole at any time, whoever reads it, and a
/// run killed or stopped by a full disk loses the frame that it was writing and no other.
/// fields/mesh.h5 has what all frames share. fields.xmf names every frame: those of full segments
/// by including fields/NNNNNN.xmf. fields.h5 has links to the mesh and to the frames; those to the
/// last ones (a sixteenth of all) may come later, at the end of a run at the latest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output/frame.h"

namespace floe {

/// Lives on rank 0. What is written raises FileError, and is as it was before the call then.
class Fields {
 public:
  static constexpr std::size_t segment_frames = 100;
  static constexpr std::size_t segment_bytes = 1 << 19;  ///< of values, without HDF5's own

  /// Makes the files, or cuts those of an earlier run back. \param lattice  must outlive this
  /// \param keep  number of its frames to go on after; -1: a new run
  /// \throws InputError as require() does
  Fields(std::string dir, const Lattice& lattice, std::int64_t keep = -1);
  /// Touches nothing. \throws InputError if a folder has fewer frames, or they cannot be read
  static void require(const std::string& dir, std::int64_t frames);

  void write(const Frame& frame);
  /// All frames so far outlive a crash of the machine.
  void sync();
  /// All frames so far are in fields.h5 too.
  void finish();

 private:
  struct Kept {  ///< a frame of the last segment
    double time;
    std::size_t cracks;
    bool breakable;
  };

  /// The first frames of an earlier run.
  struct Earlier {
    std::vector<std::size_t> segments;
    std::vector<Kept> last;
  };
  static Earlier look_at(const std::string& dir, std::size_t keep);

  void begin();
  std::string path(const std::string& name) const { return dir_ + "/" + name; }
  std::size_t bytes(const Kept& frame) const;
  bool last_is_full() const;
  void remove_earlier() const;
  void cut_back();
  std::string grids_of_last() const;
  void write_xmf() const;
  void write_index();

  std::string dir_;
  FrameWriter writer_;
  std::size_t count_ = 0;                 ///< frames
  std::size_t linked_ = 0;                ///< frames that fields.h5 has
  std::vector<std::size_t> segments_;     ///< first frame of each
  std::vector<Kept> last_;                ///< frames of the last segment
  std::vector<std::string> not_on_disk_;  ///< files written since sync()
};

}  // namespace floe
