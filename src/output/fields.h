/// \file
/// fields.h5 and fields.xmf: bodies and beams over time, for ParaView and for plots.
///
/// fields.h5: /mesh/topology (XDMF mixed: 3, number of corners, corners ... per face; one point per
/// body if the lattice has no shapes), /mesh/body (body of each face), /mesh/beams (m x 2), and per
/// time a group /t000000 with the attribute `time` and
///   points (vertices in the world), centres (n x 3, bodies' centroids),
///   bodies_displacement, bodies_rotation (n x 3; rotation vectors), face_displacement,
///   face_rotation (the same, per face), beams_force (N, Q2, Q3), beams_moment (T, M2, M3),
///   beams_stress (largest tensile stress, shear stress), and where beams may break: damage (D per
///   beam), crack_points and cracks (the two faces of each broken section as quadrilaterals,
///   carried by its two bodies), crack_beam (the beam of each).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "floe/base/hdf5.h"
#include "floe/forces/beam.h"

namespace floe {

/// One state in global order.
struct Frame {
  double time = 0;
  std::vector<Point3> displacement;
  std::vector<std::array<double, 4>> rotation;  ///< from rest
  std::vector<Point3> rotation_vector;
  std::vector<BeamSection> sections;
  std::vector<double> damage;  ///< empty if nothing can break
};

/// Lives on rank 0.
class Fields {
 public:
  /// \param keep  number of frames of an earlier fields.h5 to go on after; -1: a new file
  /// \throws InputError if there are fewer, or the file is not readable
  Fields(const std::string& dir, const Lattice& lattice, std::int64_t keep = -1);
  void write(const Frame& frame);
  /// \throws InputError if a folder's fields.h5 has fewer frames, or is not readable
  static void require(const std::string& dir, std::int64_t frames);

 private:
  void write_mesh();
  std::int32_t body_of_face(std::int64_t face, std::int32_t from) const;
  /// A body's principal axes in the world.
  Triad<double> axes_of(std::size_t body, const Frame& frame) const;
  /// A vector of each body, to each of its faces.
  void write_on_faces(const std::string& name, const std::vector<Point3>& of_bodies);
  void cut_back(std::size_t keep);
  void write_bodies(const std::string& group, const Frame& frame);
  void write_beams(const std::string& group, const Frame& frame);
  void write_cracks(const std::string& group, const Frame& frame);
  std::string cracks_grid(std::size_t k) const;
  void write_xmf() const;
  std::string grid(std::size_t k) const;

  std::string dir_;
  const Lattice& lattice_;
  std::optional<Hdf5File> file_;
  bool breakable_ = false;  ///< frames have the beams' damage
  std::vector<double> times_;
  std::vector<std::size_t> cracks_;        ///< per frame: faces of cracks
  std::size_t points_, faces_, topology_;  ///< of /mesh: vertices, polygons, numbers of topology
};

}  // namespace floe
