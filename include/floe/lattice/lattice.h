/// \file
/// The lattice: bodies joined by beams, made from a sheet or read from a lattice file.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "floe/geometry/polyhedron.h"
#include "floe/lattice/material.h"
#include "floe/mesh/tessellation.h"

namespace floe {

/// Rigid bodies as a structure of arrays, at rest in the reference configuration. Orientations are
/// unit quaternions (w, x, y, z) from principal axes to world axes; velocities are in world axes.
struct Bodies {
  std::vector<Point3> position;  ///< centroids [m]
  std::vector<std::array<double, 4>> orientation;
  std::vector<double> mass;              ///< [kg]
  std::vector<Point3> inertia;           ///< principal moments [kg m^2]
  std::vector<Point3> velocity;          ///< [m/s]; empty: at rest
  std::vector<Point3> angular_velocity;  ///< [rad/s]; empty: at rest
  /// 1: neither weight nor water acts, since a support carries the body; empty: all 0
  std::vector<std::uint8_t> dry;
  std::int32_t size() const { return static_cast<std::int32_t>(position.size()); }
};

/// Whether neither weight nor water acts on a body.
inline bool is_dry(const Bodies& bodies, std::int32_t body) {
  return !bodies.dry.empty() && bodies.dry[static_cast<std::size_t>(body)] != 0;
}

/// Returns the moment of inertia at rest of a body about a unit vector in the world [kg m^2].
double inertia_about(const Bodies& bodies, std::int32_t body, const Point3& axis);

/// Beams as a structure of arrays; beam m joins bodies[m][0] < bodies[m][1], at their centroids or,
/// with offsets, at points that turn with them. A sheet's beams are sorted by their bodies; those
/// of a lattice file keep its order. Local axes: 1 along the beam, 2 = axis_y (made orthogonal to
/// 1), 3 = 1 x 2. In a sheet axis 2 lies in the plane and axis 3 is up: inertia_y resists
/// out-of-plane bending, inertia_z in-plane bending.
struct Beams {
  std::vector<std::array<std::int32_t, 2>> bodies;
  std::vector<double> area;            ///< [m^2]
  std::vector<double> inertia_y;       ///< second moment about axis 2 [m^4]
  std::vector<double> inertia_z;       ///< second moment about axis 3 [m^4]
  std::vector<double> torsion;         ///< torsion constant J [m^4]
  std::vector<double> length;          ///< of the beam at rest: |X_j - X_i| without offsets [m]
  std::vector<double> young;           ///< [Pa]
  std::vector<double> shear_modulus;   ///< [Pa]
  std::vector<double> shear_factor;    ///< kappa
  std::vector<double> shear_factor_y;  ///< kappa of shear along axis 2; empty: shear_factor
  std::vector<Point3> axis_y;          ///< unit vector, world
  std::vector<double> width;   ///< section's extent along axis 2 [m]; empty if the file has none
  std::vector<double> height;  ///< section's extent along axis 3 [m]; empty if the file has none
  /// Ends of the beam from the centroids of its two bodies, at rest, in world axes [m]; empty:
  /// beams end at the centroids.
  std::vector<std::array<Point3, 2>> offsets;
  /// From the second body to its image that the beam joins, in a model that repeats itself [m];
  /// empty: the beams join the bodies themselves.
  std::vector<Point3> image;
  std::vector<double> strength;  ///< factor of the strengths of fracture; empty: 1
  std::vector<double> energy;    ///< factor of the energies of fracture; empty: 1
  std::int32_t size() const { return static_cast<std::int32_t>(bodies.size()); }
};

/// Returns where an end of beam m is, from the centroid of its body, at rest [m].
/// \param end  0 or 1
inline Point3 offset(const Beams& beams, std::int32_t m, std::size_t end) {
  return beams.offsets.empty() ? Point3{} : beams.offsets[static_cast<std::size_t>(m)][end];
}

/// Returns what lies between the ends of beam m at rest, from the first to the second [m].
/// \param bodies  those that the indices of the beams are of
inline Point3 chord(const Bodies& bodies, const Beams& beams, std::int32_t m) {
  const auto k = static_cast<std::size_t>(m);
  const auto i = static_cast<std::size_t>(beams.bodies[k][0]),
             j = static_cast<std::size_t>(beams.bodies[k][1]);
  const Point3 apart =
      (bodies.position[j] + offset(beams, m, 1)) - (bodies.position[i] + offset(beams, m, 0));
  return beams.image.empty() ? apart : apart + beams.image[k];
}

/// Returns the factor of beam m: 1 if there are none.
inline double factor(const std::vector<double>& factors, std::int32_t m) {
  return factors.empty() ? 1.0 : factors[static_cast<std::size_t>(m)];
}

/// A whole lattice. During set-up every rank holds a copy; partition() distributes it.
struct Lattice {
  Bodies bodies;
  Beams beams;
  std::map<std::string, std::vector<std::int32_t>> sets;  ///< sorted body indices; "all" is implied
  Shapes shapes;  ///< empty, or one convex polyhedron per body in its principal axes

  /// Returns the indices of a named set.
  /// \throws InputError naming `key` if the set is empty, or, with the known sets, if it is missing
  const std::vector<std::int32_t>& set(const std::string& name, const std::string& key) const;
};

/// The parameters by which the cells of a sheet become bodies and beams.
struct SheetSection {
  double thickness = 1;  ///< h [m]
  double mid_plane = 0;  ///< z of the mid-plane of ice of that thickness [m]; goes with thickness
  Ice ice;
  double shear_factor = 5.0 / 6.0;
  Torsion torsion = Torsion::saint_venant;
};

/// Makes the lattice of a sheet: prisms over the cells (exact mass, centroid and inertia on
/// principal axes), one beam per facet, and the edge sets. The facet between cells of two
/// thicknesses is the common part of their side faces; its beam lies level at that part's height.
/// \param thickness  of each cell [m]; empty: all have the section's
Lattice make_sheet(const Tessellation& cells, const SheetSection& section,
                   std::span<const double> thickness = {});

/// Renumbers bodies in reverse Cuthill-McKee order and sorts beams by (smaller, larger) body. The
/// order depends on the lattice only, so it is the same for any number of ranks.
/// \return the old index of each new one: order[new] = old
std::vector<std::int32_t> reorder(Lattice& lattice);

/// Removes the beams that cross the segment from a to b in plan [m], as a cut with a saw does.
/// \param on_line  the bodies, the smaller first, of further beams to remove: those whose facets
///   lie on the segment
void cut(Lattice& lattice, const Point2& a, const Point2& b,
         std::span<const std::array<std::int32_t, 2>> on_line = {});

/// Adds the set `name` of all bodies with their centroid in the box {x0, x1, y0, y1, z0, z1} [m].
/// \throws InputError naming `key` if the set exists already or no body is inside
void add_region(Lattice& lattice, const std::string& name, const std::array<double, 6>& box,
                const std::string& key);

/// Reads a lattice file (layout: model.md, "Files").
/// \throws InputError naming the file and the dataset if the dataset is missing, has a wrong shape,
/// or has a value out of range
Lattice read_lattice(const std::string& file);
/// Reads the convex polyhedra in a file's /shapes, all in one frame; its origin may be anywhere.
/// \param key  the option that named the file, for messages
/// \throws InputError if the file has no such polyhedra
Shapes read_polyhedra(const std::string& file, const std::string& key);
/// Writes a lattice file under a temporary name and renames it. Call on one rank.
/// \param obstacles  for pictures
/// \throws FileError
void write_lattice(const Lattice& lattice, const std::string& file,
                   std::span<const NamedShape> obstacles = {});

}  // namespace floe
