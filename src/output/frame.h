/// \file
/// The contents of a frame of the fields, in HDF5.
///
/// The mesh: /mesh/topology (XDMF mixed: 3, number of corners, corners ... per face; one point per
/// body if the lattice has no shapes), /mesh/body (body of each face), /mesh/beams (m x 2). A frame
/// is a group with the attribute `time` and
///   points (vertices in the world), centres (n x 3, bodies' centroids),
///   bodies_displacement, bodies_rotation (n x 3; rotation vectors), face_displacement,
///   face_rotation (the same, per face), beams_force (N, Q2, Q3), beams_moment (T, M2, M3),
///   beams_stress (largest tensile stress, shear stress), and where beams may break: damage (D per
///   beam), crack_points and cracks (the two faces of each broken section as quadrilaterals,
///   carried by its two bodies), crack_beam (the beam of each).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "beams/beam_force.h"
#include "files/hdf5.h"
#include "floe/base/rotation.h"
#include "output/xdmf.h"

namespace floe {

/// A state in global order.
struct Frame {
  double time = 0;
  std::vector<Point3> displacement;
  std::vector<std::array<double, 4>> rotation;  ///< quaternions from rest
  std::vector<Point3> rotation_vector;
  std::vector<BeamSection> sections;
  std::vector<double> damage;  ///< empty if no beam can break
};

/// Writes frames and the mesh that they share.
class FrameWriter {
 public:
  /// \param lattice  must outlive this object
  explicit FrameWriter(const Lattice& lattice);
  const GridSizes& sizes() const { return sizes_; }
  void write_mesh(Hdf5File& file) const;
  /// Writes a frame and returns its number of faces of cracks. \param group  a new one
  std::size_t write(Hdf5File& file, const std::string& group, const Frame& frame) const;

 private:
  std::int32_t body_of_face(std::int64_t face, std::int32_t from) const;
  /// Returns a body's principal axes in the world.
  Triad<double> axes_of(std::size_t body, const Frame& frame) const;
  /// Writes a vector of each body for each of the body's faces.
  void write_on_faces(Hdf5File& file, const std::string& name,
                      const std::vector<Point3>& of_bodies) const;
  void write_bodies(Hdf5File& file, const std::string& group, const Frame& frame) const;
  void write_beams(Hdf5File& file, const std::string& group, const Frame& frame) const;
  std::size_t write_cracks(Hdf5File& file, const std::string& group, const Frame& frame) const;

  const Lattice& lattice_;
  GridSizes sizes_;
};

}  // namespace floe
