/// \file
/// Overlaps of polyhedra of few vertices: as Clipper finds them, in less time.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "floe/base/rotation.h"
#include "floe/geometry/half_space.h"
#include "geometry/cut_record.h"
#include "geometry/edge_graph.h"
#include "geometry/overlap.h"
#include "geometry/vertex_lists.h"

namespace floe {

/// Clips polyhedra by the rule of Clipper: a cut depends on each vertex only by the side of the
/// plane on which it lies, and a vertex at the plane is inside. Every edge with one end inside gets
/// one new vertex w; in each of its faces a new edge leads from the vertex where the face leaves
/// the half-space to that where it enters next, and the twins of these edges are the cap. So every
/// half-edge keeps a twin in another face: the surface stays closed for any pattern of signs.
///
/// All that a cut decides follows from its mask of vertices inside, and the arithmetic follows from
/// these decisions. A record keeps the masks and the decisions of a pair. Where the planes leave
/// the same masks again, the arithmetic is repeated without decisions, and its bits are those of
/// the full pass; else the full pass makes the record anew. So results never depend on records.
class GraphClipper {
 public:
  /// Places A in B's frame for overlap().
  /// \param vertices  of A in its own frame, at most EdgeGraph::most_vertices
  /// \param axes, x   axes and origin of A's frame in B's frame
  void place(const VertexLists& vertices, const Triad<double>& axes, const Vec3<double>& x);

  /// Sets the overlap of A, placed, and B, unless there is none. Returns false if there are more
  /// planes, or at some cut more vertices or edges, than there is room for: a task for Clipper.
  /// \param a           graph of A
  /// \param planes      B's half-spaces
  /// \param with_patch  whether to integrate over the facets on B for Overlap::patch
  /// \param further     half-spaces that bound A and B too, in B's frame
  /// \param record      of the same pair, with no cuts at first
  /// \param found       zeros
  bool overlap(const EdgeGraph& a, std::span<const HalfSpace> planes, bool with_patch,
               const FurtherPlanes& further, CutRecord& record, Overlap& found);
  /// Sets the facets on B of the last overlap, which was not zero. \param record  its record
  void facets_on_b(const CutRecord& record, FacetsOnB& facets) const;
  /// Whether the last overlap() repeated its record.
  bool replayed() const { return replayed_; }

 private:
  /// The planes of an overlap: those of B but for the first, then the further ones.
  struct Planes {
    std::span<const HalfSpace> b;
    FurtherPlanes further;
    std::uint8_t first = 0;  ///< plane of B that cuts first

    std::size_t number() const { return b.size() + further.b.size() + further.a.size(); }
    template <class Visit>
    void for_each_but_first(Visit visit) const;
  };

  std::uint8_t first_plane(std::span<const HalfSpace> planes) const;
  std::uint64_t inside(const HalfSpace& plane, std::size_t begin, std::size_t end);
  std::uint32_t placed_inside(const HalfSpace& plane);
  std::uint32_t left_inside(const HalfSpace& plane);
  void settle(std::uint32_t inside);
  std::uint64_t make_points(std::span<const Triple> points);

  bool replay(const Planes& planes, const CutRecord& record);
  bool clip(const EdgeGraph& a, const Planes& planes, CutRecord& record);
  void start(const EdgeGraph& a, std::uint32_t inside);
  bool cut(std::uint64_t inside, bool on_b);
  void add_vertices(std::uint64_t crossing, std::uint64_t inside);
  void add_edges(std::uint64_t crossing, bool on_b);
  bool note_cut(CutRecord& record, std::uint32_t inside, std::size_t plane) const;
  void note_facets(CutRecord& record) const;
  Triple* add_triangles(Triple* to, std::uint8_t apex, bool on_b) const;
  Triple* add_rim(Triple* to) const;

  bool replayed_ = false;
  std::size_t vertices_ = 0;  ///< of A
  Points points_;
  Vec3<double> origin_of_a_{};                                ///< in B's frame [m]
  alignas(64) std::array<double, Points::slots> distance_{};  ///< from the plane that cuts last
  std::uint64_t alive_ = 0;                                   ///< mask of the vertices

  // The graph of what is left in a full pass.
  using PerHalfEdge = std::array<std::uint8_t, 2 * EdgeGraph::most_edges>;
  PerHalfEdge origin_{}, next_{};
  PerHalfEdge on_b_{};  ///< whether the face of the half-edge is on B
  std::array<std::uint64_t, Points::slots> star_{};
  std::uint64_t edges_ = 0;                     ///< mask
  std::uint64_t of_a_ = 0;                      ///< mask of the slots that are for A's vertices
  std::array<Triple, Points::low> new_points_;  ///< of the last cut
  std::size_t new_ = 0;                         ///< their number
};

}  // namespace floe
