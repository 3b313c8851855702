/// \file
/// The overlap of two convex polyhedra, exact up to rounding in any position.
///
/// Notation: the polyhedron A is given by its vertices, B by the planes of its faces, both in one
/// frame (B's own, which keeps numbers small). The surface of the overlap consists of facets on A's
/// surface and facets on B's; the facets on B's surface are the caps that clipping A by B's
/// half-spaces leaves.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "floe/base/item.h"
#include "floe/base/rotation.h"
#include "floe/geometry/half_space.h"
#include "floe/geometry/polyhedron.h"

namespace floe {

/// Integrals over the facets of an overlap on B's surface, for what acts over an area
/// (model.md, "Contact"). All r are from `middle`, the centroid of |dA|. Only the parts of r across
/// the direction n of S count; u, v and n are a right-handed basis.
template <class T>
struct PatchOf {
  T area = 0;                ///< integral of |dA| [m^2]
  Vec3<T> middle{};          ///< centroid of |dA| [m]
  Vec3<T> u{}, v{};          ///< unit vectors across S
  T uu = 0, vv = 0, uv = 0;  ///< J2, the integral of r r^T |dA|, in u and v [m^4]
  /// Integral of the distance of r from the axis through `middle` along S, over the area that the
  /// facets show along this axis [m^3]: a spin w about the axis slides at w times that distance.
  T reach = 0;

  /// Returns T w, T = int (r x n)(r x n)^T |dA|, of a vector w across n [m^4 times w].
  constexpr Vec3<T> rocking(const Vec3<T>& w) const {
    const T wu = dot(u, w), wv = dot(v, w);
    return (vv * wu - uv * wv) * u + (uu * wv - uv * wu) * v;
  }
  /// Returns the largest eigenvalue of T, and of J2 across n [m^4].
  constexpr T largest() const {
    using std::sqrt;
    const T half = 0.5 * (uu - vv);
    return 0.5 * (uu + vv) + sqrt(T(half * half + uv * uv));
  }
};
using Patch = PatchOf<double>;

template <class T>
struct OverlapOf {
  T volume = 0;        ///< V [m^3]
  Vec3<T> centroid{};  ///< c [m]
  Vec3<T> area{};      ///< S, the sum of the area vectors of the facets on B, outwards [m^2]
  Vec3<T> moment{};    ///< sum of int (r - c) x dA over the facets on B [m^3]
  PatchOf<T> patch;    ///< zeros unless it was asked for
};
using Overlap = OverlapOf<double>;

/// Appends the half-spaces whose intersection is body b of `shapes`, one per face, in the body's
/// own frame. The normals are Newell's sums; each offset holds all corners of its face.
void append_half_spaces(const Shapes& shapes, std::int32_t body, std::vector<HalfSpace>& planes);

/// Returns the largest distance of a vertex of body b beyond the plane of one of its faces, or of a
/// face's corner from the face's plane [m]. It is of the size of rounding if the body is convex and
/// its faces are plane.
double concavity(const Shapes& shapes, std::int32_t body);

/// Facets of an overlap on B, in B's frame [m].
struct FacetsOnB {
  struct Edge {
    Vec3<double> a, b;
  };
  std::vector<Vec3<double>> corners;  ///< of triangles, counter-clockwise seen from outside
  std::vector<Edge> edges;  ///< with the facets to the left; those between facets may be left out

  void clear() { corners.clear(), edges.clear(); }
};

/// Further planes that bound A and B.
struct FurtherPlanes {
  std::span<const HalfSpace> a, b;
};

/// Clips polyhedra. An object keeps its working memory, so that calls do not allocate once the
/// memory has grown.
///
/// A cut depends on each vertex only by the side of the plane on which the vertex lies. A vertex at
/// the plane counts as inside. Every edge with one end inside gets one new vertex, for both of its
/// faces, and at each new vertex one face's boundary leaves the half-space and another's enters it,
/// so that the caps are closed loops for any pattern of signs: the surface stays closed, and the
/// integrals over it right to rounding, in all degenerate positions. No divisor can vanish.
class Clipper {
 public:
  /// Returns the overlap of A and B, zeros if there is none.
  /// \param placed  vertices of body `body` of `shapes`, in B's frame [m]
  /// \param planes  B's half-spaces
  /// \param with_patch  whether to integrate over the facets on B for Overlap::patch
  /// \param further     half-spaces that bound A and B too, in B's frame
  Overlap overlap(const Shapes& shapes, std::int32_t body, std::span<const Vec3<double>> placed,
                  std::span<const HalfSpace> planes, bool with_patch = false,
                  const FurtherPlanes& further = {});

  /// Sets the facets on B of the last overlap, which was not zero.
  void facets_on_b(FacetsOnB& facets) const;

 private:
  struct Face {
    std::int32_t begin, end;  ///< corners begin ... end-1
    bool on_b;
  };
  struct Crossing {
    std::int32_t inside, outside;  ///< ends of the edge, by their side of the plane
    std::int32_t next;             ///< next crossing along the cap
    bool done;
  };
  /// A stack whose room is reserved in advance, so that push() makes no check.
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
  bool cut(const HalfSpace& plane, bool on_b = true);
  void clip_face(const Face& face, std::int32_t kept);
  void close_caps(std::int32_t kept, bool on_b);
  std::int32_t crossing(std::int32_t inside, std::int32_t outside);
  std::int32_t place(std::int32_t corner) const { return item(place_, item(now_.corners, corner)); }
  Overlap integrals() const;
  Patch patch(const Vec3<double>& n) const;

  Mesh now_, next_;
  std::vector<double> distance_;
  std::vector<std::int32_t> place_;  ///< index of a vertex among the kept ones, or -1
  Stack<Crossing> crossings_;
};

}  // namespace floe
