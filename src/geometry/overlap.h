/// \file
/// What two convex polyhedra have in common: exact up to rounding, whatever the position.
///
/// Notation: the polyhedron A is given by its vertices, B by the planes of its faces, both in one
/// frame (for small numbers: B's own). The overlap's surface consists of facets on A's surface and
/// of facets on B's; those on B's are the caps that clipping A by B's half-spaces leaves behind.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/rotation.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

struct Overlap {
  double volume = 0;        ///< V [m^3]
  Vec3<double> centroid{};  ///< c [m]
  Vec3<double> area{};      ///< S, the sum of area vectors of the facets on B, outwards [m^2]
  Vec3<double> moment{};    ///< sum of int (r - c) x dA over the same facets [m^3]
};

/// Half-spaces whose intersection is body b of `shapes`, one per face, in its own frame: normals by
/// Newell's sums, offsets that hold all corners of the face.
void append_half_spaces(const Shapes& shapes, std::int32_t body, std::vector<HalfSpace>& planes);

/// Largest distance of a vertex of body b beyond one of its faces' planes, or of a face's corner
/// from its plane [m]: rounding if the body is convex and its faces are plane.
double concavity(const Shapes& shapes, std::int32_t body);

/// Clips polyhedra; the memory it works in is its own and kept, so that calls do not allocate once
/// it has grown.
///
/// A cut asks for each vertex only on which side of the plane it is. A vertex at the plane counts
/// as inside. Every edge with one end inside gets one new vertex, for both of its faces, and each
/// new vertex is where one face's boundary leaves the half-space and another's enters it, so that
/// the caps are closed loops for any pattern of signs: the surface stays closed, and the integrals
/// over it right to rounding, in all degenerate positions. No divisor can vanish.
class Clipper {
 public:
  /// \param placed  vertices of body `body` of `shapes`, in B's frame, as many as it has
  /// \param planes  B's half-spaces   \returns zeros if A and B do not overlap
  Overlap overlap(const Shapes& shapes, std::int32_t body, std::span<const Vec3<double>> placed,
                  std::span<const HalfSpace> planes);

 private:
  struct Face {
    std::int32_t begin, end;  ///< its corners
    bool on_b;
  };
  struct Crossing {
    std::int32_t inside, outside;  ///< ends of the edge
    std::int32_t next;             ///< along the cap
    bool done;
  };
  /// Entries whose room is made before they come, so that pushing does not look.
  template <class T>
  class Stack {
   public:
    void clear(std::size_t room) {
      if (entries_.size() < room) entries_.resize(2 * room);
      size_ = 0;
    }
    void push(const T& entry) { entries_[size_++] = entry; }
    void cut_back(std::size_t size) { size_ = size; }
    std::size_t size() const { return size_; }
    T& operator[](std::size_t k) { return entries_[k]; }
    const T& operator[](std::size_t k) const { return entries_[k]; }

   private:
    std::vector<T> entries_;
    std::size_t size_ = 0;
  };
  struct Mesh {
    Stack<Vec3<double>> points;
    Stack<std::int32_t> corners;
    Stack<Face> faces;
    void clear(std::size_t most_points, std::size_t most_corners, std::size_t most_faces) {
      points.clear(most_points);
      corners.clear(most_corners);
      faces.clear(most_faces);
    }
  };
  void start(const Shapes& shapes, std::int32_t body, std::span<const Vec3<double>> placed);
  bool cut(const HalfSpace& plane);
  void clip_face(const Face& face, std::int32_t kept);
  void close_caps(std::int32_t kept);
  std::int32_t crossing(std::int32_t inside, std::int32_t outside);
  std::int32_t place(std::int32_t corner) const {
    return place_[static_cast<std::size_t>(now_.corners[static_cast<std::size_t>(corner)])];
  }
  Overlap integrals() const;

  Mesh now_, next_;
  std::vector<double> distance_;
  std::vector<std::int32_t> place_;  ///< of a vertex among those that are kept, or -1
  Stack<Crossing> crossings_;
};

}  // namespace floe
