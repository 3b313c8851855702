/// \file
/// A sheet without end, of which a window exists at a time (model.md, "Ice without end").
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <vector>

#include "floe/mesh/strips.h"
#include "floe/scene.h"
#include "forces/far_edge.h"
#include "lattice/archive.h"
#include "lattice/renumbering.h"
#include "run/supply.h"

namespace floe {

/// The bodies of a scene with `supply` that exist at present. The name of a body is number of its
/// strip * cells of each strip + its cell. Bodies are in the order of their names, beams in that of
/// their bodies, so that they keep their order while others join and leave. Functions that mesh are
/// collective.
class SuppliedIce {
 public:
  /// Begins with the strips of the scene's sheet.
  SuppliedIce(const Scene& scene, MPI_Comm comm);

  /// Makes the lattice of the present bodies, with the sets left (the bodies at the far edge),
  /// right, bottom, top and all, and the scene's factor on moments of inertia; structures come
  /// behind the ice.
  Lattice lattice();
  /// Names of all bodies of the last lattice(): of the ice, then of structures, which are the
  /// largest. Valid until the next.
  const std::vector<std::int32_t>& names_of_bodies() const { return names_of_bodies_; }
  /// Energy ratio of the mesh, the mean of the present strips (Tessellation::energy_ratio).
  double energy_ratio();

  /// Whether the far edge, which has come so far [m], has come a strip's length nearer since the
  /// last look.
  bool is_due(double way) const;
  void end_look() { ++looks_; }
  bool can_join() const;
  /// Pieces that whole beams hold together, all of whose bodies are outside the region.
  std::vector<std::int32_t> leaving(const IceNow& now) const;
  /// The lattice after a change, and the new indices.
  struct Change {
    Lattice lattice;
    Renumbering indices;
  };
  Change leave(const std::vector<std::int32_t>& gone);
  /// \param strain  by which the ice that joins is compressed
  Change join(double strain);
  /// Bodies at the far edge of the last lattice, sorted, and their parts of its area.
  const std::vector<EdgeArea>& edge_areas() const { return edge_areas_; }
  /// By which the far edge is ahead of the motion of the ice behind, since strips have joined
  /// compressed [m].
  double offset() const { return offset_; }
  /// The strip of the far edge.
  std::int32_t last_strip() const { return next_ - 1; }
  /// The motion of the far edge, or of the ice behind it; none with a pressure.
  const Boundary& edge() const { return edge_; }

  /// Saves or loads the bodies that exist. Collective.
  void persist(Archive& archive);

 private:
  std::vector<std::int32_t> present_strips() const;
  double middle(std::int32_t strip) const;
  Tessellation cells();
  template <class Work>
  Change changed(Work&& work);

  const Scene& scene_;
  Boundary edge_;
  Strips strips_;
  std::int32_t each_;       ///< cells of a strip
  std::int32_t next_ = 0;   ///< the strip that joins next
  std::int64_t looks_ = 0;  ///< how often ice was due
  double offset_ = 0;       ///< [m]
  std::vector<EdgeArea> edge_areas_;
  std::vector<std::int32_t> names_, names_of_bodies_;
  std::vector<std::array<std::int32_t, 2>> beams_;  ///< of the present lattice
};

/// The motion of the far edge of a scene's sheet, or of the ice behind it.
Boundary far_edge(const Scene& scene);

}  // namespace floe
